"""Success rates and the rate of each kind of error, with intervals."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from reports.records.trial import Verdict
from reports.statistics.intervals import Estimate, success_rate

Miss: TypeAlias = Literal["false_stand", "false_collapse", "creeps", "failed"]
"""Kind of error."""
MISSES: tuple[Miss, ...] = ("false_stand", "false_collapse", "creeps", "failed")
"""All kinds of error:

- ``false_stand``: a stack that must fall stands, or falls too late or at too high a level;
- ``false_collapse``: a stack that must stand falls, or a stack that must fall falls too early or at too low a level;
- ``creeps``: a stack that must stand creeps;
- ``failed``: a stack that must fall only sinks, or an error, a crash, a lack of memory or a divergence ends the trial.
"""


@dataclass(frozen=True, slots=True)
class SuccessRates:
    """Success rate and rate of each kind of error, among judged trials or pairs.

    A pair may have several kinds of error.
    """

    right: Estimate
    false_stand: Estimate
    false_collapse: Estimate
    creeps: Estimate
    failed: Estimate

    @property
    def n(self) -> int:
        """Number of judged trials or pairs."""
        return self.right.n

    @property
    def right_count(self) -> int:
        """Number of correct outcomes."""
        return count(self.right)


def success_rates(by_scene: Sequence[Sequence[Collection[Verdict]]]) -> SuccessRates | None:
    """Return success rates with bootstrap intervals over scenes and, within scenes, over seeds.

    Args:
        by_scene: for each scene (or pair of scenes) and each seed, the verdicts of the trial (or of both trials). A
            pair counts as right only if both verdicts are ``right``.

    Returns:
        The success rates; None without judged trials.
    """
    right = success_rate([[set(together) == {"right"} for together in seeds] for seeds in by_scene])
    missed = [success_rate([[miss in together for together in seeds] for seeds in by_scene]) for miss in MISSES]
    found = [rate for rate in (right, *missed) if rate is not None]
    return SuccessRates(*found) if len(found) == 1 + len(MISSES) else None


def misses_shown(rates: Iterable[SuccessRates | None]) -> tuple[Miss, ...]:
    """Return the kinds of error that a table shows, without creep if no trial creeps.

    Most trials from before format 3 have no verdict on creep, so that their tables need no column for creep.
    """
    crept = any(one is not None and one.creeps.value > 0 for one in rates)
    return tuple(miss for miss in MISSES if crept or miss != "creeps")


def count(estimate: Estimate) -> int:
    """Return the number of trials or pairs with an outcome, from the estimated rate of this outcome."""
    return round(estimate.value * estimate.n)
