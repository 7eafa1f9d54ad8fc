"""A replay: a page that plays recorded trials side by side in a browser, offline.

The page draws with the library three.js, which the package ``jupyter-threejs-sage`` contains. All replays of a folder
share one file with the script of three.js. A page from disk may load a classic script from its own folder, but neither
modules nor data.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from reports.records.atomic import write_atomic
from reports.records.body_fields import FIXED_FIELDS
from reports.records.recording import LENGTH_STEP, QUATERNION_STEP, STATES, Recording
from reports.records.trial import TrialRecord
from reports.replays.margins import MARGIN_COLOURS, QUANTITIES, Margins, legend
from scenarios.model import Vector
from scenarios.shapes import Shape
from scenarios.surfaces import surface_of

_TEMPLATES = Path(__file__).parent / "templates"
_THREE = ("jupyter_threejs_sage", "static/r130/three.min.js")
_SCRIPT = "three.min.js"


@dataclass(frozen=True, slots=True)
class Replayed:
    """A trial with its recording."""

    record: TrialRecord
    recording: Recording

    @property
    def end(self) -> str:
        """Outcome of the trial as a short text."""
        record = self.record
        if record.collapse_level is not None:
            return f"{'sank' if record.collapse_kind == 'sink' else 'fell'} at level {record.collapse_level}"
        return f"{record.status}, {record.height_levels} of {record.levels_planned} levels"


def write_replay(folder: Path, name: str, trials: Sequence[Replayed], margins: Sequence[Margins] | None = None) -> Path:
    """Write the replay ``NAME.html`` and its script into a folder, and return the path of the page.

    Args:
        folder: folder of the replays, created if necessary.
        name: file name of the page, without its suffix.
        trials: trials to show side by side at the same simulated time, at least one.
        margins: margins of each trial, which the page can show as colours; None for a page without margins.
    """
    folder.mkdir(parents=True, exist_ok=True)
    script = resources.files(_THREE[0]).joinpath(_THREE[1])
    if not (folder / _SCRIPT).exists():
        write_atomic(folder / _SCRIPT, script.read_bytes())
    first = trials[0].record
    each: Sequence[Margins | None] = margins or [None] * len(trials)
    page = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True
    ).get_template("replay.html.j2")
    html = page.render(
        title=f"{first.scene} on {first.engine}, {first.profile}, seed {first.seed}",
        theory=str(first.expectation),
        why=first.expectation.theory,
        script=_SCRIPT,
        trials=[_described(trial, shown) for trial, shown in zip(trials, each, strict=True)],
        legends={} if margins is None else {quantity: legend(quantity) for quantity in QUANTITIES},
        margin_colours=[f"#{r:02x}{g:02x}{b:02x}" for r, g, b in MARGIN_COLOURS],
        player=Markup((_TEMPLATES / "replay.js").read_text(encoding="utf-8")),
    )
    write_atomic(folder / f"{name}.html", html.encode())
    return folder / f"{name}.html"


def _described(trial: Replayed, margins: Margins | None) -> dict[str, Any]:
    recording = trial.recording
    rows = [recording.body, recording.frame, *recording.position.T, *recording.quaternion.T, recording.state]
    return {
        "policy": trial.record.policy,
        "end": trial.end,
        "frame_s": recording.frame_s,
        "frames": recording.frames,
        "every": recording.every,
        "fixed": [{name: getattr(box, name) for name in FIXED_FIELDS} for box in recording.fixed],
        "sizes": {str(body): size for body, size in recording.sizes.items()},
        "surfaces": {
            **{str(body): _surface(shape, recording.sizes[body]) for body, shape in recording.shapes.items()},
            **{
                f"fixed {index}": _surface(body.shape, body.size)
                for index, body in enumerate(recording.fixed)
                if body.shape != "box"
            },
        },
        "rows": len(recording.body),
        "data": _packed(np.array(rows, np.int32)),
        "steps": [LENGTH_STEP, QUATERNION_STEP],
        "states": STATES,
        "margins": None if margins is None else _margins(margins),
    }


def _surface(shape: Shape, size: Vector) -> list[list[float]]:
    """Return the corners [m] of the triangles that cover a shape, nine numbers a triangle, in the brick's own frame."""
    surface = surface_of(shape, size)
    triangles: list[list[float]] = np.round(surface.corners[np.array(surface.triangles)].reshape(-1, 9), 6).tolist()
    return triangles


def _margins(margins: Margins) -> dict[str, Any]:
    """Return the instants [s], and for each kind of margin the class of every brick at each instant."""
    return {"times": margins.times, **{quantity: margins.classes(quantity).tolist() for quantity in QUANTITIES}}


def _packed(columns: np.ndarray) -> str:
    """Compress integer columns, shape (columns, n), into a base64 text.

    Take the differences along each column, split them into bytes, group the bytes by significance, and deflate them.
    """
    differences = np.diff(columns, axis=1, prepend=0).astype("<i4")
    by_byte = np.ascontiguousarray(differences).view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(by_byte.tobytes(), 9)).decode()
