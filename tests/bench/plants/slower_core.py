"""Imported in every trial's process of a run (see ``planted_bench``)."""

from time import perf_counter

from bench.trial import stepping
from stability_core import StabilityExtension


class _SlowerCore(StabilityExtension):
    """Takes a fifth more time: what it waits, and what reading the clock and one more call take."""

    def __init__(self, port, **options):
        super().__init__(port, **options)
        self._timed = port

    def update(self, dt):
        begin = perf_counter()
        change = super().update(dt)
        passed = perf_counter() - begin
        until = begin + passed + 0.14 * (passed - self._timed.readback_s - self._timed.steering_s)
        while perf_counter() < until:
            pass
        return change


stepping.StabilityExtension = _SlowerCore
