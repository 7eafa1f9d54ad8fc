"""Groups of trials: all trials of one scene, engine, profile and policy."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from reports.records.trial import TrialRecord, Verdict
from reports.statistics.intervals import Estimate, median
from reports.statistics.survival import Lifetime, PairedTest, Survival, compare_pairs, kaplan_meier, lifetime
from scenarios.model import Expectation

Item = TypeVar("Item")
ALONE = "none"
"""Name of the policy that freezes nothing: the engine alone. Reports compare all other policies with this policy."""
LEADING_POLICIES = (ALONE, "native", "raised", "at_rest", "paper")
"""Policies that lists begin with, in this order; other policies follow in order of appearance."""


class GroupKey(NamedTuple):
    """The properties that all trials of a group share."""

    scene: str
    engine: str
    profile: str
    policy: str


@dataclass(frozen=True)
class Group:
    """Group of trials that differ only in seed and repeat."""

    key: GroupKey
    trials: tuple[TrialRecord, ...]

    @property
    def scenario(self) -> str:
        """Name of the scenario of which the scene is a variant."""
        return self.trials[0].scenario

    @property
    def pair(self) -> str:
        """Id that the scene shares with its partner; empty for a scene without a partner."""
        return self.trials[0].pair

    @property
    def expectation(self) -> Expectation:
        """Expectation of the first trial in the order of the records."""
        return self.trials[0].expectation

    @property
    def levels_planned(self) -> int:
        """Number of levels of the whole scene."""
        return self.trials[0].levels_planned

    @cached_property
    def by_seed(self) -> dict[int, list[TrialRecord]]:
        """Trials of each seed, in the order of their repeats."""
        in_order = sorted(self.trials, key=lambda trial: (trial.seed, trial.repeat))
        return {repeats[0].seed: repeats for repeats in grouped(in_order, "seed").values()}

    @cached_property
    def draws(self) -> list[TrialRecord]:
        """First repeat of each seed, because further repeats add no evidence of outcomes."""
        return [repeats[0] for repeats in self.by_seed.values()]

    @cached_property
    def judged(self) -> list[TrialRecord]:
        """Judged trials among ``draws``: see ``judged_trials``."""
        return judged_trials(self.draws)

    def count(self, verdict: Verdict) -> int:
        """Return the number of judged draws with this verdict."""
        return sum(trial.verdict == verdict for trial in self.judged)

    @cached_property
    def lifetimes(self) -> dict[int, Lifetime]:
        """Lifetimes of the stacks, by seed; trials without a lifetime (see ``lifetime``) are absent."""
        return {trial.seed: life for trial in self.draws if (life := lifetime(trial)) is not None}

    @cached_property
    def survival(self) -> Survival | None:
        """Survival curve over levels; None if there are no lifetimes."""
        return kaplan_meier(list(self.lifetimes.values())) if self.lifetimes else None

    def values(self, field: str) -> list[float]:
        """Return one value of a field for each seed with a value: the median of its repeats."""
        seeds = ([getattr(trial, field) for trial in repeats] for repeats in self.by_seed.values())
        measured = ([value for value in repeats if value is not None] for repeats in seeds)
        return [statistics.median(repeats) for repeats in measured if repeats]

    def measured(self, field: str) -> list[float]:
        """Return the value of a field for each trial with a value, including repeats."""
        return [value for trial in self.trials if (value := getattr(trial, field)) is not None]

    def estimate(self, field: str) -> Estimate | None:
        """Return the median of a field over seeds, with its interval.

        The result is None without values, and for times of several machines.

        Times of several machines have no common median, because they are not comparable.
        """
        several = len({trial.host for trial in self.trials if trial.timed_frames is not None}) > 1
        if several and "_ms" in field:
            return None
        return median(self.values(field))


def groups_of(records: Iterable[TrialRecord]) -> list[Group]:
    """Return the groups of trials, in the order of their keys.

    Scenes, engines and profiles are in order of appearance; policies are in their usual order.
    """
    groups = {GroupKey(*key): trials for key, trials in grouped(records, *GroupKey._fields).items()}
    first = [_ranks(keys) for keys in zip(*groups, strict=True)][:3]
    policies = _ranks(ordered_policies(key.policy for key in groups))
    ranks = [*first, policies]
    order = sorted(groups, key=lambda key: [rank[name] for rank, name in zip(ranks, key, strict=True)])
    return [Group(key, tuple(groups[key])) for key in order]


def grouped(items: Iterable[Item], *fields: str) -> dict[tuple[Any, ...], list[Item]]:
    """Return items by the values of their fields, in order of appearance.

    Args:
        items: trials, groups of trials, or rows of a table.
        fields: names of attributes of an item; ``key.scene`` is an attribute of an attribute.
    """
    values = [attrgetter(field) for field in fields]
    groups: dict[tuple[Any, ...], list[Item]] = {}
    for item in items:
        groups.setdefault(tuple(value(item) for value in values), []).append(item)
    return groups


def ordered_policies(names: Iterable[str]) -> list[str]:
    """Return the distinct policies in their usual order (``LEADING_POLICIES`` first)."""
    present = dict.fromkeys(names)
    return [name for name in LEADING_POLICIES if name in present] + [n for n in present if n not in LEADING_POLICIES]


def compare_groups(group: Group, other: Group) -> PairedTest | None:
    """Return the test of two groups on the same stacks, paired by seed.

    The result is None if no seed has a lifetime in both groups.
    """
    shared = [seed for seed in group.lifetimes if seed in other.lifetimes]
    return compare_pairs([(group.lifetimes[seed], other.lifetimes[seed]) for seed in shared]) if shared else None


def _ranks(names: Sequence[str]) -> dict[str, int]:
    return {name: rank for rank, name in enumerate(dict.fromkeys(names))}


def judged_trials(trials: Sequence[TrialRecord]) -> list[TrialRecord]:
    """Return the trials with a verdict other than ``none`` and ``undecided``.

    A trial that its time limit stopped is undecided, because a slow trial is not necessarily wrong.
    """
    return [trial for trial in trials if trial.is_judged]
