"""The verdict of a study on each engine and profile, in sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from reports.records.trial import Status, TrialRecord
from reports.statistics.groups import ALONE
from reports.statistics.scores import FRAME_BUDGETS_MS, EngineScores, PolicyScore, SlowestScene
from reports.tables.verdict import milliseconds
from reports.tables.wording import percent, ratio_text


@dataclass(frozen=True, slots=True)
class EngineVerdict:
    """Headline, sentences and scores of one engine with one profile."""

    engine: str
    profile: str
    version: str
    """Version of the engine."""
    headline: str
    sentences: tuple[str, ...]
    scores: tuple[PolicyScore, ...]
    """One score per policy."""


def verdicts(engines: Sequence[EngineScores]) -> list[EngineVerdict]:
    """Return one verdict for each engine and profile, in the order of ``engines``."""
    return [_verdict(engine) for engine in engines]


def _verdict(engine: EngineScores) -> EngineVerdict:
    scores = engine.scores
    judged = [one for one in scores if one.headline is not None]
    sentences = [f"{_who(one.policy)}: {one.summary}{_holds_everything(one)}." for one in judged]
    sentences += [_cost(one) for one in scores if one.frame_ratios]
    sentences += [_budget(one.policy, one.slowest, one.frame_ms_p99) for one in scores if one.slowest is not None]
    sentences += _trouble(engine.trials)
    return EngineVerdict(engine.engine, engine.profile, engine.version, _headline(judged), tuple(sentences), scores)


def _who(policy: str) -> str:
    return "Alone" if policy == ALONE else f"With {policy}"


def _headline(scores: Sequence[PolicyScore]) -> str:
    rated = {one.policy: one.headline.right for one in scores if one.headline is not None}
    if not rated:
        return "No scene here has a known answer."
    what = "pair" if any(one.pairs is not None for one in scores) else "stack"
    perfect = [one for one in scores if one.headline is not None and one.headline.right.value == 1]
    if perfect and all(_wrong(one) for one in perfect):
        best = min(perfect, key=_wrong)
        return f"Every {what} right {_how([best])}, but {_wrong(best)} of {_judged(best)} trials wrong."
    perfect = [one for one in perfect if not _wrong(one)]
    on_both_sides = [one for one in perfect if one.stand is not None and one.fall is not None]
    if on_both_sides:
        scenes = " and other scene" if any(one.others is not None for one in on_both_sides) else ""
        return f"Every {what}{scenes} right {_how(on_both_sides)}."
    if perfect:
        side = "fall" if perfect[0].stand is None else "stand"
        return f"Right {_how(perfect)}, though only stacks that must {side} were built."
    most = max(rated, key=lambda policy: rated[policy].value)
    how = "alone" if most == ALONE else f"with {most}"
    return f"At best {percent(rated[most])} of the {what}s right, {how}."


def _judged(one: PolicyScore) -> int:
    return 0 if one.trials is None else one.trials.n


def _wrong(one: PolicyScore) -> int:
    """Return the number of judged trials that are not right, also of scenes without a partner."""
    return 0 if one.trials is None else one.trials.n - one.trials.right_count


def _how(perfect: Sequence[PolicyScore]) -> str:
    """Return the policies in words.

    If the engine alone is among the policies, return only this policy, because the engine alone is the simplest policy.
    """
    names = [one.policy for one in perfect]
    return "alone" if ALONE in names else f"with {' or '.join(names)}"


def _holds_everything(one: PolicyScore) -> str:
    """Return a warning for a policy that holds stacks regardless of theory; else an empty string.

    Such a policy is right for every stack that must stand, wrong for every stack that must fall, and has false stands.
    """
    holds_all = one.fall is not None and one.fall.value == 0 and one.stand is not None and one.stand.value == 1
    stood = one.trials is not None and one.trials.false_stand.value > 0
    return ", so it holds every stack that comes to rest" if holds_all and stood else ""


def _cost(one: PolicyScore) -> str:
    """Return a sentence with the median frame ratio of the scenes and its interval.

    For an even number of scenes, the sentence gives the upper of the two middle ratios, because only the ratio of a
    scene has an interval.
    """
    by_value = sorted(one.frame_ratios, key=lambda estimate: estimate.value)
    ratio = by_value[len(by_value) // 2]
    saves = ratio.high is not None and ratio.high < 1
    of_scenes = "" if len(by_value) == 1 else f"; the middle one of {len(by_value)} scenes"
    text = f"a frame takes {ratio_text(ratio)} times the frame time of the same stack all awake"
    return f"With {one.policy} {text} ({ratio.n} pairs{of_scenes}){'' if saves else ': no certain gain of time here'}."


def _budget(policy: str, slowest: SlowestScene, median_ms: float | None) -> str:
    """Return a sentence on the slowest scene of a policy, because a median over scenes can hide slow frames."""
    kept = [hertz for hertz, budget in FRAME_BUDGETS_MS.items() if slowest.frame_ms_p99 <= budget]
    judged = f"within a frame at {max(kept)} Hz" if kept else "too slow for a frame at 60 Hz"
    middle = "" if median_ms is None else f"; {milliseconds(median_ms)} ms in the median scene"
    return f"{_who(policy)}: {judged} ({milliseconds(slowest.frame_ms_p99)} ms in {slowest.scene}{middle})."


def _trouble(trials: Sequence[TrialRecord]) -> list[str]:
    words: dict[Status, str] = {
        "timeout": "stopped by the time limit (neither right nor wrong)",
        "diverged": "diverged",
        "crashed": "crashed",
        "error": "ended in an error",
        "out_of_memory": "ran out of memory",
        "unsupported": "not possible on this engine",
    }
    ends = [trial.status for trial in trials]
    counted = [f"{ends.count(status)} {text}" for status, text in words.items() if status in ends]
    return [f"Of {len(ends)} trials: {', '.join(counted)}."] if counted else []
