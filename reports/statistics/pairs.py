"""Pairs of scenes that demand opposite outcomes, although little but the deciding quantity differs.

A pair counts as correct only if both outcomes are correct, because single trials reward trivial policies. A policy that
freezes everything also holds the scene that must fall. A policy that freezes nothing may drop the scene that must
stand. Each of these policies may get half of all trials right.
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
"""Name of the row for all families together."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Verdicts of a pair of scenes on one engine and profile under one policy."""

    name: str
    family: str
    """Name of the scenario of which the scenes are variants."""
    judged: tuple[frozenset[Verdict], ...]
    """Verdicts of both scenes, for each seed with a judgement of both scenes."""
    undecided: int
    """Number of seeds of both scenes without a judgement of both scenes. The reasons are:

    - the time limit stopped a trial;
    - the engine does not support a scene;
    - a stack that must stand is in neutral balance;
    - placement noise moved a scene so close to its limit that its answer is unknown.
    """


class SetUp(NamedTuple):
    """Engine, profile and policy of pairs."""

    engine: str
    profile: str
    policy: str


class PairRow(NamedTuple):
    """Success rates of the pairs of one family, or of all families, on one engine and profile under one policy."""

    set_up: SetUp
    family: str
    """Name of the family, or ``ALL``."""
    success_rates: SuccessRates | None
    """Success rates; None if no pair was judged."""
    undecided: int
    """Number of seeds without a judgement of both scenes, summed over the pairs."""


class PairedScenes(NamedTuple):
    """Scenes of a family in a study with pairs: scenes in pairs, and scenes without a partner."""

    family: str
    pairs: int
    """Number of different pairs."""
    paired: tuple[str, ...]
    """Ids of the scenes in pairs."""
    alone: tuple[str, ...]
    """Ids of the scenes without a partner. No table of pairs counts these scenes."""


def paired_scenes(groups: Sequence[Group]) -> list[PairedScenes]:
    """Return the scenes of each family, in pairs and without a partner; empty without pairs."""
    by_set_up = grouped(groups, "key.engine", "key.profile", "key.policy").values()
    names = {pair.name for members in by_set_up for pair in pairs_of(members)}
    found = []
    for (family,), members in grouped(groups, "scenario").items() if names else ():
        paired = dict.fromkeys(group.key.scene for group in members if group.pair in names)
        alone = dict.fromkeys(group.key.scene for group in members if group.key.scene not in paired)
        pairs = {group.pair for group in members} & names
        found.append(PairedScenes(family, len(pairs), tuple(paired), tuple(alone)))
    return found


def pairs_of(groups: Sequence[Group]) -> list[Pair]:
    """Return the pairs in the groups of one engine, profile and policy; skip scenes without a partner."""
    sides = grouped([group for group in groups if group.pair], "pair")
    return [_pair(name, those) for (name,), those in sides.items() if are_opposed([one.expectation for one in those])]


def are_opposed(expectations: Sequence[Expectation]) -> bool:
    """Return whether scenes demand opposite outcomes: stand and fall, or fall later and fall at once.

    In a pair of the second kind, a prebuilt stack must stand until the harness removes a brick, and then fall. Its
    partner must fall at once.
    """
    outcomes = {one.outcome for one in expectations}
    stands_first = {one.not_before_s > 0.0 for one in expectations if one.outcome == "fall"}
    return "study" not in outcomes and (outcomes == {"stand", "fall"} or stands_first == {True, False})


def pair_success_rates(pairs: Sequence[Pair]) -> SuccessRates | None:
    """Return the success rates of pairs, with bootstrap intervals over pairs and seeds; None without judged pairs."""
    return success_rates([pair.judged for pair in pairs])


def pair_rows(groups: Sequence[Group]) -> list[PairRow]:
    """Return the rows of each engine, profile and policy with pairs: all pairs together, then each family."""
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
    """Return whether both trials ended with a decision and their scenes demand opposite outcomes."""
    decided = all(trial.is_judged for trial in build)
    return decided and are_opposed([trial.expectation for trial in build])


def _in_order(set_ups: Collection[SetUp]) -> list[SetUp]:
    """Return the sorted set-ups: engines and profiles in order of appearance, policies in their usual order."""
    engines = list(dict.fromkeys((set_up.profile, set_up.engine) for set_up in set_ups))
    policies = ordered_policies(set_up.policy for set_up in set_ups)
    return sorted(set_ups, key=lambda one: (engines.index((one.profile, one.engine)), policies.index(one.policy)))
