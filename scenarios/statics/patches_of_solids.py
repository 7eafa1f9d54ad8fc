"""The contact patches of bricks of any shape: with each other, with walls, and with the ground."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from scenarios.geometry import rotation
from scenarios.model import Brick
from scenarios.shapes import Polyhedron
from scenarios.statics.contact_patch import GROUND, PLANNED, RIDGE_GAP, Patch, Ridge, Tolerance
from scenarios.statics.convex_solids import Solid, capsule, cylinder, polyhedron, sphere
from scenarios.statics.solid_patch import solids_touch

_CORNERS = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
_DOWN = np.array([0.0, 0.0, -1.0])


def solid_of(brick: Brick) -> Solid:
    """Return the solid of a brick in its planned pose."""
    frame = rotation(np.array([brick.quaternion]))[0]
    center, (x, _, z) = np.array(brick.position), brick.size
    match brick.shape:
        case "sphere":
            return sphere(center, x / 2)
        case "capsule":
            return capsule(center, frame[:, 2], z - x, x / 2)
        case "cylinder":
            return cylinder(center, frame[:, 2], z, x / 2)
        case Polyhedron() as shape:
            return polyhedron(center + shape.array @ frame.T)
    return polyhedron(center + (_CORNERS * np.array(brick.size)) @ frame.T)


def patches_of_solids(
    bricks: Sequence[Brick],
    walls: Sequence[Brick] = (),
    *,
    ridge: Ridge = "bisector",
    tolerance: Tolerance = PLANNED,
) -> list[Patch]:
    """Return all patches of bricks of any shape.

    ``contact_patch.contact_patches`` describes the arguments and the errors.
    """
    solids = [solid_of(brick) for brick in (*bricks, *walls)]
    patches = [
        patch
        for index, solid in enumerate(solids[: len(bricks)])
        if (patch := _on_ground(index, solid, tolerance)) is not None
    ]
    for a, b in _near_pairs(solids, max(RIDGE_GAP, tolerance.touch)):
        if a >= len(bricks):
            continue  # two walls
        thin = min(solids[a].thinnest, solids[b].thinnest)
        try:
            touch = solids_touch(
                solids[a],
                solids[b],
                gap=tolerance.touch * thin,
                ridge_gap=RIDGE_GAP * thin,
                parallel=tolerance.parallel,
                is_bisector=ridge == "bisector",
            )
        except ValueError as error:
            second = f"brick {b}" if b < len(bricks) else f"wall {b - len(bricks)}"
            raise ValueError(f"brick {a} and {second}: {error}") from None
        if touch is not None:
            points, normal = touch
            is_wall = b >= len(bricks)
            patch_of_wall = Patch(GROUND, a, points, -normal, wall=b - len(bricks))
            patches.append(patch_of_wall if is_wall else Patch(a, b, points, normal))
    return patches


def _near_pairs(solids: Sequence[Solid], share: float) -> Iterator[tuple[int, int]]:
    """Yield the pairs of solids whose bounding boxes are near each other.

    The greatest distance is ``share`` times the least width of the first solid.
    """
    low, high = np.array([solid.bounds for solid in solids]).transpose(1, 0, 2)
    gaps = share * np.array([solid.thinnest for solid in solids])[:, None]
    for b in range(1, len(solids)):
        apart = np.maximum(low[:b] - high[b], low[b] - high[:b])
        for a in np.flatnonzero((apart <= gaps[:b]).all(axis=1)).tolist():
            yield a, b


def _on_ground(index: int, solid: Solid, tolerance: Tolerance) -> Patch | None:
    """Return the patch of a solid on the ground z = 0; None if the solid is above the ground.

    Raises:
        ValueError: if the solid overlaps the ground.
    """
    height = float(solid.bounds[0, 2])
    gap = tolerance.touch * solid.thinnest
    if height > gap:
        return None
    if height < -gap:
        raise ValueError(
            f"brick {index} must lie at or above z = 0, but is {-height:g} m below the ground: raise brick {index} by "
            "this depth"
        )
    return Patch(GROUND, index, solid.feature(_DOWN, gap), -_DOWN)
