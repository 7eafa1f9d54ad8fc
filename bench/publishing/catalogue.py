"""The studies published in ``docs/results``, and the command that runs each study."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field

from bench.studies.schema import Study, load_study
from bench.studies.selection import Selection, selected


@dataclass(frozen=True, slots=True)
class Gallery:
    """Selection of stills for one published picture with a row per scene and a column per policy."""

    engine: str
    profile: str
    scenes: tuple[str, ...]
    """Ids of the scenes, in the order of the rows."""


@dataclass(frozen=True, slots=True)
class Publication:
    """A study with a selection, whose results are in a folder of ``docs/results``."""

    shows: str
    """Description of the publication's content, in one line."""
    study: str
    """Name of the study."""
    selection: Selection = field(default_factory=Selection)
    """Choices that narrow or change the study."""
    gallery: Gallery | None = None
    """Picture to publish; None for a publication without stills."""
    is_timed: bool = True
    """True if the page shows times. If False, several trials may run at the same time (``--jobs``), because cost is not
    the subject of the publication.
    """

    @property
    def arguments(self) -> list[str]:
        """Arguments of ``bench run`` that run the study with its selection."""
        chosen = self.selection
        options = {
            "--engine": chosen.engines,
            "--scenario": chosen.scenarios,
            "--policy": chosen.policies,
            "--profile": chosen.profiles,
            "--seeds": () if chosen.seeds is None else (str(chosen.seeds),),
            "--hours": () if chosen.hours is None else (f"{chosen.hours:g}",),
        }
        return [self.study, *(word for option, names in options.items() for name in names for word in (option, name))]

    @property
    def command(self) -> str:
        """The command that runs the study with its selection."""
        return shlex.join(["uv", "run", "-m", "bench", "run", *self.arguments])

    def resolved(self) -> Study:
        """Return the study with the selection; raise the errors of ``load_study`` and ``selected``."""
        return selected(load_study(self.study), self.selection)


_THREE_STACKS = ("four_stack", "card_house", "leaning_tower")
PUBLICATIONS: dict[str, Publication] = {
    "paper": Publication(
        "the paper's three stacks and two planar stacks, four engines, profile `game`, seed 0, without and with the "
        "extension",
        "paper",
        gallery=Gallery("bullet", "game", ("four_stack", "card_house-3", "leaning_tower")),
    ),
    "publish": Publication(
        "the same stacks with 20 seeds on six engines, profile `game`, without the extension and with `at_rest`, "
        "`paper` and `equilibrium`",
        "publish",
    ),
    "truth": Publication(
        "every scene with a known answer, most of them in pairs: profile `tuned` with every policy; profile `game` "
        "without the extension, with the engine's own sleeping and with `equilibrium`",
        "truth",
        Selection(
            engines=("bullet", "mujoco", "dart", "physx", "rapier", "box3d", "jolt", "havok", "ode"),
            profiles=("tuned", "game"),
        ),
    ),
    "any_stack": Publication(
        "stacks of public bug reports, and each at three times the size, profile `game`, nine 3-D engines, "
        "without the extension and with `equilibrium`",
        "any_stack",
        Selection(policies=("none", "equilibrium")),
        is_timed=False,
        gallery=Gallery(
            "bullet",
            "game",
            (
                "own_scene-issue_atonce10-0eb37ace",
                "own_scene-issue_box3d_tiny_pyramid-d397f3ed",
                "own_scene-issue_pallet-a191f233",
                "own_scene-issue_peel_mass_ratio_300-389a84e3",
            ),
        ),
    ),
    "at_once": Publication(
        "prebuilt stacks in pairs, `game` and `tuned`, five 3-D engines, without the extension and with `equilibrium`",
        "at_once",
        is_timed=False,
    ),
    "issues": Publication(
        "stacks of public threads: reported outcomes, outcomes on nine engines in `game`, and exact outcomes",
        "issues",
        is_timed=False,
    ),
    "heavy": Publication(
        "heavy on light: column, pyramid of 55 and off-centre pair on nine engines, at the origin and 100 m from it",
        "heavy",
        is_timed=False,
    ),
    "soak": Publication(
        "creep of stacks that must stand: 600 s on nine engines, `game` and `tuned`", "soak", is_timed=False
    ),
    "profiles": Publication(
        "the paper's scenes on ten engines alone, as shipped and as tuned",
        "paper",
        Selection(
            engines=("bullet", "mujoco", "dart", "physx", "rapier", "box3d", "jolt", "havok", "ode", "pymunk"),
            profiles=("default", "tuned"),
            policies=("none",),
        ),
        is_timed=False,
    ),
    "unity4": Publication(
        "the paper's stacks on an emulation of its engine, 30 seeds, without and with the extension", "unity4"
    ),
    "unity4_leaning": Publication(
        "flatter Vs and higher card houses on the emulation of the paper's engine, 10 seeds", "unity4_leaning"
    ),
    "claims": Publication(
        "the paper's three stacks on PhysX and Rapier, profile `game`, seed 0",
        "paper",
        Selection(engines=("physx", "rapier"), scenarios=_THREE_STACKS, policies=("none", "paper")),
    ),
    "cost": Publication(
        "levels that stood against milliseconds per frame: substeps and iterations of ten engines, with the figure",
        "cost",
    ),
    "thresholds": Publication(
        "each engine's own limits by bisection, in percent of the exact limits: friction, height over width, overhang, "
        "angle of an inverted V; profiles `game` and `tuned`, without the extension and with `equilibrium`",
        "thresholds",
        is_timed=False,
    ),
    "tilt": Publication(
        "ground that tilts at 0.1 deg/s below prebuilt stacks: the angle of the first motion against exact statics, "
        "profiles `game` and `tuned`, without the extension and with `equilibrium`",
        "tilt",
        is_timed=False,
    ),
    "sleep": Publication(
        "bricks at rest or slow that must move: the time for which engines (`native`, `raised`) and the extension let "
        "them sleep, every profile",
        "sleep",
        is_timed=False,
    ),
    "forces": Publication(
        "the contact forces that engines report, against what contacts allow: weight carried, friction cone and "
        "complementarity, every profile",
        "forces",
        is_timed=False,
    ),
    "scale": Publication("the effect of a world 10 or 100 times larger", "scale"),
    "related": Publication(
        "the reference engines `erleben` and `staggered` (related work of the paper) beside six products at one step a "
        "frame, without the extension: structured stacks, card houses, and stacks that must fall",
        "related",
        is_timed=False,
    ),
    "ratio": Publication(
        "frame time with the extension over frame time without it, 25 levels, nine engines, every profile",
        "ratio",
    ),
}
"""Publications, by the name of their folder."""
