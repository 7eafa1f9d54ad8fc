"""The policies of trials, by name: the engine's own sleeping, a policy of the core, or joints between bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from adapters.profile import Sleeping
from bench.welding import Load
from reports.tables.policies import POLICY_SENTENCES
from stability_core import POLICIES


@dataclass(frozen=True, slots=True)
class BenchPolicy:
    """A policy of a trial: the engine's sleeping, and an extension, if any: a policy of the core, or joints."""

    sleeping: Sleeping
    core: str | None
    """Name of the core's policy in ``stability_core.POLICIES``; None without the core."""
    description: str
    weld: Load | None = None
    """Load in the test of equilibrium before bodies are joined (``bench.welding``); None for no joints."""

    @property
    def is_steered(self) -> bool:
        """True if an extension reads the world after each step."""
        return self.core is not None or self.weld is not None


def _of_core(name: str) -> BenchPolicy:
    """Return a trial's policy with a policy of the core, and without the engine's own sleeping."""
    description = POLICY_SENTENCES.get(name, f"The stability core with its policy '{name}'.")
    return BenchPolicy("off", name, description)


BENCH_POLICIES: Mapping[str, BenchPolicy] = {
    "none": BenchPolicy("off", None, POLICY_SENTENCES["none"]),
    "native": BenchPolicy("native", None, POLICY_SENTENCES["native"]),
    "raised": BenchPolicy("raised", None, POLICY_SENTENCES["raised"]),
    **{name: _of_core(name) for name in POLICIES},
    "weld": BenchPolicy("off", None, POLICY_SENTENCES["weld"], weld="carried"),
    "weld_own": BenchPolicy("off", None, POLICY_SENTENCES["weld_own"], weld="own"),
}
