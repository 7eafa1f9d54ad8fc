"""The corners of contact areas: an engine's point of a pair becomes the whole area on which the bodies rest."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.port import Contacts
from stability_core.ports import warm_up
from stability_core.ports.shared.contact_area import area_corners, missing_corners
from stability_core.ports.shared.shapes import HALF_SPACE, ShapeTable, Solid, box_vertices, cylinder_vertices

UP = np.array([0.0, 0.0, 1.0])
NEAR = 1e-4
LOWER = box_vertices(np.array([0.1, 0.1, 0.05])) + np.array([0.0, 0.0, 0.05])
EXACT = 1e-6
"""Edges count as inside by a millionth of their length, so that flush faces overlap."""


def upper(x: float, tilt: float = 0.0) -> np.ndarray:
    """A box of 0.2 by 0.1 m on a box of 0.2 by 0.2 m, shifted by x, and turned about y on its lowest edge."""
    vertices = box_vertices(np.array([0.1, 0.05, 0.05]))
    turn = np.array([[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])
    turned = vertices @ turn.T
    return turned + np.array([x, 0.0, 0.1 - turned[:, 2].min()])


def bounds(corners: np.ndarray) -> list[float]:
    return [*corners[:, 0].min(keepdims=True), *corners[:, 0].max(keepdims=True), *np.ptp(corners[:, 1], keepdims=True)]


def test_two_faces_share_their_overlap() -> None:
    corners, gaps = area_corners(LOWER, upper(0.05), UP, np.array([0.1, 0.05, 0.1]), -1e-5, NEAR)
    assert len(corners) == 4
    np.testing.assert_allclose(bounds(corners), [-0.05, 0.1, 0.1], atol=EXACT)
    np.testing.assert_allclose(corners[:, 2], 0.1, atol=EXACT)
    np.testing.assert_allclose(gaps, -1e-5, atol=1e-12)


def test_the_ground_bears_the_whole_lower_face() -> None:
    corners, _ = area_corners(HALF_SPACE, upper(0.3) - np.array([0, 0, 0.1]), UP, np.array([0.4, 0.05, 0.0]), 0.0, NEAR)
    np.testing.assert_allclose(bounds(corners), [0.2, 0.4, 0.1], atol=EXACT)


@pytest.mark.parametrize("swapped", [False, True])
def test_a_tilted_box_rests_on_its_edge_alone(swapped: bool) -> None:
    """Tilted by 2 degrees, the far edge of a box of 0.2 m is 7 mm above its support."""
    tilted = upper(0.0, np.radians(2.0))
    point = tilted[tilted[:, 2].argmin()]
    if swapped:
        corners, _ = area_corners(tilted, LOWER, -UP, point, 0.0, NEAR)
    else:
        corners, _ = area_corners(LOWER, tilted, UP, point, 0.0, NEAR)
    np.testing.assert_allclose(corners[:, 0], point[0], atol=EXACT)
    np.testing.assert_allclose(np.ptp(corners[:, 1]), 0.1, atol=EXACT)


def test_a_slight_tilt_keeps_the_corners_with_their_gaps() -> None:
    """Tilted by 0.3 mrad, the far edge is 0.06 mm above its support: it bears as soon as the near edge yields."""
    tilted = upper(0.0, 3e-4)
    lowest = tilted[tilted[:, 2].argmin()]
    corners, gaps = area_corners(LOWER, tilted, UP, lowest, 0.0, NEAR)
    assert len(corners) == 4
    np.testing.assert_allclose(gaps, np.abs(corners[:, 0] - lowest[0]) * 3e-4, atol=1e-8)


def test_a_collision_margin_cancels_out() -> None:
    """An engine that keeps hulls 2 mm apart lists an overlap of -2 mm where the vertices touch."""
    corners, gaps = area_corners(LOWER, upper(0.0), UP, np.array([0.1, 0.05, 0.1]), -2e-3, NEAR)
    assert len(corners) == 4
    np.testing.assert_allclose(gaps, -2e-3, atol=1e-12)


def test_a_cylinder_rests_on_its_rim() -> None:
    """The area of a polygon of 24 corners is 98.9 % of the circle's."""
    cylinder = cylinder_vertices(0.04, 0.1) + np.array([0.0, 0.0, 0.15])
    corners, _ = area_corners(LOWER, cylinder, UP, np.array([0.04, 0.0, 0.1]), 0.0, NEAR)
    assert len(corners) == 24
    x, y = corners[:, 0], corners[:, 1]
    area = abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2
    assert area == pytest.approx(np.pi * 0.04**2, rel=0.012)


def test_crossing_edges_keep_the_engines_point() -> None:
    roof = upper(0.0, np.radians(45.0))
    floor = -upper(0.0, np.radians(45.0)) @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
    corners, _ = area_corners(floor, roof, UP, np.zeros(3), 0.0, NEAR)
    assert len(corners) == 0


def lying(turn: float) -> ShapeTable:
    """A cylinder on its side on the ground, turned about its axis."""
    table = ShapeTable()
    table.add(0, Solid(cylinder_vertices(0.04, 0.1), np.array([0.0, 0.0, 1.0])))
    table.add(-1, Solid(HALF_SPACE))
    half = np.sqrt(0.5)
    about_x, about_axis = np.array([half, 0, 0, half]), np.array([0, 0, np.sin(turn / 2), np.cos(turn / 2)])
    x1, y1, z1, w1 = about_x
    x2, y2, z2, w2 = about_axis
    both = [
        w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
        w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
        w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
    ]
    table.place([0], np.array([[0.0, 0.0, 0.04, *both]]))
    return table


@pytest.mark.parametrize("turn", [0.0, np.radians(7.5)])
def test_a_cylinder_on_its_side_keeps_the_engines_line(turn: float) -> None:
    """Its rim has 24 flat sides in the table, but none in the engine: it would stand on a slope and not roll."""
    ids = np.array([-1, -1]), np.array([0, 0])
    points = np.array([[0.0, -0.05, 0.0], [0.0, 0.05, 0.0]])
    line = Contacts(*ids, points, np.array([UP, UP]), np.zeros(2), np.zeros((2, 3)), np.ones(2))
    assert len(lying(turn).completed(line)) == 2


def test_warm_up_compiles_the_ports_as_well() -> None:
    """A frame must not wait for the compiler: the kernel of contact areas is ready, the policy's are as well."""
    assert warm_up("at_rest") >= 0.0
    assert missing_corners.signatures
