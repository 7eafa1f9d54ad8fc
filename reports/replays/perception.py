"""Measurement of the visible effects of frozen bricks in a recording, as figures in pixels, without a user study.

    uv run python -m reports.replays.perception DIR TRIAL [--without TRIAL] [--due SECONDS] [--kept-from SECONDS]

Han et al. asked people whether fixed objects beneath a pile look implausible. This module measures instead, in pixels
of a standard screen, the deviations that a viewer could see at all:

- ``pop``: the greatest jump |x(t+1) - 2 x(t) + x(t-1)| of a corner x of a brick that freezes or unfreezes in frame t.
  If there is a run without the extension, the module subtracts the jump of the same corner in that run;
- ``hover``: the greatest gap between a frozen brick and the nearest body or ground straight below the brick;
- ``unsupported``: brick-seconds of frozen bricks for which exact statics finds no equilibrium;
- ``late``: the time from the instant at which the scene must fall until a brick has moved by one pixel;
- ``kept``: the share of bricks that stay within their thickness for five seconds after an instant, such as the removal
  of the walls of ``mould``.

Lengths are distances in space, as if every motion were across the view. Therefore the figures are upper bounds. A
recording has a dead band of 0.05 mm, which limits the resolution of ``pop`` and ``hover``. A frozen brick that other
bodies hold only at its sides counts as hovering.

Source: S. Han, S.-W. Hsu, A. McNamara, J. Keyser, "Believability in simplifications of large scale physically based
simulation", ACM Symposium on Applied Perception, 2013.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from reports.records.folder import ResultsFolder
from reports.records.recording import FROZEN, LIVE, FloatArray, Recording
from reports.replays.margins import margins_of
from reports.replays.timeline import Poses, Timeline
from reports.tables.table import NOTHING, Table, to_markdown
from scenarios.geometry import Boxes, height_above_ground, vertical_clearance

LINES = 1080
"""Height of the standard screen [px]."""
VIEW_DEG = 40.0
"""Vertical view angle of the standard camera [deg]."""
FAR = 3.0
"""Distance of the far camera over the distance of the near camera, from which the scene fills the height of the
screen."""
VISIBLE_PX = 1.0
"""Least visible length [px]: from three picture heights away a pixel is one minute of arc, the limit of the eye."""
SUNK = 0.5
"""Overlap, as a share of the thinner brick's least edge, up to which a body counts as straight below another body."""
KEPT_S = 5.0
"""Time [s] for which a brick must stay within its thickness to count as kept."""
MOST_CHANGES = 60
"""Greatest number of changes of the frozen set that the module examines, because each takes about 10 ms a brick."""


@dataclass(frozen=True, slots=True)
class Perceived:
    """Figures of one recording, with lengths in metres."""

    pop_m: float
    """Greatest jump at a freeze or unfreeze [m]; 0 without such events."""
    events: int
    """Number of freezes and unfreezes, without bricks that appear frozen."""
    hover_m: float
    """Greatest gap below a frozen brick [m]; 0 without frozen bricks."""
    unsupported_s: float | None
    """Brick-seconds frozen without an equilibrium; None if the recording has no masses."""
    late_s: float | None
    """Time from the due instant until a brick has moved by ``VISIBLE_PX`` of the near camera [s]; None without an
    instant or a motion."""
    near_px_per_m: float
    """Pixels per metre of the near camera."""

    def pixels(self, length: float, *, far: bool = False) -> float:
        """Return a length [m] in pixels of the near or the far camera."""
        return length * self.near_px_per_m / (FAR if far else 1.0)


def pixels_per_metre(distance: float) -> float:
    """Return the pixels per metre of a camera at ``distance`` [m]: ``LINES`` / (2 distance tan(``VIEW_DEG`` / 2))."""
    return LINES / (2 * distance * math.tan(math.radians(VIEW_DEG) / 2))


def perceive(recording: Recording, without: Recording | None = None, due_s: float | None = None) -> Perceived:
    """Measure the visible effects of frozen bricks in a recording.

    Args:
        recording: the run with the extension.
        without: the run of the same scene without the extension; its bricks have the same ids. None without this run.
        due_s: instant from which the stack must fall [s]; None for a stack that must stand.

    Raises:
        ExportError: if bricks overlap so far at all examined instants that their contacts are unknown.
    """
    timeline = Timeline(recording)
    scale = LINES / _extent(timeline)
    pops = _pops(timeline, Timeline(without) if without is not None else None)
    hover, unsupported = 0.0, None if recording.physics is None else 0.0
    changes = _changes_of_frozen(recording)
    for frame in changes:
        hover = max(hover, _gap_below_frozen(timeline, timeline.at(frame * recording.frame_s)))
    if unsupported is not None:
        unsupported = _unsupported_s(timeline, changes)
    late = None if due_s is None else _late_s(timeline, due_s, VISIBLE_PX / scale)
    return Perceived(max(pops, default=0.0), len(pops), hover, unsupported, late, scale)


def _extent(timeline: Timeline) -> float:
    """Return the greatest extent [m] of all bricks at their first poses, which fills the near camera's view."""
    corners = Boxes.at(timeline.sizes, timeline.first, timeline.first_turn).corners.reshape(-1, 3)
    return float(np.ptp(corners, axis=0).max())


def _events(recording: Recording) -> list[tuple[int, int]]:
    """Return body and frame of each freeze and unfreeze."""
    same = (np.diff(recording.body) == 0) & (np.diff(recording.state) != 0)
    rows = np.flatnonzero(same) + 1
    both = np.isin(recording.state[rows], (LIVE, FROZEN)) & np.isin(recording.state[rows - 1], (LIVE, FROZEN))
    return list(zip(recording.body[rows[both]].tolist(), recording.frame[rows[both]].tolist(), strict=True))


def _corners(timeline: Timeline, body: int, frame: int) -> FloatArray:
    """Return the corners [m] of a brick in a frame, shape (8, 3)."""
    place = int(np.searchsorted(timeline.bodies, body))
    poses = timeline.at(frame * timeline.recording.frame_s)
    corners: FloatArray = Boxes.at(timeline.sizes[place], poses.position[place], poses.quaternion[place]).corners[0]
    return corners


def _jump(timeline: Timeline, body: int, frame: int) -> FloatArray:
    """Return the greatest second difference [m] of each corner of a brick around a frame, shape (8,)."""
    frames = range(max(frame - 2, 0), min(frame + 2, timeline.recording.frames))
    path = np.array([_corners(timeline, body, at) for at in frames])
    if len(path) < 3:
        return np.zeros(8)
    jumps: FloatArray = np.linalg.norm(np.diff(path, 2, axis=0), axis=2).max(axis=0)
    return jumps


def _pops(timeline: Timeline, without: Timeline | None) -> list[float]:
    """Return the greatest jump [m] of each freeze and unfreeze, minus the jump in the run without the extension."""
    pops = []
    for body, frame in _events(timeline.recording):
        jump = _jump(timeline, body, frame)
        if without is not None and body in without.bodies:
            jump = np.maximum(jump - _jump(without, body, frame), 0.0)
        pops.append(float(jump.max()))
    return pops


def _changes_of_frozen(recording: Recording) -> list[int]:
    """Return the frames in which the set of frozen bricks changes, at most ``MOST_CHANGES``, evenly chosen."""
    first = np.diff(recording.body, prepend=-1) != 0
    before = np.where(first, LIVE, np.roll(recording.state, 1))
    frames = np.unique(recording.frame[(recording.state == FROZEN) != (before == FROZEN)])
    if len(frames) > MOST_CHANGES:
        frames = frames[np.linspace(0, len(frames) - 1, MOST_CHANGES).round().astype(int)]
    chosen: list[int] = frames.tolist()
    return chosen


def _gap_below_frozen(timeline: Timeline, poses: Poses) -> float:
    """Return the greatest gap [m] between a frozen brick and the nearest body or ground straight below the brick."""
    there = np.flatnonzero(poses.present)
    bricks = Boxes.at(timeline.sizes[there], poses.position[there], poses.quaternion[there])
    clearance = vertical_clearance(bricks, bricks)
    least: npt.NDArray[np.float64] = timeline.sizes[there].min(axis=1)
    clearance[clearance < -SUNK * np.minimum.outer(least, least)] = np.inf  # bodies above, and the brick itself
    if timeline.recording.fixed:
        below = vertical_clearance(bricks, Boxes.of(timeline.recording.fixed))
        below[below < -SUNK * least[:, None]] = np.inf
        clearance = np.hstack([clearance, below])
    gaps = np.minimum(clearance.min(axis=1), height_above_ground(bricks))[poses.frozen[there]]
    return float(max(gaps.max(initial=0.0), 0.0))


def _unsupported_s(timeline: Timeline, changes: list[int]) -> float:
    """Return the brick-seconds of frozen bricks without an equilibrium, from each change until the next [s]."""
    recording = timeline.recording
    times = [frame * recording.frame_s for frame in changes]
    if not times:
        return 0.0
    margins = margins_of(recording, times)
    total = 0.0
    for row, (time, end) in enumerate(zip(times, [*times[1:], timeline.end_s], strict=True)):
        falls = margins.load_n[row] <= 0.0
        total += (end - time) * int((timeline.at(time).frozen & falls).sum())
    return total


def _late_s(timeline: Timeline, due_s: float, visible: float) -> float | None:
    """Return the time [s] from ``due_s`` until a brick has moved by ``visible`` [m]; None if no brick moves that far.

    The function measures motion from the poses one frame before ``due_s``, of bricks that are in the world then and
    later.
    """
    recording = timeline.recording
    due = round(due_s / recording.frame_s)
    before = timeline.at((due - 1) * recording.frame_s)
    for frame in range(due, recording.frames):
        poses = timeline.at(frame * recording.frame_s)
        both = before.present & poses.present
        if (np.linalg.norm(poses.position - before.position, axis=1)[both] >= visible).any():
            return (frame - due) * recording.frame_s
    return None


def kept_share(recording: Recording, from_s: float) -> float:
    """Return the share of bricks that move by less than their least edge from ``from_s`` [s] for ``KEPT_S``.

    The share counts the bricks that are in the world all this time. The result is NaN without such bricks.
    """
    timeline = Timeline(recording)
    first, last = round(from_s / recording.frame_s), round((from_s + KEPT_S) / recording.frame_s)
    before = timeline.at(first * recording.frame_s)
    there, farthest = before.present.copy(), np.zeros(len(timeline.bodies))
    for frame in range(first, min(last, recording.frames - 1) + 1):
        poses = timeline.at(frame * recording.frame_s)
        there &= poses.present
        farthest = np.maximum(farthest, np.linalg.norm(poses.position - before.position, axis=1))
    kept = farthest < timeline.sizes.min(axis=1)
    return float(kept[there].mean()) if there.any() else math.nan


def perception_table(trial: str, found: Perceived) -> Table:
    """Return the table of the figures of one trial, for the near and the far camera."""
    rows = tuple(
        (
            camera,
            f"{found.pixels(found.pop_m, far=far):.2f}",
            f"{found.pixels(found.hover_m, far=far):.2f}",
            NOTHING if found.unsupported_s is None else f"{found.unsupported_s:.2f}",
            NOTHING if found.late_s is None else f"{found.late_s:.2f}",
            str(found.events),
        )
        for camera, far in (("near", False), ("far", True))
    )
    notes = (
        f"Not a user study. Pixels of {LINES} lines; near: the scene fills the height; far: {FAR:g} times as far. "
        f"A length below {VISIBLE_PX:g} px cannot be seen.",
    )
    header = ("camera", "pop px", "hover px", "unsupported s", "late s", "freezes and unfreezes")
    return Table(f"Perception of {trial} (not a user study)", header, rows, notes, id="perception")


def main() -> None:
    """Print the figures of one trial."""
    parser = argparse.ArgumentParser(description="What a viewer could notice of frozen bricks: not a user study.")
    parser.add_argument("folder", type=Path, help="results folder with recordings")
    parser.add_argument("trial", help="id of the trial with the extension")
    parser.add_argument("--without", help="id of the trial of the same scene without the extension")
    parser.add_argument("--due", type=float, help="time [s] from which the stack must fall")
    parser.add_argument("--kept-from", type=float, help="time [s] from which bricks must keep their places")
    arguments = parser.parse_args()
    folder = ResultsFolder(arguments.folder)
    without = folder.recording(arguments.without) if arguments.without else None
    recording = folder.recording(arguments.trial)
    found = perceive(recording, without, arguments.due)
    print(to_markdown([perception_table(arguments.trial, found)]))  # noqa: T201 - a command
    if arguments.kept_from is not None:
        print(f"kept: {kept_share(recording, arguments.kept_from):.0%} of the bricks")  # noqa: T201


if __name__ == "__main__":
    main()
