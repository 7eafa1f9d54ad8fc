"""From a study to its trials. A trial's id is the unit of resume: same id, same trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from bench.studies.schema import Study
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
    """0 builds exactly; any other number is a hand that does not."""
    repeat: int
    """Number of the repetition, from 0; repetitions differ in nothing but their timing."""

    @property
    def id(self) -> str:
        """Unique within a study, the same in every run of it, and fit to name a file."""
        return f"{self.engine}.{self.profile}.{self.scene}.{self.policy}.s{self.seed}.r{self.repeat}"

    def build_scene(self) -> Scene:
        """The scene as this trial's hand builds it.

        Raises:
            NoRoomError: if its bricks fit too closely for placement noise.
        """
        return with_placement_noise(self.planned_scene(), self.seed)

    def planned_scene(self) -> Scene:
        """Return the scene without placement noise."""
        return build(self.scenario, **self.parameters)


def plan_trials(study: Study) -> list[Trial]:
    """All trials of a study: scene by scene, so that engines and policies are compared soon after another.

    The policies on one stack follow each other at once and in alternating order (A B, then B A), so that a machine
    that grows slower favours none of them.
    """
    variants = [
        (chosen.name, build(chosen.name, **parameters).variant, parameters)
        for chosen in study.scenario
        for parameters in chosen.variants()
    ]
    runs = list(product(range(study.seeds), range(study.repeats)))
    return [
        Trial(engine, profile, scenario, variant, parameters, policy, seed, repeat)
        for (scenario, variant, parameters), (engine, profile) in product(variants, study.set_ups())
        for number, (seed, repeat) in enumerate(runs)
        for policy in (study.policies if number % 2 == 0 else reversed(study.policies))
        if study.admits(engine, profile, policy, scenario)
    ]
