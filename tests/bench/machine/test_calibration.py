"""The fixed calculation that measures the steadiness of a machine."""

from itertools import accumulate, cycle

import pytest

from bench.machine.calibration import calibrate, speed_now, typical


def test_the_typical_time_is_the_median_of_all_before_and_after() -> None:
    assert typical([1.0, 1.0, 9.0], [2.0, 3.0]) == 2.0


def test_speed_and_load_are_distinguished() -> None:
    """One calculation in three takes 5 ms instead of 1 ms, and the thread has half of the time."""
    ticks = accumulate(cycle([0.001, 0.001, 0.005]))
    wall = [0.0]

    def clock() -> float:
        wall[0] = next(ticks)
        return wall[0]

    now = speed_now(0.5, clock, lambda: wall[0] / 2)
    assert now.calibration_ms == pytest.approx(1.0)
    assert now.busy == pytest.approx(2.0)
    assert speed_now(0.5, clock, lambda: 2 * wall[0]).busy == 1.0


def test_each_time_is_read_from_the_clock_in_milliseconds() -> None:
    ticks = accumulate(cycle([0.002, 1.0]))
    assert [round(time, 6) for time in calibrate(lambda: next(ticks))] == [1000.0] * 20
