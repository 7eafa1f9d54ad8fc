"""Draw bricks off screen with PyVista: ``python -m reports.replays.rendering JOBS`` draws the jobs in the file JOBS.

``reports.replays.stills`` starts this module as a separate process, because VTK ends its process if the machine has no
renderer.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv
from PIL import Image, ImageDraw, ImageFilter

FloatArray = npt.NDArray[np.float64]

_CORNERS = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
"""Corners of the unit cube, shape (8, 3), and its faces as indices of corners, counterclockwise seen from outside."""
_TURN, _LIFT, _VIEW_ANGLE = -1.2, 0.3, 30.0
"""Azimuth and elevation of the camera [rad], as in a replay, and its view angle [deg]."""
_OVERSAMPLING = 2
"""Factor by which a picture is drawn larger before it is reduced, so that edges are smooth with any renderer."""
_TO_SUN = np.array([-0.5, -0.9, 1.6])
"""Direction toward the sun, shape (3,), world frame, not normalised."""
_SUNS, _SUN_RADIUS = 8, 0.12
"""Number of points on the disc of the sun, and radius of the disc for a distance of 1. The average of the shadows of
these points has soft edges; PyVista's own shadows are hard and grey."""
_DARKEST, _SHADOW_PIXELS, _BLUR_PIXELS = 110, 320, 1.5
"""Opacity of the full shadow (0 to 255), edge of its picture [pixels] and radius of its blur [pixels]."""
_EDGES = {"show_edges": True, "edge_color": "#1b2730", "edge_opacity": 0.45, "line_width": 1.5}


def render(jobs: Sequence[Mapping[str, Any]], pixels: int) -> None:
    """Draw a picture for each job, with a transparent background.

    Args:
        jobs: jobs with the path of the picture ``path``, the ``bricks`` (size [m], position [m], quaternion (w, x, y,
            z), colour) and the corners ``low`` and ``high`` of the visible space [m].
        pixels: edge length of the square pictures.
    """
    for job in jobs:
        plotter = pv.Plotter(off_screen=True, window_size=[_OVERSAMPLING * pixels] * 2, lighting="none")
        plotter.set_background("black")  # visible through the half-transparent shadow
        low, high = np.array(job["low"]), np.array(job["high"])
        corners = np.array([_corners(brick) for brick in job["bricks"]]).reshape(-1, 8, 3)
        if len(corners):
            plotter.add_mesh(_mesh(corners, job["bricks"]), scalars="colour", rgb=True, ambient=0.35, **_EDGES)
            plane, shadow = _ground(corners, low, high)
            plotter.add_mesh(plane, texture=shadow, lighting=False)
        _look(plotter, low, high)
        shown = Image.fromarray(plotter.screenshot(return_img=True, transparent_background=True))
        plotter.close()
        shown.reduce(_OVERSAMPLING).save(job["path"], optimize=True)


def _corners(brick: Mapping[str, Any]) -> FloatArray:
    """Return the corners of a brick [m], shape (8, 3), world frame."""
    w, x, y, z = np.array(brick["quaternion"]) / np.linalg.norm(brick["quaternion"])
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    corners: FloatArray = (_CORNERS * brick["size"]) @ turn.T + brick["position"]
    return corners


def _mesh(corners: FloatArray, bricks: Sequence[Mapping[str, Any]]) -> pv.PolyData:
    """Return all bricks as one mesh, because one draw call per brick would take seconds.

    Args:
        corners: corners of the bricks [m], shape (n, 8, 3).
        bricks: the bricks with their colours.
    """
    first = 8 * np.arange(len(corners))[:, None, None]
    faces = np.concatenate([np.full((len(corners), 6, 1), 4), first + _FACES], axis=2)
    mesh = pv.PolyData(corners.reshape(-1, 3), faces.ravel())
    mesh.cell_data["colour"] = np.repeat([brick["colour"] for brick in bricks], 6, axis=0).astype(np.uint8)
    return mesh


def _ground(corners: FloatArray, low: FloatArray, high: FloatArray) -> tuple[pv.PolyData, pv.Texture]:
    """Return the ground plane and its texture, which is transparent except for the shadow of the bricks.

    Args:
        corners: corners of the bricks [m], shape (n, 8, 3), world frame.
        low: lower corner of the visible space [m], shape (3,).
        high: upper corner of the visible space [m], shape (3,).
    """
    centre, half = (low + high)[:2] / 2, 2.0 * float(np.linalg.norm(high - low))
    plane = pv.Plane(center=(*centre, 0.0), i_size=2 * half, j_size=2 * half)
    alpha = _shadow((corners - [*(centre - half), 0]) / (2 * half) * _SHADOW_PIXELS)
    texture = np.zeros((_SHADOW_PIXELS, _SHADOW_PIXELS, 4), np.uint8)
    texture[..., 3] = alpha
    return plane, pv.Texture(texture)


def _shadow(corners: FloatArray) -> npt.NDArray[np.uint8]:
    """Return the opacity of the shadow on the ground, seen from above, shape (``_SHADOW_PIXELS``, ``_SHADOW_PIXELS``).

    Args:
        corners: corners of the bricks [pixels], shape (n, 8, 3).
    """
    sun, rng = _TO_SUN / np.linalg.norm(_TO_SUN), np.random.default_rng(0)
    right = np.cross(sun, [0.0, 0.0, 1.0])
    total = np.zeros((_SHADOW_PIXELS, _SHADOW_PIXELS))
    for angle, radius in zip(np.arange(_SUNS) * 2 * np.pi / _SUNS, np.sqrt(rng.uniform(size=_SUNS)), strict=True):
        ray = sun + _SUN_RADIUS * radius * (np.cos(angle) * right + np.sin(angle) * np.cross(sun, right))
        flat = corners[..., :2] - corners[..., 2:] * ray[:2] / ray[2]
        flat[..., 1] = _SHADOW_PIXELS - flat[..., 1]  # the rows of a picture run downward
        image = Image.new("L", total.shape)
        draw = ImageDraw.Draw(image)
        for face in flat[:, _FACES].reshape(-1, 8).tolist():
            draw.polygon(face, fill=_DARKEST)
        total += np.asarray(image)
    shade = Image.fromarray((total / _SUNS).astype(np.uint8)).filter(ImageFilter.GaussianBlur(_BLUR_PIXELS))
    return np.asarray(shade)


def _look(plotter: pv.Plotter, low: FloatArray, high: FloatArray) -> None:
    target, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    towards = np.array([np.cos(_TURN) * np.cos(_LIFT), np.sin(_TURN) * np.cos(_LIFT), np.sin(_LIFT)])
    eye = target + 1.05 * radius / np.sin(np.radians(_VIEW_ANGLE / 2)) * towards
    plotter.camera_position = [tuple(eye), tuple(target), (0.0, 0.0, 1.0)]
    plotter.camera.view_angle = _VIEW_ANGLE
    plotter.reset_camera_clipping_range()
    for place, intensity in ((target + 9 * radius * _TO_SUN, 0.75), (eye, 0.3)):
        plotter.add_light(pv.Light(position=tuple(place), focal_point=tuple(target), intensity=intensity))


if __name__ == "__main__":
    wanted = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    render(wanted["jobs"], wanted["pixels"])
