"""The policy ``stacking_tree``: shares of a load by lever equations, against piles worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, StabilityExtension
from stability_core.policies.stacking_tree import lever_shares
from tests.stability_core.dwell import REST_FRAMES
from tests.stability_core.flat_piles import PILES, agreement, count_all

DT = 1 / 60
EXACT = 1e-6
"""The ridge of the normal equations changes a share by 1e-9 times the condition of the levers."""


def test_two_supports_share_by_their_levers():
    """A quarter of the way from the left support to the right support the left support bears three quarters."""
    shares = lever_shares(np.array([1.0, 0.0, 0.0]), np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]))
    assert shares == pytest.approx([0.75, 0.25], abs=EXACT)


def test_two_supports_beside_the_centre_share_by_levers_along_their_line():
    """The offset across the line turns neither lever, so that the shares sum to the load."""
    shares = lever_shares(np.array([1.0, 0.7, 3.0]), np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 2.0]]))
    assert shares == pytest.approx([0.75, 0.25], abs=EXACT)


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_supports_in_symmetric_places_bear_equal_shares(turn):
    angles = turn + np.arange(3) * 2 * np.pi / 3
    contacts = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(3)])
    assert lever_shares(np.zeros(3), contacts) == pytest.approx([1 / 3] * 3, abs=EXACT)


def test_three_supports_in_a_row_obey_all_lever_equations():
    """At x = 0, 1 and 3 under a centre at 2: F_i d_ij = F_j d_ji cannot hold for all pairs, so that least squares
    decides. The shares are the solution of the four equations by ``numpy.linalg.lstsq``."""
    x, center = np.array([0.0, 1.0, 3.0]), 2.0
    rows, right = [], []
    for i in range(3):
        for j in range(i + 1, 3):
            row = np.zeros(3)
            row[i], row[j] = abs(center - x[i]) / abs(x[i] - x[j]), -abs(center - x[j]) / abs(x[i] - x[j])
            rows.append(row)
            right.append(0.0)
    expected = np.linalg.lstsq(np.array([*rows, np.ones(3)]), np.array([*right, 1.0]), rcond=None)[0]
    contacts = np.column_stack([x, np.zeros(3), np.zeros(3)])
    assert lever_shares(np.array([center, 0.0, 0.0]), contacts) == pytest.approx(expected, abs=EXACT)


def test_shares_are_never_negative_and_do_not_depend_on_the_order():
    random = np.random.default_rng(20260)
    for _ in range(200):
        k = int(random.integers(3, 7))
        contacts, center = random.normal(size=(k, 3)), random.normal(size=3)
        shares, order = lever_shares(center, contacts), random.permutation(k)
        assert shares.min() >= 0.0
        assert shares.sum() <= 1.0 + EXACT
        assert lever_shares(center, contacts[order]) == pytest.approx(shares[order], abs=EXACT)


def test_supports_at_one_place_bear_equal_shares():
    assert lever_shares(np.zeros(3), np.ones((3, 3))) == pytest.approx([1 / 3] * 3, abs=EXACT)


def lay_plank_on_props(port, props: dict[int, float]) -> None:
    """A plank of 5 kg at x = 0 on props of 1 kg, whose places are x [m]; each prop is a cube of 1 m."""
    for prop, x in props.items():
        port.add(prop, (x, 0.0, 0.5))
        port.lay(prop, GROUND, (x - 0.5, x + 0.5), (-0.5, 0.5), 0.0)
    port.add(10, (0.0, 0.0, 1.5), mass=5.0)
    for prop, x in props.items():
        port.lay(10, prop, (x - 0.5, x + 0.5), (-0.5, 0.5), 1.0)


def test_a_load_is_carried_down_to_the_supports_and_no_further(port):
    """A plank of 5 kg at x = 0 on props at -1 and 3: the lever gives 3.75 kg and 1.25 kg."""
    lay_plank_on_props(port, {0: -1.0, 1: 3.0})
    port.add(2, (8.0, 0.0, 0.5))
    port.lay(2, GROUND, (7.5, 8.5), (-0.5, 0.5), 0.0)
    extension = StabilityExtension(port, "stacking_tree")
    for _ in range(3 * REST_FRAMES):
        extension.update(DT)
    assert port.frozen == {0, 1, 2, 10}
    row = {int(extension._world.ids[i]): extension._world.graph.bodies[i] for i in range(4)}
    assert [float(row[body]["stack_mass"]) for body in (0, 1, 2)] == pytest.approx([4.75, 2.25, 1.0], abs=1e-5)
    assert row[0]["stack_center"] == pytest.approx([-1.0, 0.0, (0.5 + 3.75) / 4.75], abs=1e-5)


def test_a_removed_support_unfreezes_all_that_no_longer_balances(port):
    """The plank at x = 0 stays without a support below its centre; its whole load tips the prop at -2."""
    lay_plank_on_props(port, {0: -2.0, 1: 2.0})
    extension = StabilityExtension(port, "stacking_tree")
    for _ in range(3 * REST_FRAMES):
        extension.update(DT)
    assert port.frozen == {0, 1, 10}
    port.remove(1)
    extension.update(DT)
    assert port.frozen == set()


def test_a_leaning_body_stays_live(port):
    """The method knows flat boxes only."""
    port.add(0, (0.0, 0.0, 0.5))
    port.lay(0, GROUND, (-0.5, 0.5), (-0.5, 0.5), 0.0)
    port.add(1, (0.9, 0.0, 0.6))
    port.touch(1, GROUND, [(1.3, -0.3, 0.0), (1.3, 0.3, 0.0)])
    port.touch(1, 0, [(0.5, -0.3, 1.0), (0.5, 0.3, 1.0)], normal=(0.8, 0.0, 0.6))
    extension = StabilityExtension(port, "stacking_tree")
    for _ in range(3 * REST_FRAMES):
        extension.update(DT)
    assert port.frozen == {0}


@pytest.mark.slow
def test_flat_random_piles_agree_with_the_judge():
    """Twenty thousand piles, most of an hour on one slow core: the interval of the share of piles without a wrong
    verdict lies above 95 %, and of the decisions on planks more than 99 % are right."""
    counts = count_all(PILES)
    found = agreement(counts, "stacking_tree", "pile")
    assert found.n >= 0.999 * PILES, "the judge knows the truth of nearly all"
    assert found.interval[0] > 0.95
    assert agreement(counts, "stacking_tree", "decision", "planks").share > 0.99
