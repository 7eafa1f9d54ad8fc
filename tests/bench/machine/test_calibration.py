"""The fixed calculation that measures the steadiness of a machine."""

from itertools import accumulate, cycle

from bench.machine.calibration import calibrate, typical


def test_the_typical_time_is_the_median_of_all_before_and_after() -> None:
    assert typical([1.0, 1.0, 9.0], [2.0, 3.0]) == 2.0


def test_each_time_is_read_from_the_clock_in_milliseconds() -> None:
    ticks = accumulate(cycle([0.002, 1.0]))
    assert [round(time, 6) for time in calibrate(lambda: next(ticks))] == [1000.0] * 20
