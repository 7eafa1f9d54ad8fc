"""What a study says of each engine, in plain words."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from reports.cells import ALONE, Cell, ordered_policies
from reports.intervals import Estimate, share
from reports.pairs import pair_shares, pairs_of
from reports.records import Status
from reports.shares import Shares, count, shares
from reports.wording import percent

FRAME_BUDGETS_MS = {60: 1e3 / 60, 90: 1e3 / 90}
"""Time [ms] that a frame may take, by frames a second: a monitor's and a headset's."""


@dataclass(frozen=True, slots=True)
class PolicyScore:
    """How right one engine and profile is under one policy, over all scenes of known truth."""

    policy: str
    stand: Estimate | None
    """Share right of trials that must stand; None if there are none."""
    fall: Estimate | None
    """Share right of trials that must fall."""
    trials: Shares | None
    """Of all trials; None if theory can judge none."""
    pairs: Shares | None
    """Of pairs of scenes; None if there are none."""
    frame_ms_p99: float | None
    """Median over scenes of the 99th percentile of frame times [ms]."""
    frame_ratio: float | None
    """Median over scenes of the frame time over that of the same stack all awake."""

    @property
    def headline(self) -> Shares | None:
        """What counts: pairs where there are any, for half of all trials is right by glue alone."""
        return self.pairs or self.trials

    @property
    def told(self) -> str:
        """``38 of 46 pairs; 50 of 55 that must stand, 40 of 46 that must fall``."""
        sides = [(self.stand, "stand"), (self.fall, "fall")]
        told = ", ".join(f"{count(side)} of {side.n} that must {word}" for side, word in sides if side is not None)
        return f"{self.pairs.right_count} of {self.pairs.n} pairs; {told}" if self.pairs is not None else told


@dataclass(frozen=True, slots=True)
class EngineVerdict:
    """One engine with one profile."""

    engine: str
    profile: str
    version: str
    headline: str
    sentences: tuple[str, ...]
    scores: tuple[PolicyScore, ...]


def score(policy: str, cells: Sequence[Cell]) -> PolicyScore:
    """The score of the cells of one engine, profile and policy."""

    def right(side: str) -> Estimate | None:
        those = [cell for cell in cells if cell.expectation.outcome == side]
        return share([[trial.verdict == "right" for trial in cell.judged] for cell in those])

    return PolicyScore(
        policy,
        stand=right("stand"),
        fall=right("fall"),
        trials=shares([[{trial.verdict} for trial in cell.judged] for cell in cells]),
        pairs=pair_shares(pairs_of(cells)),
        frame_ms_p99=_middle(cells, "frame_ms_p99"),
        frame_ratio=_middle(cells, "frame_ratio"),
    )


def verdicts(cells: Sequence[Cell]) -> list[EngineVerdict]:
    """One verdict for each engine and profile, in the order of the cells."""
    groups: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.key.profile, cell.key.engine), []).append(cell)
    return [_verdict(engine, profile, those) for (profile, engine), those in groups.items()]


def _verdict(engine: str, profile: str, cells: Sequence[Cell]) -> EngineVerdict:
    policies = ordered_policies(cell.key.policy for cell in cells)
    scores = tuple(score(policy, [cell for cell in cells if cell.key.policy == policy]) for policy in policies)
    judged = [one for one in scores if one.headline is not None]
    sentences = []
    for one in judged:
        who = "Alone" if one.policy == ALONE else f"With {one.policy}"
        sentences.append(f"{who}: {one.told}{_glue(one)}.")
    sentences += [_cost(one) for one in scores if one.frame_ratio is not None]
    sentences += _budget(scores)
    sentences += _trouble(cells)
    version = next((t.engine_version for cell in cells for t in cell.trials), "")
    return EngineVerdict(engine, profile, version, _headline(judged), tuple(sentences), scores)


def _headline(scores: Sequence[PolicyScore]) -> str:
    rated = {one.policy: one.headline.right for one in scores if one.headline is not None}
    if not rated:
        return "Nothing here that theory can judge."
    what = "pair" if any(one.pairs is not None for one in scores) else "stack"
    perfect = [policy for policy, right in rated.items() if right.value == 1]
    both = all(one.stand is not None and one.fall is not None for one in scores)
    if perfect:
        how = "alone" if ALONE in perfect else f"with {' or '.join(perfect)}"
        if not both:
            side = "fall" if scores[0].stand is None else "stand"
            return f"Right {how}, though only stacks that must {side} were built."
        return f"Every {what} right {how}."
    best = max(rated, key=lambda policy: rated[policy].value)
    how = "alone" if best == ALONE else f"with {best}"
    return f"At best {percent(rated[best])} of the {what}s right, {how}."


def _glue(one: PolicyScore) -> str:
    """A warning of what holds everything up."""
    holds_all = one.fall is not None and one.fall.value == 0 and one.stand is not None and one.stand.value == 1
    stood = one.trials is not None and one.trials.false_stand.value > 0
    return ", so it holds up whatever comes to rest" if holds_all and stood else ""


def _cost(one: PolicyScore) -> str:
    ratio, awake = one.frame_ratio or 0.0, "what the same stack costs all awake"
    if ratio <= 1:
        return f"With {one.policy} a frame costs {ratio:.2f} of {awake}."
    return f"With {one.policy} a frame costs {ratio:.2f} times {awake}: no gain of time here."


def _budget(scores: Sequence[PolicyScore]) -> list[str]:
    timed = [one for one in scores if one.frame_ms_p99 is not None]
    if not timed:
        return []
    slowest = max(one.frame_ms_p99 or 0.0 for one in timed)
    kept = [hertz for hertz, budget in FRAME_BUDGETS_MS.items() if slowest <= budget]
    what = f"99 of 100 frames take at most {slowest:.2f} ms (median of the scenes, slowest policy)"
    return [f"{what}: within a frame at {max(kept)} Hz." if kept else f"{what}: too slow for a frame at 60 Hz."]


def _trouble(cells: Sequence[Cell]) -> list[str]:
    words: dict[Status, str] = {
        "timeout": "stopped by the time limit (neither right nor wrong)",
        "diverged": "diverged",
        "crashed": "crashed",
        "error": "ended in an error",
        "out_of_memory": "ran out of memory",
        "unsupported": "not possible on this engine",
    }
    ends = [trial.status for cell in cells for trial in cell.trials]
    counted = [f"{ends.count(status)} {text}" for status, text in words.items() if status in ends]
    return [f"Of {len(ends)} trials: {', '.join(counted)}."] if counted else []


def _middle(cells: Sequence[Cell], field: str) -> float | None:
    estimates = [estimate.value for cell in cells if (estimate := cell.estimate(field)) is not None]
    return statistics.median(estimates) if estimates else None
