"""The watch over a poured pile, fed with poses that are known."""

import math

import numpy as np
import pytest

from bench.trial.measure import Plan
from bench.trial.pile_monitor import MOVING_M_S, PileMonitor, slope_deg
from scenarios.planks import lay

FRAME_S = 1 / 60
BRICKS = [lay(0.01 * number, level=number + 1) for number in range(5)]
PLAN = Plan.of(BRICKS)


def cone(slope: float, seed: int = 0) -> np.ndarray:
    """Points spread evenly through a cone of radius 1 m, shape (n, 3)."""
    points = np.random.default_rng(seed).uniform((-1, -1, 0), (1, 1, slope), (400_000, 3))
    return points[points[:, 2] <= slope * (1 - np.hypot(points[:, 0], points[:, 1]))]


@pytest.mark.parametrize("degrees", [10, 24, 45])
def test_the_slope_of_a_cone(degrees):
    """Within a degree: the medians of some 100,000 points err by half a percent."""
    assert slope_deg(cone(math.tan(math.radians(degrees)))) == pytest.approx(degrees, abs=1)


def test_a_brick_that_rolled_away_makes_a_pile_no_flatter():
    pile = cone(0.5)[:501]
    strayed = pile.copy()
    strayed[0] = (30.0, 0.0, 0.0)
    assert slope_deg(strayed) == pytest.approx(slope_deg(pile), abs=0.5)


def monitor_pile(speeds) -> PileMonitor:
    """A pile of which one brick moves along x, frame by frame, at these speeds [m/s]; the last action is at 0."""
    monitor = PileMonitor(last_action_s=0.0, watch_from_s=1.0, creep_from_s=1.0)
    position = PLAN.position.copy()
    for frame, speed in enumerate(speeds, start=1):
        position = position + [[speed * FRAME_S, 0.0, -0.1 * speed * FRAME_S]] * (len(PLAN.level) == 5)
        monitor.see(frame * FRAME_S, PLAN, position, PLAN.quaternion, dict.fromkeys(range(1, 6), 0.0))
    return monitor


def test_it_is_at_rest_when_nothing_was_last_seen_moving():
    monitor = monitor_pile([10 * MOVING_M_S] * 30 + [0.1 * MOVING_M_S] * 90)
    assert monitor.rest_s == pytest.approx(0.5)
    assert monitor_pile([0.0] * 60 + [10 * MOVING_M_S] * 30).rest_s is None


def test_creep_and_sink_are_of_the_time_of_watching():
    monitor = monitor_pile([0.1] * 60 + [0.001] * 60)
    assert monitor.creep is not None
    assert monitor.creep.speed_m_s == pytest.approx(0.001 * math.hypot(1, 0.1))
    assert monitor.standing is not None
    assert monitor.standing.sink_m == pytest.approx(0.1 * 0.001)
    assert monitor.collapse is None
    assert not monitor.is_over


def test_a_pile_is_as_high_as_its_highest_corner():
    monitor = monitor_pile([0.0] * 3)
    assert monitor.standing is not None
    assert monitor.standing.height_m == pytest.approx(5 * 7.8e-3)
    assert monitor.standing.level == 5


def test_nothing_poured_is_no_pile():
    monitor = PileMonitor(0.0, 1.0, 1.0)
    assert (monitor.standing, monitor.repose_deg, monitor.rest_s, monitor.creep) == (None, None, None, None)
