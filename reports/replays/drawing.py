"""The bricks and colours of pictures: a view of recorded trials at given times."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from reports.records.recording import FloatArray, Recording
from reports.replays.camera import CAMERAS, Camera
from reports.replays.renderer import ByteArray, View
from reports.replays.timeline import Poses, Timeline
from scenarios.geometry import Boxes

COLOURS = {"live": (224, 160, 48), "frozen": (91, 159, 201), "fallen": (168, 66, 90)}
"""Colours by state, as in a replay: red, green and blue from 0 to 255. The colours also differ in lightness, so that
colour-blind readers can distinguish the states."""
FIXED_COLOUR = (150, 154, 158)
"""Colour of bodies that never move: red, green and blue from 0 to 255."""
_TINT = 0.08
"""Greatest relative change of a brick's lightness, so that viewers can distinguish neighbours."""


def visible_space(recordings: Sequence[Recording], room: float = 0.0) -> tuple[FloatArray, FloatArray] | None:
    """Return the corners [m], each of shape (3,), of the visible space of recordings; None for an empty space.

    Args:
        recordings: the recordings. The space contains their fixed bodies, and all bricks at their first poses.
        room: greatest growth of the space on each horizontal side for bricks that fell, as a share of the longer
            horizontal edge of the space. The picture leaves out bricks that rolled farther, because in a larger space
            the stack would look too small.
    """
    corners, ends = [], []
    for recording in recordings:
        timeline = Timeline(recording)
        poses = timeline.at(timeline.end_s)
        shapes = [recording.shape(body) for body in timeline.bodies.tolist()]
        reach = Boxes.at(timeline.sizes, poses.position, poses.quaternion, shapes).reach
        laid = Boxes.at(timeline.sizes, timeline.first, timeline.first_turn, shapes)
        ends += [*(poses.position - reach)[poses.present], *(poses.position + reach)[poses.present]]
        corners += [*(laid.center - laid.reach), *(laid.center + laid.reach)]
        for box in recording.fixed:
            reach = Boxes.of([box]).reach[0]
            corners += [np.array(box.position) - reach, np.array(box.position) + reach]
    if not corners:
        return None
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    if room and ends:
        growth = room * (high - low)[:2].max() * np.array([1.0, 1.0, 0.0])  # nothing falls below the ground, or rises
        return np.clip(np.min(ends, axis=0), low - growth, low), np.clip(np.max(ends, axis=0), high, high + growth)
    return low, high


def view_of(
    timeline: Timeline,
    times: Sequence[float],
    space: tuple[FloatArray, FloatArray],
    pixels: tuple[int, int],
    camera: Camera = CAMERAS["corner"],
    colours: Callable[[float], ByteArray] | None = None,
) -> View:
    """Return the view of a recording at several times.

    Args:
        timeline: the recording.
        times: simulated times [s], one for each frame.
        space: corners of the visible space [m].
        pixels: width and height of the pictures [pixels].
        camera: the camera.
        colours: function that returns red, green and blue of each brick, shape (n, 3), at a time [s]; None for the
            colours of the states.
    """
    poses, fixed = [timeline.at(time) for time in times], timeline.recording.fixed
    tints = 1 + _TINT * np.random.default_rng(0).uniform(-1, 1, len(timeline.bodies))
    boxes = {name: np.array([getattr(box, name) for box in fixed]) for name in ("size", "position", "quaternion")}

    def with_fixed(moving: Sequence[np.ndarray], still: np.ndarray, width: int) -> np.ndarray:
        """Append the rows of the fixed bodies to the rows of the bricks in each frame."""
        rows = still.reshape(-1, width)
        return np.array([np.concatenate([values.reshape(-1, width), rows]) for values in moving])

    paint = [_by_state(pose) for pose in poses] if colours is None else [colours(time) for time in times]
    grey = np.tile(np.array(FIXED_COLOUR, np.uint8), (len(fixed), 1))
    return View(
        pixels,
        *space,
        sizes=with_fixed([timeline.sizes], boxes["size"], 3)[0],
        position=with_fixed([pose.position for pose in poses], boxes["position"], 3),
        quaternion=with_fixed([pose.quaternion for pose in poses], boxes["quaternion"], 4),
        colour=with_fixed([_tinted(painted, tints) for painted in paint], grey, 3),
        shown=with_fixed([pose.present for pose in poses], np.ones(len(fixed), bool), 1)[..., 0],
        camera=camera,
        shapes=(*map(timeline.recording.shape, timeline.bodies.tolist()), *(body.shape for body in fixed)),
    )


def _by_state(poses: Poses) -> ByteArray:
    return np.array([COLOURS[state] for state in poses.states], np.uint8).reshape(-1, 3)


def _tinted(colours: ByteArray, tints: FloatArray) -> ByteArray:
    tinted: ByteArray = np.rint(tints[:, None] * colours).clip(0, 255).astype(np.uint8)
    return tinted
