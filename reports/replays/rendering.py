"""Off-screen drawing of bricks with PyVista: ``python -m reports.replays.rendering ORDER`` draws the views in a file.

``reports.replays.renderer`` starts this module as a separate process, because VTK ends its process if the machine has
no renderer.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv
from PIL import Image, ImageDraw, ImageFilter

FloatArray = npt.NDArray[np.float64]
ByteArray = npt.NDArray[np.uint8]

_CORNERS = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
"""Corners of the unit cube, shape (8, 3), and its faces as indices of corners, counterclockwise seen from outside."""
_VIEW_ANGLE, _ROOM = 30.0, 1.1
"""Vertical view angle of the camera [deg], and factor on the least distance that shows the visible space."""
_OVERSAMPLING = 2
"""Factor by which the module draws a picture larger and then reduces the picture, so that edges are smooth."""
_TO_SUN = np.array([-0.5, -0.9, 1.6])
"""Direction toward the sun, shape (3,), world frame, not normalised."""
_SUNS, _SUN_RADIUS = 8, 0.12
"""Number of points on the disc of the sun, and ratio of the disc's radius to the sun's distance. The picture shows the
average of the shadows of these points, because this average has soft edges. PyVista's own shadows are hard and grey."""
_DARKEST, _BLUR = 110, 1 / 210
"""Opacity of the full shadow (0 to 255), and radius of its blur as a share of the edge of its picture."""
_SHADOW_SHARE, _LEAST_SHADOW, _MOST_SHADOW = 1.5, 320, 2048
"""Edge of the picture of the shadow, as a factor on the longer edge of the whole picture, and its limits [pixels]."""
_EDGES = {"show_edges": True, "edge_color": "#1b2730", "edge_opacity": 0.45, "line_width": 1.5}


@dataclass(frozen=True)
class _Solid:
    """A brick of another shape than a box, in the world frame."""

    corners: FloatArray
    """Corners [m], shape (n, 3)."""
    faces: list[list[int]]
    is_round: bool
    colour: ByteArray
    """Red, green and blue, shape (3,)."""

    def polygons(self) -> list[FloatArray]:
        """Return the corners (k, 3) [m] of each face."""
        return [self.corners[face] for face in self.faces]


class _Stage:
    """A view of bricks on the ground, drawn for one set of poses after another."""

    def __init__(self, view: Mapping[str, Any]) -> None:
        """Set up the camera and the lights of a view; see ``reports.replays.renderer.View``."""
        self._size = [_OVERSAMPLING * edge for edge in view["pixels"]]
        self._plotter = pv.Plotter(off_screen=True, window_size=self._size, lighting="none")
        self._plotter.set_background("black")  # visible through the half-transparent shadow
        edge = round(_SHADOW_SHARE * max(view["pixels"]))
        self._shadow_pixels = min(max(edge, _LEAST_SHADOW), _MOST_SHADOW)
        self._low, self._high = np.array(view["low"]), np.array(view["high"])
        self._look(*view["camera"])

    def draw(self, corners: FloatArray, colours: ByteArray, solids: Sequence[_Solid] = ()) -> Image.Image:
        """Return the picture of bricks with a transparent background.

        Args:
            corners: corners of the boxes [m], shape (n, 8, 3), world frame.
            colours: red, green and blue of each box, from 0 to 255, shape (n, 3).
            solids: bricks of other shapes than boxes.
        """
        plotter = self._plotter
        plotter.clear_actors()
        if len(corners):
            mesh = _mesh(corners, colours)
            plotter.add_mesh(mesh, scalars="colour", rgb=True, ambient=0.35, render=False, reset_camera=False, **_EDGES)
        for is_round in (False, True):
            if drawn := [solid for solid in solids if solid.is_round is is_round]:
                # Sharp edges of round bricks stay visible, and the sides between them look smooth.
                looks: dict[str, Any] = {"smooth_shading": True, "split_sharp_edges": True} if is_round else _EDGES
                plotter.add_mesh(
                    _mesh_of(drawn),
                    scalars="colour",
                    rgb=True,
                    ambient=0.35,
                    render=False,
                    reset_camera=False,
                    **looks,
                )
        if len(corners) or solids:
            faces = [*corners[:, _FACES].reshape(-1, 4, 3), *(face for solid in solids for face in solid.polygons())]
            plane, shadow = _ground(faces, self._low, self._high, self._shadow_pixels)
            plotter.add_mesh(plane, texture=shadow, lighting=False, render=False, reset_camera=False)
        plotter.renderer.reset_camera_clipping_range()
        plotter.render_window.Render()
        shown = Image.fromarray(plotter.screenshot(return_img=True, transparent_background=True))
        return shown.reduce(_OVERSAMPLING)

    def close(self) -> None:
        """Close the window."""
        self._plotter.close()

    def _look(self, azimuth: float, elevation: float, distance: float | None) -> None:
        """Point the camera at the centre of the visible space.

        Args:
            azimuth: direction from the centre to the camera [deg].
            elevation: angle of this direction above the horizontal [deg].
            distance: distance from the centre [m]; None to show the whole visible space.
        """
        turn, lift = np.radians([azimuth, elevation])
        target, half = (self._low + self._high) / 2, (self._high - self._low) / 2
        towards = np.array([np.cos(turn) * np.cos(lift), np.sin(turn) * np.cos(lift), np.sin(lift)])
        up = np.array([-np.cos(turn) * np.sin(lift), -np.sin(turn) * np.sin(lift), np.cos(lift)])
        if distance is None:
            near, rise = 2 * _CORNERS * half @ towards, np.abs(2 * _CORNERS * half @ up)
            aside = np.abs(2 * _CORNERS * half @ np.cross(up, towards)) * self._size[1] / self._size[0]
            distance = _ROOM * float((near + np.maximum(rise, aside) / np.tan(np.radians(_VIEW_ANGLE / 2))).max())
        eye, radius = target + distance * towards, float(np.linalg.norm(half))
        self._plotter.camera_position = [tuple(eye), tuple(target), tuple(up)]
        self._plotter.camera.view_angle = _VIEW_ANGLE
        for place, intensity in ((target + 9 * radius * _TO_SUN, 0.75), (eye, 0.3)):
            self._plotter.add_light(pv.Light(position=tuple(place), focal_point=tuple(target), intensity=intensity))


def render(view: Mapping[str, Any]) -> Iterator[Image.Image]:
    """Yield the pictures of a view, one for each frame; draw a sequence of equal frames only once.

    Args:
        view: fields of ``reports.replays.renderer.View``, with the path ``poses`` of the file of its arrays.
    """
    with np.load(view["poses"]) as poses:
        sizes, positions, quaternions, colours, shown = (
            poses[name] for name in ("sizes", "position", "quaternion", "colour", "shown")
        )
    surfaces = {int(row): surface for row, surface in view.get("surfaces", {}).items()}
    is_box = np.ones(len(sizes), bool)
    is_box[list(surfaces)] = False
    stage, picture, before = _Stage(view), None, b""
    for position, quaternion, colour, is_shown in zip(positions, quaternions, colours, shown, strict=True):
        boxes = is_shown & is_box
        corners = _corners(sizes[boxes], position[boxes], quaternion[boxes])
        solids = [
            _Solid(
                _in_world(np.array(surface["corners"]), position[row], quaternion[row]),
                surface["faces"],
                surface["is_round"],
                colour[row],
            )
            for row, surface in surfaces.items()
            if is_shown[row]
        ]
        now = b"".join([corners.tobytes(), colour[is_shown].tobytes(), *(solid.corners.tobytes() for solid in solids)])
        if picture is None or now != before:
            picture, before = stage.draw(corners, colour[boxes], solids), now
        yield picture
    stage.close()


def _in_world(corners: FloatArray, position: FloatArray, quaternion: FloatArray) -> FloatArray:
    """Return the corners (n, 3) [m] of a brick at its pose, in the world frame."""
    return corners @ _turns(quaternion[None])[:, :, 0].T + position


def _corners(sizes: FloatArray, positions: FloatArray, quaternions: FloatArray) -> FloatArray:
    """Return the corners of bricks [m], shape (n, 8, 3), world frame.

    Args:
        sizes: edge lengths [m], shape (n, 3).
        positions: centres [m], shape (n, 3), world frame.
        quaternions: orientations (w, x, y, z), shape (n, 4), world frame, of any length.
    """
    turns = _turns(quaternions)
    corners: FloatArray = np.einsum("ijn,nkj->nki", turns, _CORNERS * sizes[:, None]) + positions[:, None]
    return corners


def _turns(quaternions: FloatArray) -> FloatArray:
    """Return the rotation matrices, shape (3, 3, n), of quaternions (n, 4) of any length."""
    w, x, y, z = quaternions.T / np.linalg.norm(quaternions, axis=1)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _mesh_of(solids: Sequence[_Solid]) -> pv.PolyData:
    """Return bricks of other shapes than boxes as one mesh."""
    firsts = np.cumsum([0, *(len(solid.corners) for solid in solids)])
    faces = [
        number
        for first, solid in zip(firsts.tolist(), solids, strict=False)
        for face in solid.faces
        for number in (len(face), *(first + corner for corner in face))
    ]
    mesh = pv.PolyData(np.vstack([solid.corners for solid in solids]), faces)
    mesh.cell_data["colour"] = np.repeat(
        np.array([solid.colour for solid in solids]), [len(solid.faces) for solid in solids], axis=0
    )
    return mesh


def _mesh(corners: FloatArray, colours: ByteArray) -> pv.PolyData:
    """Return all boxes as one mesh, because one draw call per box would take seconds.

    Args:
        corners: corners of the boxes [m], shape (n, 8, 3), world frame.
        colours: red, green and blue of each box, from 0 to 255, shape (n, 3).
    """
    first = 8 * np.arange(len(corners))[:, None, None]
    faces = np.concatenate([np.full((len(corners), 6, 1), 4), first + _FACES], axis=2)
    mesh = pv.PolyData(corners.reshape(-1, 3), faces.ravel())
    mesh.cell_data["colour"] = np.repeat(colours, 6, axis=0)
    return mesh


def _ground(
    faces: Sequence[FloatArray], low: FloatArray, high: FloatArray, edge: int
) -> tuple[pv.PolyData, pv.Texture]:
    """Return the ground plane and its texture, which is transparent except for the shadow of the bricks.

    Args:
        faces: corners (k, 3) [m] of each face of the bricks, world frame.
        low: lower corner of the visible space [m], shape (3,).
        high: upper corner of the visible space [m], shape (3,).
        edge: edge of the picture of the shadow [pixels].
    """
    centre, half = (low + high)[:2] / 2, 2.0 * float(np.linalg.norm(high - low))
    plane = pv.Plane(center=(*centre, 0.0), i_size=2 * half, j_size=2 * half)
    texture = np.zeros((edge, edge, 4), np.uint8)
    texture[..., 3] = _shadow([(face - [*(centre - half), 0]) / (2 * half) * edge for face in faces], edge)
    return plane, pv.Texture(texture)


def _shadow(faces: Sequence[FloatArray], edge: int) -> npt.NDArray[np.uint8]:
    """Return the opacity (0 to 255) of the shadow on the ground, seen from above, shape (edge, edge).

    Args:
        faces: corners (k, 3) [pixels] of each face of the bricks.
        edge: edge of the picture [pixels].
    """
    sun, rng = _TO_SUN / np.linalg.norm(_TO_SUN), np.random.default_rng(0)
    right = np.cross(sun, [0.0, 0.0, 1.0])
    total = np.zeros((edge, edge), np.uint16)
    corners, ends = np.vstack(faces), np.cumsum([len(face) for face in faces])[:-1]
    for angle, radius in zip(np.arange(_SUNS) * 2 * np.pi / _SUNS, np.sqrt(rng.uniform(size=_SUNS)), strict=True):
        ray = sun + _SUN_RADIUS * radius * (np.cos(angle) * right + np.sin(angle) * np.cross(sun, right))
        image = Image.new("L", total.shape)
        draw = ImageDraw.Draw(image)
        flat = corners[:, :2] - corners[:, 2:] * ray[:2] / ray[2]
        flat[:, 1] = edge - flat[:, 1]  # the rows of a picture run downward
        for face in np.split(flat, ends):
            draw.polygon(face.ravel().tolist(), fill=_DARKEST)
        total += np.asarray(image)
    shade = Image.fromarray((total // _SUNS).astype(np.uint8)).filter(ImageFilter.GaussianBlur(_BLUR * edge))
    return np.asarray(shade)


def _main(order: Path) -> None:
    """Draw the views of an order: to the paths of their pictures, or frame by frame as raw RGBA on standard output."""
    raw = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that no message of VTK mixes with the pictures
    views = json.loads(order.read_text(encoding="utf-8"))
    for view in views:
        if view["paths"]:
            for picture, path in zip(render(view), view["paths"], strict=True):
                picture.save(path, optimize=True)
    for pictures in zip(*(render(view) for view in views if not view["paths"]), strict=True):
        raw.write(b"".join(picture.tobytes() for picture in pictures))
        raw.flush()


if __name__ == "__main__":
    _main(Path(sys.argv[1]))
