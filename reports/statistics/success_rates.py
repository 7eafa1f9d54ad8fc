"""Success rates, and the rate of each kind of error, with intervals."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from reports.records.trial import Verdict
from reports.statistics.intervals import Estimate, success_rate

Miss: TypeAlias = Literal["false_stand", "false_collapse", "creeps", "failed"]
MISSES: tuple[Miss, ...] = ("false_stand", "false_collapse", "creeps", "failed")
"""Kinds of error: stood though it must fall; fell though it must not, or too early; crept though it must stand; sank,
diverged or crashed."""


@dataclass(frozen=True, slots=True)
class SuccessRates:
    """Shares of the decided trials or pairs. A pair may have several kinds of error."""

    right: Estimate
    false_stand: Estimate
    false_collapse: Estimate
    creeps: Estimate
    failed: Estimate

    @property
    def n(self) -> int:
        """Number judged."""
        return self.right.n

    @property
    def right_count(self) -> int:
        """Number of correct outcomes."""
        return count(self.right)


def success_rates(by_scene: Sequence[Sequence[Collection[Verdict]]]) -> SuccessRates | None:
    """Return shares with bootstrap intervals over scenes and, within them, over seeds; None if nothing was judged.

    Args:
        by_scene: for each scene (or pair of scenes) and each of its seeds, the verdicts that must all be right: of
            one trial, or of both sides of a pair.
    """
    right = success_rate([[set(together) == {"right"} for together in seeds] for seeds in by_scene])
    missed = [success_rate([[miss in together for together in seeds] for seeds in by_scene]) for miss in MISSES]
    found = [rate for rate in (right, *missed) if rate is not None]
    return SuccessRates(*found) if len(found) == 1 + len(MISSES) else None


def misses_shown(rates: Iterable[SuccessRates | None]) -> tuple[Miss, ...]:
    """Return the kinds of error that a table shows: creep only if there was any.

    Trials from before creep counted have none, and their tables stay as they were.
    """
    crept = any(one is not None and one.creeps.value > 0 for one in rates)
    return tuple(miss for miss in MISSES if crept or miss != "creeps")


def count(estimate: Estimate) -> int:
    """Return the number of trials or pairs behind a share."""
    return round(estimate.value * estimate.n)
