"""The trials of a study. A trial's id is the unit of resume: same id, same trial."""

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
    """One run of one scene on one engine under one policy."""

    engine: str
    profile: str
    scenario: str
    scene: str
    """Id of the scene's variant."""
    parameters: Mapping[str, int | float | str]
    policy: str
    seed: int
    """Seed of the placement noise; 0 builds exactly."""
    repeat: int
    """Number of the repeat, from 0; repeats differ in timing only."""
    watch_s: float | None = None
    """Time [s] for which it watches after its last action; None: the scene's."""

    @property
    def id(self) -> str:
        """Id of the trial: unique within a study, the same in every run of it, and a valid file name."""
        return f"{self.engine}.{self.profile}.{self.scene}.{self.policy}.s{self.seed}.r{self.repeat}"

    def build_scene(self) -> Scene:
        """Return the scene with this trial's placement noise.

        Raises:
            NoRoomError: if its bricks fit too closely for placement noise.
        """
        return with_placement_noise(self.planned_scene(), self.seed)

    def planned_scene(self) -> Scene:
        """Return the scene without placement noise."""
        scene = build(self.scenario, **self.parameters)
        return scene if self.watch_s is None else replace(scene, watch_s=self.watch_s)


def plan_trials(study: Study) -> list[Trial]:
    """Return all trials known beforehand, scene by scene, so that engines and policies are compared at similar times.

    The policies on one stack follow each other at once and in alternating order (A B, then B A), so that a machine
    that grows slower favours none of them. Of a bisected parameter both ends are known: see ``next_trials``.
    """
    return [
        trial
        for chosen in study.scenario
        for parameters in chosen.known_variants()
        for trial in _trials_of(study, chosen.name, parameters)
    ]


def waiting_trials(study: Study, statuses: Mapping[str, Status]) -> list[Trial]:
    """Return the trials that can be run now: the unfinished ones known beforehand, then ``next_trials``.

    Args:
        study: what is run.
        statuses: how each trial that has ended did so, by its id.
    """
    waiting = {trial.id: trial for trial in [*plan_trials(study), *next_trials(study, statuses)]}
    return [trial for name, trial in waiting.items() if name not in statuses]


def next_trials(study: Study, statuses: Mapping[str, Status]) -> list[Trial]:
    """Return the trials that follow from those that have ended: the next of each bisection that goes on.

    Args:
        study: with scenarios that have a ``bisect``.
        statuses: how each trial ended, by its id.
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
    """Return the next trials of the bisection that begins with ``first``."""
    answers: dict[float, bool | None] = {}
    while (bracket := bisect.bisection.bracket(answers)).next:
        trials = [_at(first, bisect.parameter, value) for value in bracket.next]
        if waiting := [trial for trial in trials if trial.id not in statuses]:
            return waiting
        answers |= {value: stood(statuses[trial.id]) for value, trial in zip(bracket.next, trials, strict=True)}
    return []


def later_trials(study: Study) -> list[Trial]:
    """Return stand-ins for the trials that follow by bisection, as many as there may be, all in the middle."""
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
    """Return every trial of one variant of a scenario."""
    variant = build(scenario, **parameters).variant
    runs = list(product(range(study.seeds), range(study.repeats)))
    return [
        Trial(engine, profile, scenario, variant, parameters, policy, seed, repeat, study.watch_s)
        for engine, profile in study.set_ups()
        for number, (seed, repeat) in enumerate(runs)
        for policy in (study.policies if number % 2 == 0 else reversed(study.policies))
        if study.admits(engine, profile, policy, scenario)
    ]
