"""A contact sheet: one picture that shows every scene as planned."""

from __future__ import annotations

import math
from collections.abc import Sequence
from graphlib import TopologicalSorter
from itertools import combinations
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from scenarios.geometry import Boxes, FloatArray
from scenarios.model import Brick, Scene

COLUMNS = 5
"""Number of scenes in a row."""
CELL_IN = 2.6
"""Edge length of the picture of a scene [inch]."""
AZIMUTH, ELEVATION = math.radians(-62), math.radians(20)
"""Azimuth from the +x axis and elevation above the ground of the direction toward the viewer [rad]; the azimuth lies 28
degrees from the -y axis toward the +x axis."""
LIGHT = np.array([0.35, -0.55, 0.76])
"""Direction toward the light, shape (3,), world frame; unit length up to rounding."""
AMBIENT = 0.45
"""Brightness of a face without direct light, as a share of the brightness of a face that faces the light."""
FAMILY_COLOR = {"stand": "#d9a760", "fall": "#c9694f", "study": "#8fa3b5"}
"""Colour of the bricks, by expected outcome of the scene."""
FIXED_COLOR = "#b9bcc0"
"""Colour of boxes that never move."""
_GRAZE = 1e-6
"""Greatest overlap of two boxes in the picture [m] that counts as no overlap, because a reader cannot see this
overlap."""
_FACES = ((0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1))
"""Axis and sign of each face of a box."""


def draw_contact_sheet(path: Path, scenes: Sequence[Scene]) -> None:
    """Write a picture of all ``scenes`` to ``path``; the suffix of ``path`` selects the format.

    Raises:
        ValueError: if matplotlib cannot write a file with this suffix.
    """
    rows = math.ceil(len(scenes) / COLUMNS)
    figure = Figure(figsize=(COLUMNS * CELL_IN, rows * CELL_IN), layout="constrained")
    cells = np.atleast_2d(figure.subplots(rows, COLUMNS)).ravel()
    for cell in cells:
        cell.set_axis_off()
    for cell, scene in zip(cells, scenes, strict=False):
        _draw(cell, scene)
    figure.savefig(path, dpi=110, facecolor="white")


def _draw(axes: Axes, scene: Scene) -> None:
    """Draw the faces of one scene from back to front."""
    polygons, colors = faces(scene.bricks, FAMILY_COLOR[scene.expectation.outcome], scene.world.fixed)
    axes.add_collection(PolyCollection(list(polygons), facecolors=list(colors), edgecolors="#3b2a1a", linewidths=0.35))
    corners = polygons.reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, reach = (low + high) / 2, 0.56 * (high - low).max()
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)
    axes.set_aspect("equal")
    axes.set_title(f"{scene.variant}\n{scene.expectation}", fontsize=8, color="#333333")


def faces(bricks: Sequence[Brick], color: str, fixed: Sequence[Brick] = ()) -> tuple[FloatArray, FloatArray]:
    """Return the faces of ``bricks`` and of ``fixed`` boxes that face the viewer, from back to front.

    Returns:
        Corners of the n faces in the picture [m], shape (n, 4, 2), and colours from 0 to 1, shape (n, 3).
    """
    right, up, toward = _view()
    boxes = Boxes.of([*bricks, *fixed])
    polygons, colors = [], []
    for index in from_back_to_front(boxes, toward):
        center, half_axes = boxes.center[index], boxes.half_axes[index]
        own = np.array(to_rgb(color if index < len(bricks) else FIXED_COLOR))
        for axis, sign in _FACES:
            outward = sign * half_axes[axis] / np.linalg.norm(half_axes[axis])
            if outward @ toward <= 0:
                continue
            u, v = half_axes[(axis + 1) % 3], half_axes[(axis + 2) % 3]
            corners = center + sign * half_axes[axis] + np.array([-u - v, u - v, u + v, -u + v])
            polygons.append(np.column_stack([corners @ right, corners @ up]))
            colors.append(own * (AMBIENT + (1 - AMBIENT) * max(0.0, float(outward @ LIGHT))))
    return np.array(polygons), np.clip(colors, 0, 1)


def from_back_to_front(boxes: Boxes, toward: FloatArray) -> list[int]:
    """Return the order in which to paint boxes that do not intersect, as indices from back to front.

    The function uses the painter's algorithm. It compares two boxes along the normals of their faces. The box on the
    viewer's side of the widest gap comes later. Boxes whose pictures do not overlap may come in any order.

    Args:
        boxes: n boxes that do not intersect, world frame.
        toward: direction toward the viewer, shape (3,), world frame.

    Raises:
        CycleError: if boxes cover one another in a circle, so that no order exists.
    """
    order: TopologicalSorter[int] = TopologicalSorter(dict.fromkeys(range(len(boxes)), ()))
    corners = boxes.corners
    normals = boxes.half_axes / np.linalg.norm(boxes.half_axes, axis=2, keepdims=True)
    normals *= np.where(normals @ toward < 0, -1.0, 1.0)[:, :, None]
    for a, b in combinations(range(len(boxes)), 2):
        directions = np.concatenate([normals[a], normals[b]])
        in_picture = np.cross(toward, directions)
        if max(_gap(corners[a], corners[b], in_picture), _gap(corners[b], corners[a], in_picture)) > -_GRAZE:
            continue
        b_in_front = _gap(corners[a], corners[b], directions) > _gap(corners[b], corners[a], directions)
        order.add(*((b, a) if b_in_front else (a, b)))
    return list(order.static_order())


def _gap(lower: FloatArray, upper: FloatArray, directions: FloatArray) -> float:
    """Return the widest gap [m] between two boxes along n directions; negative for boxes without a gap.

    Args:
        lower: corners [m] of the first box, shape (8, 3).
        upper: corners [m] of the second box, farther along the direction, shape (8, 3).
        directions: unit directions, shape (n, 3). For shorter vectors the gap is shorter in proportion.
    """
    return float(((upper @ directions.T).min(axis=0) - (lower @ directions.T).max(axis=0)).max())


def _view() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the unit vectors of the picture in the world frame: to the right, up, and toward the viewer."""
    toward = np.array(
        [math.cos(ELEVATION) * math.cos(AZIMUTH), math.cos(ELEVATION) * math.sin(AZIMUTH), math.sin(ELEVATION)]
    )
    right = np.array([-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0])
    return right, np.cross(toward, right), toward
