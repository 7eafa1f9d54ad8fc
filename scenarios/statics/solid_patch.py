"""The contact patch of two convex solids: corners and normal, for polyhedra, spheres, capsules and cylinders.

Two solids touch if a direction n separates them with a gap of zero. The gap along n is -h1(n) - h2(-n), with the
support functions h1 and h2 of both solids (``convex_solids``). The direction of the greatest gap is one of these
*candidates*:

- the normals of both solids' faces, and the axes of cylinders;
- the cross products of an edge of each solid, where the axis of a cylinder counts as an edge;
- the direction from a vertex or an edge of one core to the nearest point of the other core, if a solid is round there;
- the normals at the rim of a cylinder that meets an edge, an axis or another rim (``rims``).

The patch is the common part of both solids' features along the normal. The normal is definite in these cases:

1. the patch lies inside a face, or inside the end face of a cylinder;
2. two edges that are not parallel cross each other;
3. one surface is smooth where the solids touch: a ball, or the side of a cylinder;
4. two parallel edges of polyhedra meet: a convention gives the normal, as for boxes (``contact_patch``).

In other cases, for example two corners that meet, the solids only graze, and count as apart.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from scenarios.geometry import FloatArray
from scenarios.statics.convex_solids import Solid, perpendicular
from scenarios.statics.polygons import common_part, counter_clockwise, room_inside
from scenarios.statics.rims import rim_normals

Surface = Literal["flat", "edges", "smooth"]
SURFACES: tuple[Surface, ...] = get_args(Surface)
"""Kinds of candidates, in the order in which the method tries them."""
_PARALLEL = 1e-9
"""Sine of the angle below which two edges count as parallel, because rounding leaves about 1e-16."""
_NO_DIRECTIONS = np.empty((0, 3))


class OverlapError(ValueError):
    """Error for two solids that overlap."""

    def __init__(self, depth: float) -> None:
        super().__init__(
            f"bodies may touch, but must not overlap, got an overlap of {depth:g} m: move the bodies apart"
        )
        self.depth = depth
        """Least distance [m] by which a solid must move to end the overlap."""


def solids_touch(
    first: Solid, second: Solid, *, gap: float, ridge_gap: float, parallel: float, is_bisector: bool = True
) -> tuple[FloatArray, FloatArray] | None:
    """Return the corners (k, 3) [m] and the normal (3,) of two solids' patch; None if the solids are apart or graze.

    Args:
        first: the solid from which the normal points.
        second: the solid to which the normal points.
        gap: greatest gap or overlap [m] of solids that touch.
        ridge_gap: greatest gap [m] between two parallel edges that meet.
        parallel: sine of the angle below which two directions count as parallel.
        is_bisector: True for the bisector as the normal of two parallel edges, False for the face of ``first``.

    Raises:
        OverlapError: if the solids overlap.
    """
    flat = np.concatenate([_flats(first), -_flats(second)])
    edges = _both_ways(_across_edges(first, second, parallel))
    smooth = _both_ways(_from_round_surfaces(first, second))
    gaps = [_gaps(first, second, normals) for normals in (flat, edges, smooth)]
    widest = max(float(values.max(initial=-np.inf)) for values in gaps)
    if widest <= gap and (first.disk or second.disk):
        rims = _both_ways(rim_normals(first, second))
        smooth = np.concatenate([smooth, rims])
        gaps[2] = np.concatenate([gaps[2], _gaps(first, second, rims)])
        widest = max(widest, float(gaps[2].max(initial=-np.inf)))
    if widest > max(ridge_gap, gap):
        return None
    if widest < -gap:
        raise OverlapError(-widest)
    if widest <= gap:
        for normals, values, surface in zip((flat, edges, smooth), gaps, SURFACES, strict=True):
            for normal in normals[values >= -gap]:
                points = _shared(first, second, normal, gap, surface)
                if len(points):
                    return points, normal
    return _meeting_edges(first, second, flat[gaps[0] >= -gap], max(ridge_gap, gap), parallel, is_bisector)


def all_candidates(first: Solid, second: Solid) -> FloatArray:
    """Return all candidate normals (k, 3) from the first to the second solid; a normal may occur several times."""
    parts = [_flats(first), -_flats(second), _both_ways(_across_edges(first, second, _PARALLEL))]
    parts.append(_both_ways(_from_round_surfaces(first, second)))
    if first.disk or second.disk:
        parts.append(_both_ways(rim_normals(first, second)))
    return np.concatenate(parts)


def separation(first: Solid, second: Solid) -> tuple[float, FloatArray]:
    """Return the greatest gap [m] over all candidates, and its normal (3,); a negative gap means an overlap."""
    normals = all_candidates(first, second)
    gaps = _gaps(first, second, normals)
    best = int(gaps.argmax())
    return float(gaps[best]), normals[best]


def _gaps(first: Solid, second: Solid, normals: FloatArray) -> FloatArray:
    if not len(normals):
        return np.empty(0)
    return -first.support(normals) - second.support(-normals)


def _both_ways(normals: FloatArray) -> FloatArray:
    return np.concatenate([normals, -normals])


def _flats(solid: Solid) -> FloatArray:
    """Return the outward normals of a solid's flat surfaces."""
    return np.array([solid.axis, -solid.axis]) if solid.disk else solid.face_normals


def _directions(solid: Solid) -> FloatArray:
    along = solid.core[solid.edges[:, 1]] - solid.core[solid.edges[:, 0]]
    unit: FloatArray = along / np.linalg.norm(along, axis=1)[:, None]
    return unit


def _across_edges(first: Solid, second: Solid, parallel: float) -> FloatArray:
    """Return unit vectors (k, 3), each perpendicular to an edge of each solid, for edges that are not parallel."""
    normals = np.cross(_directions(first)[:, None], _directions(second)[None]).reshape(-1, 3)
    length = np.linalg.norm(normals, axis=1)
    crossed = length > parallel
    unit: FloatArray = normals[crossed] / length[crossed, None]
    return np.unique(unit.round(12), axis=0) if len(unit) > len(first.edges) + len(second.edges) else unit


def _from_round_surfaces(first: Solid, second: Solid) -> FloatArray:
    """Return unit vectors (k, 3) from vertices or lines of edges of a core to vertices of the other core.

    The result contains only the vectors that may be normals of a round surface.
    """
    normals = []
    if first.ball or second.ball:
        between = (second.core[None] - first.core[:, None]).reshape(-1, 3)
        normals += [between, _from_lines(first, second.core), _from_lines(second, first.core)]
    normals += [_from_lines(solid, other.core) for solid, other in ((first, second), (second, first)) if solid.disk]
    return _unit(np.concatenate([_NO_DIRECTIONS, *normals]))


def _from_lines(solid: Solid, points: FloatArray) -> FloatArray:
    """Return the perpendicular vectors from the line of each of e edges to each of p points, shape (e p, 3)."""
    along = _directions(solid)
    between = points[None] - solid.core[solid.edges[:, 0]][:, None]
    across: FloatArray = between - np.einsum("epd,ed->ep", between, along)[..., None] * along[:, None]
    return across.reshape(-1, 3)


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1)
    nonzero = length > 1e-12 * length.max(initial=0.0)
    unit: FloatArray = vectors[nonzero] / length[nonzero, None]
    return unit


def _shared(first: Solid, second: Solid, normal: FloatArray, gap: float, surface: Surface) -> FloatArray:
    """Return the corners (k, 3) [m] of the patch along a normal; no corners if the solids only graze.

    Args:
        first: the solid from which the normal points.
        second: the solid to which the normal points.
        normal: the unit normal.
        gap: greatest gap [m].
        surface: kind of candidate. For ``flat`` the middle of the patch must lie inside a polygon; ``edges`` must
            cross.
    """
    plane = perpendicular(normal)
    features = [first.feature(normal, gap), second.feature(-normal, gap)]
    if surface == "edges" and [len(feature) for feature in features] != [2, 2]:
        return _NO_DIRECTIONS
    height = float(np.mean([(feature @ normal).mean() for feature in features]))
    figures = [counter_clockwise(feature @ plane.T) for feature in features]
    part = common_part(figures[0], figures[1], gap)
    if surface == "edges" and len(part) != 1:
        return _NO_DIRECTIONS
    if surface == "flat" and len(part):
        polygons = [figure for figure in figures if len(figure) > 2]
        if max((room_inside(figure, part.mean(axis=0)) for figure in polygons), default=0.0) <= gap:
            return _NO_DIRECTIONS
    return part @ plane + height * normal


def _meeting_edges(
    first: Solid, second: Solid, faces: FloatArray, ridge_gap: float, parallel: float, is_bisector: bool
) -> tuple[FloatArray, FloatArray] | None:
    """Return the segment (2, 3) [m] in which two parallel edges meet, and the normal (3,); None if no edges meet.

    Args:
        first: the solid from which the normal points.
        second: the solid to which the normal points.
        faces: normals of the faces that separate the solids. These normals bound the range of separating directions.
        ridge_gap: greatest gap [m] between the edges.
        parallel: sine of the angle below which two directions count as parallel.
        is_bisector: True for the middle of the range, False for the face of ``first``.
    """
    if not len(faces):
        return None
    bisector = faces.sum(axis=0)
    bisector /= np.linalg.norm(bisector)
    depth = 1e-3 * ridge_gap
    near, far = first.feature(bisector, depth), second.feature(-bisector, depth)
    if len(near) != 2 or len(far) != 2:
        return None
    along = near[1] - near[0]
    along /= np.linalg.norm(along)
    between = far.mean(axis=0) - near.mean(axis=0)
    apart = float(np.linalg.norm(between - along * (along @ between)))
    turned = float(np.linalg.norm(np.cross(along, far[1] - far[0])))
    if apart > ridge_gap or turned > max(parallel, 1e-9) * np.linalg.norm(far[1] - far[0]):
        return None
    low = max((near @ along).min(), (far @ along).min())
    high = min((near @ along).max(), (far @ along).max())
    if high - low <= depth:
        return None
    middle = (near.mean(axis=0) + far.mean(axis=0)) / 2
    points = middle + np.outer([low, high] - along @ middle, along)
    own = faces[np.abs(faces @ first.face_normals.T - 1).min(axis=1) < parallel] if len(first.face_normals) else faces
    return points, bisector if is_bisector or not len(own) else own[0]
