"""What an adapter costs: run with ``uv run pytest --benchmark-only``."""

from __future__ import annotations

import pytest

from adapters import ENGINES, Simulation, open_engine
from scenarios.model import Brick, World

pytestmark = pytest.mark.benchmark(group="an adapter")
SIZE = (117.0e-3, 23.4e-3, 7.8e-3)
FROZEN = 100
SETTLING_FRAMES = 30


def brick(place: int) -> Brick:
    """A plank of a row of 25 low columns, in the plane of planar engines; the last one lies on the first column."""
    level, column = divmod(place, 25)
    return Brick(SIZE, 0.0119, (0.15 * (column - 12), 0.0, SIZE[2] * (level + 0.5)))


@pytest.fixture(params=list(ENGINES))
def frozen_columns(request) -> Simulation:
    """A hundred frozen planks, and a live one on top of them."""
    bricks = [brick(place) for place in range(FROZEN + 1)]
    simulation = open_engine(request.param, "game", world=World(), expected=bricks)
    port = simulation.port
    bodies = [simulation.spawn(one) for one in bricks]
    for _ in range(SETTLING_FRAMES):
        simulation.step(simulation.info.frame_s)
    port.sleep(bodies[:FROZEN])
    for _ in range(2):
        simulation.step(simulation.info.frame_s)
    yield simulation
    simulation.close()


def test_a_frame_with_a_hundred_frozen_bricks(benchmark, frozen_columns) -> None:
    benchmark(frozen_columns.step, frozen_columns.info.frame_s)
    assert len(frozen_columns.frozen) == FROZEN


def test_reading_contacts_and_masses(benchmark, frozen_columns) -> None:
    """Of the one live brick: what is frozen should cost nothing."""
    contacts, masses = benchmark(lambda: (frozen_columns.port.contacts(), frozen_columns.port.masses()))
    assert len(contacts) >= 2
    assert len(masses.body) == 1
