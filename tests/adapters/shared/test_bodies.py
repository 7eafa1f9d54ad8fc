"""The record of bodies: ids, and which of them are live, frozen, moved or gone."""

from __future__ import annotations

import pytest

from adapters.shared.bodies import Bodies
from scenarios.model import Brick


def brick(mass: float, *, moved: bool = False) -> Brick:
    return Brick((1.0, 1.0, 1.0), mass, (0.0, 0.0, 0.0), moved=moved)


@pytest.fixture
def bodies() -> Bodies:
    record = Bodies()
    for mass in (1.0, 2.0, 3.0):
        record.add(record.new_id(), brick(mass))
    record.add(record.new_id(), brick(9.0, moved=True))
    return record


def live(record: Bodies) -> dict[int, float]:
    ids, masses = record.live_rows()
    return dict(zip(ids.tolist(), masses.tolist(), strict=True))


def test_bodies_are_live_until_frozen_and_again_once_woken_in_the_order_of_their_ids(bodies: Bodies) -> None:
    assert live(bodies) == {0: 1.0, 1: 2.0, 2: 3.0}
    bodies.freeze(0)
    bodies.freeze(1)
    assert (live(bodies), bodies.frozen) == ({2: 3.0}, {0, 1})
    for body in (1, 0):
        bodies.unfreeze(body)
    bodies.sort_live()
    assert list(live(bodies).items()) == [(0, 1.0), (1, 2.0), (2, 3.0)]
    assert not bodies.frozen


def test_the_arrays_of_live_bodies_are_the_same_until_another_is_live(bodies: Bodies) -> None:
    assert bodies.live_rows() is bodies.live_rows()
    before = bodies.live_rows()
    bodies.freeze(2)
    assert bodies.live_rows() is not before


def test_a_moved_body_moves_and_is_driven_only_at_a_velocity(bodies: Bodies) -> None:
    assert bodies.moving().tolist() == [0, 1, 2, 3]
    assert bodies.driven() == []
    bodies.moved[3] = (0.0, 0.0, 0.0), (0.0, 0.1, 0.0)
    assert bodies.driven() == [3]
    assert bodies.ids().tolist() == [0, 1, 2, 3]


def test_a_removed_body_is_reported_once_and_its_id_is_not_used_again(bodies: Bodies) -> None:
    bodies.remove(2)
    bodies.remove(3)
    assert bodies.take_removed() == [2, 3]
    assert bodies.take_removed() == []
    assert bodies.new_id() == 4
    assert bodies.moving().tolist() == [0, 1]
    with pytest.raises(KeyError, match=r"the world does not contain the bodies 2, 3, .*: use ids from poses"):
        bodies.check_known([0, 2, 3])
