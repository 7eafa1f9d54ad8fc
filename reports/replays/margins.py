"""The margins of the bricks of a recording (``scenarios.statics.brick_margins``), and the colours that show them.

The contacts come from the recorded poses; ``contact_patch.RECORDED`` is the tolerance for the gaps and overlaps that an
engine leaves. The margins assume that all bricks are at rest in these poses, and that no manipulator exerts a force.
"""

from __future__ import annotations

import bisect
import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from reports.records.atomic import write_atomic
from reports.records.recording import REMOVED, FloatArray, Recording
from reports.replays.errors import ExportError
from reports.replays.timeline import Timeline
from scenarios.model import Brick
from scenarios.statics.brick_margins import brick_margins
from scenarios.statics.contact_patch import RECORDED, Patch, contact_patches

Quantity: TypeAlias = Literal["load", "tilt"]
QUANTITIES: tuple[Quantity, ...] = ("load", "tilt")
"""Kinds of margin that pictures and replays show: additional load, and tilt of gravity."""

MOST_INSTANTS = 60
"""Greatest number of instants of ``settled_times``, because the margins at an instant take about 10 ms per brick."""
_ROUNDING_S = 1e-9
"""Bound of the rounding error of times [s]."""
_MOST_TOUCH = 0.2
"""Greatest overlap of two bricks that counts as contact, as a share of the thinnest edge: 1.6 mm for planks. A plank
that has sunk into another plank can overlap that far."""

MARGIN_COLOURS = ((74, 20, 60), (215, 72, 39), (252, 158, 89), (252, 226, 150), (145, 191, 219), (69, 117, 180))
"""Colours of the classes of margins, from no margin to the largest. The first colour, for no margin, is the darkest;
the other colours are the scheme RdYlBu (https://colorbrewer2.org), which colour-blind readers can distinguish."""
LOAD_CLASSES, TILT_CLASSES = (1.0, 3.0, 10.0, 30.0), (2.0, 5.0, 10.0, 20.0)
"""Limits between the classes of positive margins: ratio of the additional load to the brick's weight, and tilt
[deg]."""


class _OverlapError(ExportError):
    """An overlap of bricks that leaves their contacts unknown."""


@dataclass(frozen=True, slots=True)
class Margins:
    """The margins of the n bricks of a recording at t instants.

    A margin is valid from the previous instant to its own instant.
    """

    bodies: npt.NDArray[np.int64]
    """Ids of the bricks, shape (n,)."""
    times: list[float]
    """Simulated times of the instants [s], ascending, t entries."""
    load_n: FloatArray
    """Greatest additional load [N], shape (t, n). NaN for bricks that are not in the world or that the host moves. At
    an instant at which bricks overlap so far that their contacts are unknown, NaN for all bricks."""
    tilt_deg: FloatArray
    """Greatest tilt of gravity [deg], shape (t, n); NaN where ``load_n`` is NaN."""
    weight_n: FloatArray
    """Weight of each brick in the gravity of the start [N], shape (n,); NaN for bricks that the host moves."""

    def classes(self, quantity: Quantity) -> npt.NDArray[np.int64]:
        """Return the index into ``MARGIN_COLOURS`` of each margin, shape (t, n); -1 for NaN."""
        values = self.tilt_deg if quantity == "tilt" else self.load_n / self.weight_n
        limits = TILT_CLASSES if quantity == "tilt" else LOAD_CLASSES
        found = np.where(values > 0, 1 + np.searchsorted(limits, values, side="right"), 0)
        classes: npt.NDArray[np.int64] = np.where(np.isnan(values), -1, found)
        return classes

    def row(self, time: float) -> int:
        """Return the index of the first instant that is not before ``time`` [s]; else the index of the last instant."""
        return min(bisect.bisect_left(self.times, time - _ROUNDING_S), len(self.times) - 1)


def legend(quantity: Quantity) -> tuple[str, list[str]]:
    """Return the title and the names of the classes for the legend of a kind of margin."""
    limits, unit = (TILT_CLASSES, "°") if quantity == "tilt" else (LOAD_CLASSES, "")
    names = ["none", *(f"<{limit:g}{unit}" for limit in limits), f"{limits[-1]:g}{unit}+"]
    return ("tilt margin " if quantity == "tilt" else "load margin / weight "), names


def margins_of(recording: Recording, times: Sequence[float] | None = None, *, trial: str = "this recording") -> Margins:
    """Return the margins of a recording.

    Args:
        recording: a recording with masses, friction and gravity.
        times: instants [s]; None for ``settled_times``.
        trial: name of the recording in errors.

    Raises:
        ExportError: see ``margins_beside``.
    """
    return margins_beside({trial: recording}, times)[0]


def margins_beside(recordings: Mapping[str, Recording], times: Sequence[float] | None = None) -> list[Margins]:
    """Return the margins of recordings that a picture or replay shows side by side, in the order of the recordings.

    Args:
        recordings: recordings with masses, friction and gravity, by trial id.
        times: instants [s]; None for the ``settled_times`` of each recording.

    Raises:
        ExportError: if a recording has no masses, or if in all recordings and at all instants bricks overlap so far
            that their contacts are unknown.
    """
    found, overlaps = [], []
    for trial, recording in recordings.items():
        margins, overlap = _margins(trial, recording, times)
        found.append(margins)
        overlaps.append(overlap)
    if all(overlaps):
        raise ExportError(overlaps[-1])
    return found


def _margins(trial: str, recording: Recording, times: Sequence[float] | None) -> tuple[Margins, str]:
    """Return the margins of a recording, and the reason if no instant has margins, else an empty text."""
    if recording.physics is None:
        raise ExportError(
            f"{trial}: margins need a recording with masses, got a recording of an earlier version without masses: run "
            "the trial again to see margins"
        )
    timeline = Timeline(recording)
    instants = list(settled_times(recording) if times is None else times)
    nothing = np.full(len(timeline.bodies), np.nan)
    rows, overlaps = [], []
    for time in instants:
        try:
            rows.append(_at(timeline, time))
        except _OverlapError as error:
            rows.append((nothing, nothing))
            overlaps.append(str(error))
    shape = len(instants), len(timeline.bodies)
    strength = float(np.linalg.norm(recording.physics.gravity[0][1]))
    masses = [recording.physics.masses.get(body, np.nan) for body in timeline.bodies.tolist()]
    margins = Margins(
        timeline.bodies,
        instants,
        np.array([load for load, _ in rows]).reshape(shape),
        np.array([tilt for _, tilt in rows]).reshape(shape),
        strength * np.array(masses),
    )
    return margins, f"{trial}: {overlaps[-1]}" if 0 < len(overlaps) == len(instants) else ""


def settled_times(recording: Recording) -> list[float]:
    """Return the instants [s] just before a brick appears or leaves, and the end.

    From more than ``MOST_INSTANTS`` instants, the function chooses this number evenly.
    """
    first = np.diff(recording.body, prepend=-1) != 0
    changes = np.unique(recording.frame[first | (recording.state == REMOVED)])
    frames = np.unique(np.append(changes[changes > 0] - 1, recording.frames - 1))
    if len(frames) > MOST_INSTANTS:
        frames = frames[np.linspace(0, len(frames) - 1, MOST_INSTANTS).round().astype(int)]
    times: list[float] = (frames * recording.frame_s).tolist()
    return times


def _at(timeline: Timeline, time: float) -> tuple[FloatArray, FloatArray]:
    """Return load margin [N] and tilt margin [deg] of each brick, each of shape (n,), NaN without a margin."""
    physics = timeline.recording.physics
    assert physics is not None
    poses, count = timeline.at(time), len(timeline.bodies)
    bricks, driven, places = [], list(timeline.recording.fixed), []
    for place in np.flatnonzero(poses.present).tolist():
        mass = physics.masses.get(int(timeline.bodies[place]))
        x, y, z = poses.position[place].tolist()
        w, i, j, k = poses.quaternion[place].tolist()
        length, width, height = timeline.sizes[place].tolist()
        shape = timeline.recording.shape(int(timeline.bodies[place]))
        brick = Brick((length, width, height), mass or 1.0, (x, y, z), (w, i, j, k), shape=shape)
        if mass is None:
            driven.append(brick)
        else:
            bricks.append(brick)
            places.append(place)
    load, tilt = np.full(count, np.nan), np.full(count, np.nan)
    if bricks:
        gravity = physics.gravity_at(int(time / timeline.recording.frame_s))
        centers = np.array([brick.position for brick in bricks])
        weights = np.outer([brick.mass for brick in bricks], gravity)
        unit = float(np.mean([max(brick.size) for brick in bricks]))
        found = brick_margins(centers, weights, _touching(bricks, driven, time), physics.friction, unit)
        load[places], tilt[places] = found.load_n, found.tilt_deg
    return load, tilt


def _touching(bricks: Sequence[Brick], walls: Sequence[Brick], time: float) -> list[Patch]:
    """Return the contact patches of bricks in recorded poses.

    The function increases the tolerated overlap, up to ``_MOST_TOUCH``, until the overlaps of the bricks are within the
    tolerance.
    """
    tolerance = RECORDED
    while True:
        try:
            return contact_patches(bricks, walls, tolerance=tolerance)
        except ValueError as error:
            if tolerance.touch >= _MOST_TOUCH:
                raise _OverlapError(
                    f"margins need bricks that do not overlap, got bricks that have sunk into each other "
                    f"at {time:.2f} s ({error}): draw a still at another time with --at, or choose another trial"
                ) from error
            tolerance = tolerance._replace(touch=min(1.5 * tolerance.touch, _MOST_TOUCH))


def write_margins(path: Path, margins: Margins) -> None:
    """Write margins as CSV: time [s], brick, load margin [N] (``inf`` without a limit) and tilt margin [deg].

    Bricks without a margin (NaN) have no row.
    """
    content = io.StringIO()
    writer = csv.writer(content, lineterminator="\n")
    writer.writerow(("time_s", "brick", "load_margin_n", "tilt_margin_deg"))
    for time, loads, tilts in zip(margins.times, margins.load_n.tolist(), margins.tilt_deg.tolist(), strict=True):
        for body, load, tilt in zip(margins.bodies.tolist(), loads, tilts, strict=True):
            if not np.isnan(tilt):
                writer.writerow((f"{time:.4f}", body, f"{load:.6g}", f"{tilt:.4f}"))
    write_atomic(path, content.getvalue().encode())
