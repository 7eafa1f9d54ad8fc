"""Fixed boxes of a world: bad ones are refused, and the corners that an engine leaves out are found box by box.

That every engine builds them is checked by the conformance suite.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from adapters import open_engine
from adapters.shared.contact_completion import BoxTable, fixed_id, joined
from scenarios.model import Brick, World
from stability_core.port import GROUND, Contacts

TABLE = Brick((0.4, 0.2, 0.1), 1.0, (0.0, 0.0, 0.05))
WALL = Brick((0.02, 0.2, 0.1), 1.0, (0.07, 0.0, 0.15))
SIZE = (0.12, 0.02, 0.01)
"""Of the brick, which lies on the table and touches the wall."""


def still(_: np.ndarray, points: np.ndarray) -> np.ndarray:
    return np.zeros(points.shape)


def row(body: int, point: tuple, normal: tuple) -> Contacts:
    ids = np.array([body]), np.array([0])
    return Contacts(*ids, np.array([point]), np.array([normal]), np.zeros(1), np.zeros((1, 3)), np.array([0.45]))


def completed(contacts: Contacts) -> dict[int, set[tuple]]:
    """The points of the brick's contacts, by the id of the fixed box, as the port completes them."""
    table = BoxTable([TABLE, WALL])
    table.add(0, SIZE)
    table.place(np.array([0]), np.array([(0.0, 0.0, 0.105)]), np.array([(1.0, 0.0, 0.0, 0.0)]))
    whole = table.with_near_pairs(table.with_missing_corners(contacts), np.array([0]), 0.45, still)
    found: dict[int, set[tuple]] = {}
    for body, point in zip(whole.body_a.tolist(), whole.point.round(6).tolist(), strict=True):
        found.setdefault(body, set()).add(tuple(point))
    assert set(whole.body_b.tolist()) == {0}
    return found


FACES = {
    fixed_id(0): {(x, y, 0.1) for x in (-0.06, 0.06) for y in (-0.01, 0.01)},
    fixed_id(1): {(0.06, y, z) for y in (-0.01, 0.01) for z in (0.1, 0.11)},
}


def test_fixed_boxes_that_an_engine_does_not_list_are_found() -> None:
    assert completed(Contacts.empty()) == FACES


@pytest.mark.parametrize("order", [1, -1])
def test_missing_corners_are_those_of_the_box_that_is_listed(order: int) -> None:
    """One point each of table and wall: each gets the other three of its own face."""
    points = [row(fixed_id(1), (0.06, 0.01, 0.1), (-1, 0, 0)), row(fixed_id(0), (-0.06, 0.01, 0.1), (0, 0, 1))][::order]
    both = joined(*points)
    assert completed(both) == FACES


def test_more_boxes_than_the_table_has_room_for_at_first() -> None:
    boxes = [replace(TABLE, position=(1.0 * index, 0.0, 0.05)) for index in range(100)]
    table = BoxTable(boxes)
    for body in range(3):
        table.add(body, SIZE)
    table.place(np.array([2]), np.array([(99.0, 0.0, 0.105)]), np.array([(1.0, 0.0, 0.0, 0.0)]))
    near = table.with_near_pairs(Contacts.empty(), np.array([2]), 0.45, still)
    assert set(near.body_a.tolist()) == {fixed_id(99)}
    assert set(near.body_b.tolist()) == {2}


def test_the_ground_stays_the_ground() -> None:
    assert fixed_id(0) < GROUND
    table = BoxTable([TABLE])
    table.add(0, SIZE)
    table.place(np.array([0]), np.array([(0.5, 0.0, 0.005)]), np.array([(1.0, 0.0, 0.0, 0.0)]))
    assert set(table.with_near_pairs(Contacts.empty(), np.array([0]), 0.45, still).body_a.tolist()) == {GROUND}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"size": (0.1, -0.1, 0.1)}, "brick size must be three positive lengths"),
        ({"position": (math.nan, 0.0, 0.0)}, "position must be finite"),
        ({"quaternion": (2.0, 0.0, 0.0, 0.0)}, "quaternion .* must be of unit length"),
    ],
)
def test_a_bad_fixed_box_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        open_engine("bullet", "game", world=World(fixed=(replace(TABLE, **change),)))


def test_a_planar_engine_refuses_a_fixed_box_off_its_plane() -> None:
    with pytest.raises(ValueError, match="planar"):
        open_engine("pymunk", "game", world=World(fixed=(replace(TABLE, position=(0.0, 0.1, 0.05)),)))
