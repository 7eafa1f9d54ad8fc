"""Loading layer by layer: what it holds, what it leaves in doubt, and that a doubt stays local."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, solve_equilibrium
from stability_core.equilibrium import snapshot, verdict
from stability_core.equilibrium.layers import loose_in_layers
from stability_core.equilibrium.problem import Problem
from tests.stability_core.masonry import ENDS, HIGH, LONG, inverted_v, logs, overhang
from tests.stability_core.piles import Pile


def problem_of(pile: Pile) -> Problem:
    """The dimensionless problem of a pile, with the ground as a fixed body."""
    contacts, masses = pile.world(np.eye(3))
    problem, _ = snapshot._problem(contacts, masses, contacts.body_a, contacts.body_b, np.eye(3), 9.81)
    return problem


def loose(pile: Pile) -> list[int]:
    problem = problem_of(pile)
    _, force, *_ = verdict.solve(problem, verdict.ALL_ROWS, verdict.STRONGEST)
    return np.flatnonzero(loose_in_layers(problem, force)).tolist()


def lay(pile: Pile, lower: int, x: float, z: float, mass: float = 1.0, reach: float = LONG / 2) -> int:
    """Lay a brick flat on ``lower`` at the height ``z`` of its underside; ``reach`` is half the length that touches."""
    brick = pile.add((x, 0.0, z + HIGH / 2), mass)
    pile.touch(brick, lower, [(x + side * reach, y, z) for side in (-1, 1) for y in ENDS])
    return brick


def test_a_tower_and_a_leaning_pair_are_held():
    tower, below = Pile(0.45), GROUND
    for level in range(12):
        below = lay(tower, below, 0.0, level * HIGH)
    assert loose(tower) == []
    assert loose(inverted_v(np.radians(75), 0.45)) == []
    assert loose(logs(0.05, 0.5)) == []


@pytest.mark.parametrize("excess", [0.001, 0.01])
def test_a_neighbours_side_holds_no_overhang(excess):
    """The brick and the neighbour form one cluster, so that the brick's rise past the neighbour is seen."""
    assert 0 in loose(overhang(excess))
    assert loose(overhang(-excess)) == []


def test_a_counterweight_is_joined_with_the_brick_that_it_holds():
    """5 kg 30 mm inside the edge against 1 kg 5 mm outside: 0.15 against 0.005 kg m."""
    assert loose(overhang(0.005, outer=5.0, at=LONG / 2 - 0.035)) == []


def test_what_lies_below_a_doubtful_brick_is_not_in_doubt():
    """The overhang stands on a tower in place of the table: only it needs prestress, the tower bears it either way."""
    pile = overhang(0.005)
    raised = Pile(pile.friction)
    raised.mass, raised.center = list(pile.mass), [(x, y, z + 10 * HIGH) for x, y, z in pile.center]
    table = raised.add((-LONG, 0.0, 9.5 * HIGH), 20.0)
    for lower, upper, (x, y, z), normal in pile.rows:
        raised.touch(upper, table if lower == GROUND else lower, [(x, y, z + 10 * HIGH)], normal)
    legs = [raised.add((-LONG + side * LONG / 2, 0.0, 4.5 * HIGH), 5.0) for side in (-1, 1)]
    for leg in legs:
        x = raised.center[leg][0]
        feet = [(x + dx, y, 9 * HIGH) for dx in (-0.02, 0.02) for y in ENDS]
        raised.touch(table, leg, feet)
        raised.touch(leg, GROUND, [(px, py, 0.0) for px, py, _ in feet])
    answer = solve_equilibrium(*raised.world(np.eye(3)))
    assert answer.verdict == "doubt"
    assert answer.in_doubt[0]
    assert not answer.in_doubt[[table, *legs]].any()


def test_bricks_that_lie_on_each_other_are_loaded_together():
    """Two bricks on the ground touch twice, once with each as the upper one: neither can be loaded first."""
    pile = Pile(0.5)
    first, second = lay(pile, GROUND, -0.03, 0.0), lay(pile, GROUND, 0.03, 0.0)
    slope = np.array([0.6, 0.0, 0.8])
    pile.touch(second, first, [(0.0, -0.01, HIGH / 2)], tuple(slope))
    pile.touch(first, second, [(0.0, 0.01, HIGH / 2)], tuple(slope * (-1, 1, 1)))
    assert loose(pile) == []
