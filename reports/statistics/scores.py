"""Scores of each engine, profile and policy: success rates and frame times."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from reports.records.trial import TrialRecord
from reports.statistics.groups import Group, grouped, ordered_policies
from reports.statistics.intervals import Estimate, paired_ratio, success_rate
from reports.statistics.pairs import pair_success_rates, pairs_of
from reports.statistics.success_rates import SuccessRates, count, success_rates

FRAME_BUDGETS_MS = {60: 1e3 / 60, 90: 1e3 / 90}
"""Time budgets of a frame [ms], by frames per second: 60 for a monitor, 90 for a headset."""


class SlowestScene(NamedTuple):
    """The scene with the greatest 99th percentile of frame times."""

    frame_ms_p99: float
    scene: str


@dataclass(frozen=True, slots=True)
class PolicyScore:
    """Success rates and frame times of one engine and profile under one policy, over all scenes."""

    policy: str
    stand: Estimate | None
    """Success rate of trials that must stand; None if no such trial was judged."""
    fall: Estimate | None
    """Success rate of trials that must fall; None if no such trial was judged."""
    trials: SuccessRates | None
    """Success rates of all trials; None if no trial was judged."""
    measures_creep: bool
    """True if the creep of a stack that must stand, and stood, was measured."""
    pairs: SuccessRates | None
    """Success rates of pairs of scenes; None if no pair was judged."""
    others: SuccessRates | None
    """Success rates of the trials of scenes without a partner; None without pairs, and if no such trial was judged."""
    units: SuccessRates | None
    """Success rates of pairs and of other scenes together, as in the ranking; None if no pair or trial was judged."""
    frame_ms_p99: float | None
    """Median over scenes of the 99th percentile of frame times [ms], without scenes whose times come from several
    machines; None if no scene remains."""
    slowest: SlowestScene | None
    """The scene with the greatest 99th percentile of frame times, without scenes whose times come from several
    machines; None if no scene remains."""
    frame_ratios: tuple[Estimate, ...]
    """Frame ratio of each scene with at least ``LEAST_RATIOS`` pairs of times. A frame ratio is the frame time with the
    extension over the frame time without the extension, on the same stack."""

    @property
    def headline(self) -> SuccessRates | None:
        """Success rates of pairs, or of trials if there are no pairs.

        Pairs take precedence, because a policy that freezes everything may get half of the trials right.
        """
        return self.pairs or self.trials

    @property
    def summary(self) -> str:
        """Counts of right outcomes as text.

        Example: ``38 of 46 pairs, 2 of 6 other scenes; 50 of 55 that must stand, 40 of 46 that must fall``.
        """
        sides = [(self.stand, "stand"), (self.fall, "fall")]
        sides_text = ", ".join(
            f"{count(side)} of {side.n} that must {word}" for side, word in sides if side is not None
        )
        others = ""
        if self.others is not None:
            others = f", {self.others.right_count} of {self.others.n} other scene{'s' * (self.others.n != 1)}"
        return (
            f"{self.pairs.right_count} of {self.pairs.n} pair{'s' * (self.pairs.n != 1)}{others}; {sides_text}"
            if self.pairs is not None
            else sides_text
        )


@dataclass(frozen=True, slots=True)
class EngineScores:
    """Scores of one engine with one profile."""

    engine: str
    profile: str
    version: str
    scores: tuple[PolicyScore, ...]
    """One score per policy, in the usual order."""
    trials: tuple[TrialRecord, ...]
    """All trials of the engine and profile."""


def engine_scores(groups: Sequence[Group]) -> list[EngineScores]:
    """Return the scores of each engine and profile, in the order of the groups."""
    by_engine = grouped(groups, "key.profile", "key.engine")
    return [_engine_scores(engine, profile, members) for (profile, engine), members in by_engine.items()]


def _engine_scores(engine: str, profile: str, groups: Sequence[Group]) -> EngineScores:
    policies = ordered_policies(group.key.policy for group in groups)
    scores = tuple(score(policy, [group for group in groups if group.key.policy == policy]) for policy in policies)
    trials = tuple(trial for group in groups for trial in group.trials)
    return EngineScores(engine, profile, trials[0].engine_version, scores, trials)


def score(policy: str, groups: Sequence[Group]) -> PolicyScore:
    """Return the score of the groups of one engine, profile and policy."""

    def right(side: str) -> Estimate | None:
        those = [group for group in groups if group.expectation.outcome == side]
        return success_rate([[trial.verdict == "right" for trial in group.judged] for group in those])

    pairs = pairs_of(groups)
    in_pairs = {pair.name for pair in pairs}
    others = [[{trial.verdict} for trial in group.judged] for group in groups if group.pair not in in_pairs]
    return PolicyScore(
        policy,
        stand=right("stand"),
        fall=right("fall"),
        measures_creep=any(_measures_creep(trial) for group in groups for trial in group.draws),
        trials=success_rates([[{trial.verdict} for trial in group.judged] for group in groups]),
        pairs=pair_success_rates(pairs),
        others=success_rates(others) if pairs else None,
        units=success_rates([*(pair.judged for pair in pairs), *others]),
        frame_ms_p99=middle(groups, "frame_ms_p99"),
        slowest=slowest_scene(groups),
        frame_ratios=_ratios(groups),
    )


def _measures_creep(trial: TrialRecord) -> bool:
    return trial.verdict == "creeps" or (trial.creep_m_s is not None and trial.expectation.outcome == "stand")


def slowest_scene(groups: Sequence[Group]) -> SlowestScene | None:
    """Return the scene with the greatest 99th percentile of frame times; None if no scene has a value.

    Args:
        groups: groups of one engine, profile and policy.
    """
    times = [(group.estimate("frame_ms_p99"), group.key.scene) for group in groups]
    return max((SlowestScene(time.value, scene) for time, scene in times if time is not None), default=None)


def _ratios(groups: Sequence[Group]) -> tuple[Estimate, ...]:
    estimates = [paired_ratio(group.measured("frame_ratio")) for group in groups]
    return tuple(estimate for estimate in estimates if estimate is not None)


def middle(groups: Sequence[Group], field: str) -> float | None:
    """Return the median over scenes of a field; None if no scene has a value.

    Args:
        groups: groups of one engine, profile and policy.
        field: name of a numeric field of a record.
    """
    estimates = [estimate.value for group in groups if (estimate := group.estimate(field)) is not None]
    return statistics.median(estimates) if estimates else None
