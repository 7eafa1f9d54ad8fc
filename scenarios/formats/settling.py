"""Removal of slight overlaps and gaps of imported bricks, because files round poses and statics needs exact contacts.

The module takes the bricks from the lowest brick up, and moves each brick in two steps:

1. The brick may overlap a lower brick or a fixed body sideways. If the overlap is at most ``OVERLAP``, the module
   shifts the brick along the normal of the overlap.
2. The brick sinks by at most ``GAP``, or rises by at most ``OVERLAP``, until it touches the body or the ground below.

The error for a larger overlap or gap names both bodies. Each brick that moves by more than
``REPORTED`` gets a note.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from scenarios.formats.imported import Imported, ImportRefusedError
from scenarios.geometry import Boxes, FloatArray, height_above_ground, vertical_clearance
from scenarios.model import Brick
from scenarios.statics.patches_of_solids import solid_of
from scenarios.statics.solid_patch import separation

OVERLAP = 1e-3
"""Greatest overlap [m] that counts as rounding of a pose, because files give millimetres."""
GAP = 10e-3
"""Greatest gap [m] below a body that counts as a spawn height, because files release bodies a little above a table."""
UPRIGHT_NORMAL = 0.7
"""Vertical part of the unit normal from which step 2 removes an overlap, not step 1."""
EXACT = 1e-9
"""Overlap [m] below which two bodies count as touching."""
REPORTED = 1e-7
"""Least change of a pose [m] that gets a note, because MuJoCo keeps vertices of meshes in single precision."""


def settled(imported: Imported) -> Imported:
    """Return the content with all bricks in exact contact, lowest brick first, and a note about each moved brick.

    A brick that moves by at most ``REPORTED`` gets no note.

    Raises:
        ImportRefusedError: if a brick overlaps another body or the ground by more than ``OVERLAP``, or floats by more
            than ``GAP``; the message names both bodies and the fix.
    """
    there = [(f"fixed body {index}", body) for index, body in enumerate(imported.world.fixed)]
    order = np.argsort(height_above_ground(Boxes.of(imported.bricks)), kind="stable").tolist()
    bricks: list[Brick] = []
    notes = list(imported.notes)
    for index in order:
        brick, name = imported.bricks[index], imported.names[index]
        moved = _sunk(name, _moved_aside(name, brick, there), there)
        shift = np.subtract(moved.position, brick.position)
        if np.abs(shift).max() > REPORTED:
            x, y, z = (1e3 * shift).tolist()
            notes.append(f"{name} moved by ({x:.3f}, {y:.3f}, {z:.3f}) mm, so that it touches what is below it exactly")
        bricks.append(moved)
        there.append((name, moved))
    return replace(
        imported, bricks=tuple(bricks), names=tuple(imported.names[index] for index in order), notes=tuple(notes)
    )


def _moved_aside(name: str, brick: Brick, there: Sequence[tuple[str, Brick]]) -> Brick:
    for other, body in there:
        gap, normal = separation(solid_of(body), solid_of(brick))
        if gap < -OVERLAP:
            raise ImportRefusedError(
                f"{name} overlaps {other} by {-gap * 1e3:.3f} mm, more than {OVERLAP * 1e3:g} mm: move the bodies apart"
            )
        if -OVERLAP <= gap < -EXACT and abs(normal[2]) < UPRIGHT_NORMAL:
            brick = _shifted(brick, -gap * normal)
    return brick


def _sunk(name: str, brick: Brick, there: Sequence[tuple[str, Brick]]) -> Brick:
    box = Boxes.of([brick])
    room, below = float(height_above_ground(box)[0]), "the ground"
    distances = vertical_clearance(box, Boxes.of([body for _, body in there]))[0].tolist()
    for (other, _), distance in zip(there, distances, strict=True):
        if -OVERLAP <= distance < room:
            room, below = distance, other
    if room < -OVERLAP:
        raise ImportRefusedError(
            f"{name} overlaps {below} by {-room * 1e3:.3f} mm, more than {OVERLAP * 1e3:g} mm: raise {name} by this "
            "overlap"
        )
    if room > GAP:
        raise ImportRefusedError(
            f"{name} floats {room * 1e3:.1f} mm above {below}, more than {GAP * 1e3:g} mm: lower {name} by this "
            "height, or use a TOML file, which gives the time of each placement"
        )
    return _shifted(brick, np.array([0.0, 0.0, -room])) if math.isfinite(room) else brick


def _shifted(brick: Brick, shift: FloatArray) -> Brick:
    x, y, z = (np.array(brick.position) + shift).tolist()
    return replace(brick, position=(x, y, z))
