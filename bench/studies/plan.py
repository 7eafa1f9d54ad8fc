"""The trials of a study. Each trial has an id, so that a continued run skips finished trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

from bench.studies.bisect import Bisect
from bench.studies.schema import Study, Value
from reports.records.trial import Status
from reports.statistics.thresholds import stood
from scenarios.model import Scene
from scenarios.placement_noise import with_placement_noise
from scenarios.registry import build


@dataclass(frozen=True, slots=True)
class Trial:
    """A run of one scene on one engine and profile under one policy."""

    engine: str
    profile: str
    scenario: str
    scene: str
    """Id of the scene: the scenario with its parameters."""
    parameters: Mapping[str, int | float | str]
    policy: str
    seed: int
    """Seed of the placement noise; seed 0 has no noise."""
    repeat: int
    """Index of the repeat, from 0; all repeats have the same settings."""
    watch_s: float | None = None
    """Time for which the trial watches the scene after its last action [s]; None for the scene's own value."""

    @property
    def id(self) -> str:
        """Id of the trial, which is unique within a study, the same in every run, and a valid file name."""
        return f"{self.engine}.{self.profile}.{self.scene}.{self.policy}.s{self.seed}.r{self.repeat}"

    def build_scene(self) -> Scene:
        """Return the scene with this trial's placement noise.

        Raises:
            NoRoomError: if the bricks fit too closely for placement noise.
        """
        return with_placement_noise(self.planned_scene(), self.seed)

    def planned_scene(self) -> Scene:
        """Return the scene without placement noise."""
        scene = build(self.scenario, **self.parameters)
        return scene if self.watch_s is None else replace(scene, watch_s=self.watch_s)


def plan_trials(study: Study) -> list[Trial]:
    """Return all trials that do not depend on the outcomes of other trials.

    The trials of a scene follow each other, so that all engines and policies play the scene at similar times. The order
    of the policies on one stack alternates (A B, then B A), so that slow drifts of the machine's speed cancel. For a
    bisected parameter, the list contains only the trials at both ends; ``next_trials`` returns the other trials.
    """
    return [
        trial
        for chosen in study.scenario
        for parameters in chosen.known_variants()
        for trial in _trials_of(study, chosen.name, parameters)
    ]


def waiting_trials(study: Study, statuses: Mapping[str, Status]) -> list[Trial]:
    """Return the trials to run now: the unfinished trials of ``plan_trials``, then ``next_trials``.

    Args:
        study: the study to run.
        statuses: status of each finished trial, by its id.
    """
    waiting = {trial.id: trial for trial in [*plan_trials(study), *next_trials(study, statuses)]}
    return [trial for name, trial in waiting.items() if name not in statuses]


def next_trials(study: Study, statuses: Mapping[str, Status]) -> list[Trial]:
    """Return the trials that each unfinished bisection needs next: both ends, then values that depend on outcomes.

    Args:
        study: a study, in which scenarios may have a ``bisect``.
        statuses: status of each finished trial, by its id.
    """
    following = []
    for chosen in study.scenario:
        if chosen.bisect is None:
            continue
        for parameters in chosen.variants():
            for first in _trials_of(study, chosen.name, {**parameters, chosen.bisect.parameter: chosen.bisect.low}):
                following += _next_of(first, chosen.bisect, statuses)
    return following


def _next_of(first: Trial, bisect: Bisect, statuses: Mapping[str, Status]) -> list[Trial]:
    """Return the next trials of a bisection; ``first`` is the trial at the lower end."""
    answers: dict[float, bool | None] = {}
    while (bracket := bisect.bisection.bracket(answers)).next:
        trials = [_at(first, bisect.parameter, value) for value in bracket.next]
        if waiting := [trial for trial in trials if trial.id not in statuses]:
            return waiting
        answers |= {value: stood(statuses[trial.id]) for value, trial in zip(bracket.next, trials, strict=True)}
    return []


def later_trials(study: Study) -> list[Trial]:
    """Return substitutes for the unknown later trials of bisections, to estimate the duration of a run.

    The number of substitutes is the greatest possible number of later trials. The bisected parameter of each substitute
    is the middle of the range of the search.
    """
    return [
        trial
        for chosen in study.scenario
        if chosen.bisect is not None
        for parameters in chosen.variants()
        for trial in _trials_of(study, chosen.name, {**parameters, chosen.bisect.parameter: chosen.bisect.middle})
        for _ in range(chosen.bisect.bisection.most_tries - 2)
    ]


def _at(first: Trial, parameter: str, value: float) -> Trial:
    parameters = {**first.parameters, parameter: value}
    return replace(first, parameters=parameters, scene=build(first.scenario, **parameters).variant)


def _trials_of(study: Study, scenario: str, parameters: Mapping[str, Value]) -> list[Trial]:
    """Return the trials of one variant of a scenario that the rules of the study admit."""
    variant = build(scenario, **parameters).variant
    runs = list(product(range(study.seeds), range(study.repeats)))
    return [
        Trial(engine, profile, scenario, variant, parameters, policy, seed, repeat, study.watch_s)
        for engine, profile in study.set_ups()
        for number, (seed, repeat) in enumerate(runs)
        for policy in (study.policies if number % 2 == 0 else reversed(study.policies))
        if study.admits(engine, profile, policy, scenario)
    ]
