"""What exact statics costs: run with ``uv run pytest --benchmark-only``.

The clock is the process' own, so that what else the machine does counts for nobody.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, solve_equilibrium
from tests.benchmarks.peers import PEERS, four_stack, pyramid
from tests.benchmarks.worlds import ACROSS, LENGTH, MASS, THICKNESS, UP, contacts_of

pytestmark = pytest.mark.benchmark(group="exact statics", timer=time.process_time)


def row_of_vs(pairs: int) -> tuple[Contacts, Masses]:
    """Inverted Vs side by side under a roof over each two neighbours: friction holds all of it."""
    theta = np.radians(70.0)
    spread, edge = LENGTH * np.cos(theta), THICKNESS * np.sin(theta)
    top = LENGTH * np.sin(theta) + THICKNESS * np.cos(theta)
    pitch = LENGTH - 4 * edge
    rows, centers = [], []
    for pair in range(pairs):
        for side in (1.0, -1.0):
            foot = pair * pitch - side * spread
            rows += [(GROUND, len(centers), (foot, y, 0.0), UP) for y in ACROSS]
            centers.append((foot + side * (spread - edge) / 2, 0.0, top / 2))
        ridge = (pair * pitch, LENGTH * np.sin(theta))
        rows += [(2 * pair, 2 * pair + 1, (ridge[0], y, ridge[1]), (1.0, 0.0, 0.0)) for y in ACROSS]
    for roof in range(0, pairs - 1, 2):
        for body, x in enumerate((-edge, edge, pitch - edge, pitch + edge)):
            rows += [(2 * roof + body, len(centers), (roof * pitch + x, y, top), UP) for y in ACROSS]
        centers.append(((roof + 0.5) * pitch, 0.0, top + THICKNESS / 2))
    return contacts_of(rows), Masses(np.arange(len(centers)), np.full(len(centers), MASS), np.array(centers))


@pytest.mark.parametrize("n", [12, 100, 300])
def test_four_stack_from_scratch(benchmark, n):
    world = four_stack(n)
    assert benchmark(solve_equilibrium, *world).stable


@pytest.mark.parametrize("pairs", [2, 20, 40])
def test_roofed_vs_from_scratch(benchmark, pairs):
    world = row_of_vs(pairs)
    assert benchmark(solve_equilibrium, *world).stable


@pytest.mark.parametrize("n", [12, 100, 300])
@pytest.mark.parametrize("peer", PEERS)
def test_peer(benchmark, peer, n):
    assert benchmark(PEERS[peer](*pyramid(*four_stack(n))))
