"""Pairs of scenes: one must stand, the other must fall, and little but the deciding quantity differs.

Only a pair with both outcomes correct counts: a rule that freezes everything holds the scene that must fall, a rule
that freezes nothing may drop the scene that must stand, and each alone gets half of all trials right.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from reports.records.trial import TrialRecord, Verdict
from reports.statistics.groups import Group, grouped, ordered_policies
from reports.statistics.success_rates import SuccessRates, success_rates
from scenarios.model import Expectation

ALL = "all"
"""Name of all families together."""


@dataclass(frozen=True, slots=True)
class Pair:
    """The scenes of a pair on one engine and profile under one policy."""

    name: str
    family: str
    """Name of the scenario of which its scenes are variants."""
    judged: tuple[frozenset[Verdict], ...]
    """Verdicts of both sides, for each seed with both sides decided."""
    undecided: int
    """Number of seeds without that: a side was stopped by the time limit, is impossible on the engine, or was built too
    near its limit for a known answer."""


class SetUp(NamedTuple):
    """The builder of the pairs: engine, profile and policy."""

    engine: str
    profile: str
    policy: str


class PairRow(NamedTuple):
    """The pairs of one family, or of all, on one engine and profile under one policy."""

    set_up: SetUp
    family: str
    success_rates: SuccessRates | None
    """Success rates; None if nothing was judged."""
    undecided: int


def pairs_of(groups: Sequence[Group]) -> list[Pair]:
    """Return the pairs among the groups of one engine, profile and policy; a scene without its partner is left out."""
    sides = grouped([group for group in groups if group.pair], "pair")
    return [_pair(name, those) for (name,), those in sides.items() if are_opposed([one.expectation for one in those])]


def are_opposed(expectations: Sequence[Expectation]) -> bool:
    """Return whether scenes demand opposite outcomes: stand and fall, or stand for a time and fall at once.

    A prebuilt stack must stand until a brick is removed, and then fall; its partner must fall at once.
    """
    outcomes = {one.outcome for one in expectations}
    stands_first = {one.not_before_s > 0.0 for one in expectations if one.outcome == "fall"}
    return "study" not in outcomes and (outcomes == {"stand", "fall"} or stands_first == {True, False})


def pair_success_rates(pairs: Sequence[Pair]) -> SuccessRates | None:
    """Return the success rates of the pairs' builds, with a bootstrap over pairs; None if none was judged."""
    return success_rates([pair.judged for pair in pairs])


def pair_rows(groups: Sequence[Group]) -> list[PairRow]:
    """Return all pairs of each set-up, then the pairs of each family; empty if the study has no pairs."""
    by_set_up = grouped(groups, "key.engine", "key.profile", "key.policy")
    set_ups = {SetUp(*key): members for key, members in by_set_up.items()}
    rows = []
    for set_up in _in_order(set_ups):
        pairs = pairs_of(set_ups[set_up])
        for family in (ALL, *dict.fromkeys(pair.family for pair in pairs)) if pairs else ():
            those = [pair for pair in pairs if family in (ALL, pair.family)]
            rows.append(PairRow(set_up, family, pair_success_rates(those), sum(pair.undecided for pair in those)))
    return rows


def _pair(name: str, sides: Sequence[Group]) -> Pair:
    seeds = sorted(set.intersection(*({trial.seed for trial in side.draws} for side in sides)))
    builds = [[side.by_seed[seed][0] for side in sides] for seed in seeds]
    judged = [build for build in builds if _can_be_judged(build)]
    verdicts = tuple(frozenset(trial.verdict for trial in build) for build in judged)
    return Pair(name, sides[0].scenario, verdicts, len(builds) - len(judged))


def _can_be_judged(build: Sequence[TrialRecord]) -> bool:
    """Return whether all sides of a build were decided, and demand opposite outcomes."""
    decided = all(trial.is_judged for trial in build)
    return decided and are_opposed([trial.expectation for trial in build])


def _in_order(set_ups: Collection[SetUp]) -> list[SetUp]:
    """Return engines and profiles in order of appearance, policies in their usual order."""
    engines = list(dict.fromkeys((set_up.profile, set_up.engine) for set_up in set_ups))
    policies = ordered_policies(set_up.policy for set_up in set_ups)
    return sorted(set_ups, key=lambda one: (engines.index((one.profile, one.engine)), policies.index(one.policy)))
