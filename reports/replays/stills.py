"""Stills: pictures of the final states of trials, with live, frozen and fallen bricks in different colours."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from reports.records.folder import still_of
from reports.records.recording import FIXED_FIELDS, LENGTH_STEP, REMOVED, STATES
from reports.replays.replay import Replayed

_ROOT = Path(__file__).parents[2]
"""Folder of the checkout."""
PIXELS = 240
"""Edge length of a still [pixels], chosen so that a still is sharp at the 120 to 160 pixels of a page and takes about
0.3 s to draw."""
COLOURS = {"live": (224, 160, 48), "frozen": (91, 159, 201), "fallen": (168, 66, 90)}
"""Colours by state, as in a replay: red, green and blue from 0 to 255. They also differ in lightness, so that
colour-blind readers can distinguish them."""
FIXED_COLOUR = (150, 154, 158)
"""Colour of boxes that never move."""
_TINT = 0.08
"""Greatest relative change of a brick's lightness, so that neighbours can be distinguished."""
_LONGEST_S = 900
"""Time limit of the renderer [s]."""


class StillsError(RuntimeError):
    """A failure to draw stills; the message names the reason and, if known, the fix."""


def write_stills(folder: Path, stacks: Iterable[Sequence[Replayed]], pixels: int = PIXELS) -> None:
    """Draw the still of every trial.

    Args:
        folder: folder of the stills, created if necessary.
        stacks: lists of trials; the trials of a list have the same camera.
        pixels: edge length of the square pictures.

    Raises:
        StillsError: if the machine has no renderer, or the renderer fails or takes too long.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [job for stack in stacks for job in _jobs(folder, stack)]
    if not jobs:
        return
    with tempfile.TemporaryDirectory() as scratch:
        order = Path(scratch) / "jobs.json"
        order.write_text(json.dumps({"pixels": pixels, "jobs": jobs}), encoding="utf-8")
        _render(order)


def _render(order: Path) -> None:
    """Draw in a separate process, because VTK ends its process if the machine has no renderer."""
    command = [sys.executable, "-m", "reports.replays.rendering", str(order)]
    try:
        subprocess.run(command, cwd=_ROOT, capture_output=True, text=True, check=True, timeout=_LONGEST_S)
    except subprocess.TimeoutExpired as error:
        raise StillsError(f"the stills took more than {_LONGEST_S} s and were stopped: run the report again") from error
    except subprocess.CalledProcessError as error:
        raise StillsError(_reason(error)) from error


def _reason(error: subprocess.CalledProcessError) -> str:
    if error.returncode < 0:
        return "no stills, because this machine has no renderer: apt-get install libegl1, or libosmesa6"
    last = error.stderr.strip().splitlines()[-1]
    return f"no stills: {last}" + (": uv sync" if "No module named" in last else "")


def _jobs(folder: Path, stack: Sequence[Replayed]) -> list[dict[str, Any]]:
    """Return the jobs of the renderer for the trials of one stack."""
    drawn = [_drawn(trial) for trial in stack]
    corners = [corner for bricks, spans in drawn for corner in spans]
    if not corners:
        return []
    low, high = np.min(corners, axis=0).tolist(), np.max(corners, axis=0).tolist()
    return [
        {"path": str(still_of(folder, trial.record).resolve()), "bricks": bricks, "low": low, "high": high}
        for trial, (bricks, _) in zip(stack, drawn, strict=True)
    ]


def _drawn(trial: Replayed) -> tuple[list[dict[str, Any]], list[np.ndarray]]:
    """Return the final bricks with the fixed boxes, and corners [m] that span the visible space.

    The corners, each of shape (3,), belong to the fixed boxes and to all bricks at their first positions.
    """
    recording, rng = trial.recording, np.random.default_rng(0)
    bricks, corners = [], []
    first = np.flatnonzero(np.diff(recording.body, prepend=-1))
    last = np.append(first[1:], len(recording.body))[: len(first)] - 1
    for laid, end in zip(first, last, strict=True):
        size = np.array(recording.sizes[int(recording.body[laid])])
        position = recording.position[end] * LENGTH_STEP
        start = recording.position[laid] * LENGTH_STEP
        tint = 1 + _TINT * rng.uniform(-1, 1)
        corners += [start - size / 2, start + size / 2]
        if recording.state[end] == REMOVED:
            continue
        has_fallen = np.linalg.norm(position - start) > size.min()
        state = "fallen" if has_fallen else STATES[recording.state[end]]
        bricks.append(
            {
                "size": size.tolist(),
                "position": position.tolist(),
                "quaternion": recording.quaternion[end].tolist(),
                "colour": [round(tint * value) for value in COLOURS[state]],
            }
        )
    for box in recording.fixed:
        bricks.append({name: list(getattr(box, name)) for name in FIXED_FIELDS} | {"colour": list(FIXED_COLOUR)})
        corners += [np.array(box.position) - np.array(box.size) / 2, np.array(box.position) + np.array(box.size) / 2]
    return bricks, corners
