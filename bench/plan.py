"""From a study to its trials. A trial's id is the unit of resume: same id, same trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from bench.studies import Study
from scenarios.hand import with_hand
from scenarios.model import Scene
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
    """0 builds exactly; any other number is a hand that does not."""
    repeat: int
    """Number of the repetition, from 0; repetitions differ in nothing but their timing."""

    @property
    def id(self) -> str:
        """Unique within a study, the same in every run of it, and fit to name a file."""
        return f"{self.engine}.{self.profile}.{self.scene}.{self.policy}.s{self.seed}.r{self.repeat}"

    def build_scene(self) -> Scene:
        """The scene as this trial's hand builds it."""
        return with_hand(build(self.scenario, **self.parameters), self.seed)


def plan_trials(study: Study) -> list[Trial]:
    """All trials of a study: scene by scene, so that engines and policies are compared soon after another."""
    variants = [
        (chosen.name, build(chosen.name, **parameters).variant, parameters)
        for chosen in study.scenario
        for parameters in chosen.variants()
    ]
    return [
        Trial(engine, profile, scenario, variant, parameters, policy, seed, repeat)
        for (scenario, variant, parameters), profile, engine, seed, policy, repeat in product(
            variants, study.profiles, study.engines, range(study.seeds), study.policies, range(study.repeats)
        )
    ]
