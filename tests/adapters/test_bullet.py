"""What is special to Bullet: handles used again, its own sleep, and what a quiet frame reads."""

import pybullet
import pytest

from adapters import Simulation, open_engine
from adapters.conformance.rig import MASS, THICKNESS, advance, frozen_column, pairs, place_on, plank, pose
from stability_core.port import GROUND


def test_contacts_keep_their_bodies_when_bullet_uses_a_handle_again() -> None:
    simulation = open_engine("bullet", "game")
    first, second = simulation.spawn(plank(0.0)), simulation.spawn(plank(0.2))
    assert simulation.port.masses().body.tolist() == [first, second]
    simulation.remove(first)
    third = place_on(simulation, 0)
    advance(simulation, 0.5)
    assert pairs(simulation.port.contacts()) == {(GROUND, second), (GROUND, third)}
    simulation.close()


def rest_for_three_seconds(sleeping: str) -> tuple[Simulation, int, int]:
    simulation = open_engine("bullet", "tuned", sleeping=sleeping)  # type: ignore[arg-type]
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 3.0)
    return simulation, support, body


def test_bullets_own_sleep_hangs_in_the_air_until_it_is_pushed() -> None:
    # Known behaviour of the engine, 2 s after the brick came to rest; the conformance checks see to "off".
    simulation, support, body = rest_for_three_seconds("native")
    simulation.remove(support)
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] > THICKNESS
    simulation.push(body, (0.1 * MASS, 0.0, 0.0))
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] < THICKNESS
    simulation.close()


def test_a_sleep_threshold_that_cannot_be_raised_is_not_pretended() -> None:
    with pytest.raises(NotImplementedError, match="PyBullet sets the threshold on multibodies only"):
        open_engine("bullet", "game", sleeping="raised")


def test_bullet_lists_only_the_contacts_of_live_bricks() -> None:
    simulation = open_engine("bullet", "game")
    frozen_column(simulation, 25, xs=(0.0, 0.2, 0.4, 0.6))
    place_on(simulation, 25)
    advance(simulation, 0.5)
    assert len(simulation.port.contacts()) == 4
    simulation.close()


@pytest.mark.parametrize(("profile", "kind"), [("default", 2), ("default@useMaximalCoordinates=1", 1), ("tuned", 1)])
def test_bodies_are_multibodies_as_shipped_and_rigid_bodies_else(profile: str, kind: int) -> None:
    simulation = open_engine("bullet", profile)
    simulation.spawn(plank(0.0))
    (handle,) = simulation._handles.values()  # type: ignore[attr-defined]
    assert pybullet.getDynamicsInfo(handle, -1, simulation._client)[10] == kind  # type: ignore[attr-defined]
    simulation.close()
