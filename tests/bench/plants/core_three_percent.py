"""Imported by a process that counts the core's instructions: each frame costs 3 % more of them."""

from stability_core import StabilityExtension
from tests.benchmarks import worlds

EXTRA = {"quiet": 132, "joins": 570}
"""Steps of a loop that make 3 % of a quiet frame and of one in which a plank joins."""


class _CostlierCore(StabilityExtension):
    def update(self, dt):
        change = super().update(dt)
        for _ in range(EXTRA["joins" if change.frozen else "quiet"]):
            pass
        return change


worlds.StabilityExtension = _CostlierCore
