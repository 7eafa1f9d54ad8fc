"""The policies of a trial by name: the engine's own sleeping, or a policy of the core."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from adapters.profile import Sleeping
from stability_core import POLICIES


@dataclass(frozen=True, slots=True)
class BenchPolicy:
    """The engine's sleeping, and the policy of the core, if any."""

    sleeping: Sleeping
    core: str | None
    """Name in ``stability_core.POLICIES``; None runs the engine alone."""
    description: str


BENCH_POLICIES: Mapping[str, BenchPolicy] = {
    "none": BenchPolicy("off", None, "the engine alone, its own sleeping off"),
    "native": BenchPolicy("native", None, "the engine alone, its own sleeping as shipped"),
    "raised": BenchPolicy("raised", None, "the engine alone, its sleeping threshold raised"),
    **{name: BenchPolicy("off", name, f"the stability core with its policy '{name}'") for name in POLICIES},
}
