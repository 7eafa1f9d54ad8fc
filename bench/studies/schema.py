"""Studies: engines, scenes, policies and the limits of a trial.

A study is a TOML file; the studies beside this file are known by their names. Every name is checked before anything
runs, and an error names the file, the field and its allowed values.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StrictFloat,
    StrictInt,
    StrictStr,
    ValidationError,
    model_validator,
)

from adapters import ENGINES, ProfileError, profile_named
from adapters.profile_variants import varied_name
from bench.studies.bisect import Bisect
from bench.studies.errors import field_name, plain_words
from bench.studies.policies import BENCH_POLICIES
from bench.studies.tolerance import Tolerance
from reports.records.creep import CREEP_LIMIT_PER_MIN
from scenarios.lookup import UnknownNameError, look_up, unknown_name
from scenarios.registry import SCENARIOS, build

FOLDER = Path(__file__).parent

Value: TypeAlias = StrictInt | StrictFloat | StrictStr


class StudyError(ValueError):
    """A study that cannot be run; the message names the file, the field and the fix."""


MOST_SEEDS = 100_000
MOST_REPEATS = 1_000
MOST_WATCH_S = 100 * 3600.0
"""Upper limits of a plan: a larger number is a typing error, and the plan alone would fill the memory."""


def _known(kind: str, table: Mapping[str, object]) -> AfterValidator:
    def check(name: str) -> str:
        try:
            look_up(kind, name, table)
        except UnknownNameError as error:
            raise ValueError(str(error)) from error
        return name

    return AfterValidator(check)


def _without_twins(names: list[str]) -> list[str]:
    twins = sorted({name for name in names if names.count(name) > 1})
    if twins:
        raise ValueError(f"named twice: {', '.join(twins)}")
    return names


EngineName = Annotated[str, _known("engine", ENGINES)]
PolicyName = Annotated[str, _known("policy", BENCH_POLICIES)]
ScenarioName = Annotated[str, _known("scenario", SCENARIOS)]
Distinct = AfterValidator(_without_twins)


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class ChosenScenario(_Model):
    """A scenario of a study, with its parameters; a list of values makes a variant of each."""

    name: ScenarioName
    parameters: Mapping[str, Value | list[Value]] = {}
    tolerance: Tolerance = Tolerance()
    """Tolerance of its trials when runs are compared."""
    bisect: Bisect | None = None
    """A parameter whose threshold is searched in every variant: each trial follows from those before."""

    def variants(self) -> Iterator[dict[str, Value]]:
        """Yield the parameters of every variant, without the bisected one: all combinations of the listed values."""
        choices = [value if isinstance(value, list) else [value] for value in self.parameters.values()]
        for values in product(*choices):
            yield dict(zip(self.parameters, values, strict=True))

    def known_variants(self) -> Iterator[dict[str, Value]]:
        """Yield the parameters of the variants that are known beforehand: of a bisected one both ends."""
        for parameters in self.variants():
            if self.bisect is None:
                yield parameters
            else:
                yield from ({**parameters, self.bisect.parameter: end} for end in (self.bisect.low, self.bisect.high))

    @model_validator(mode="after")
    def _can_be_built(self) -> ChosenScenario:
        for name, value in self.parameters.items():
            if value == []:
                raise ValueError(
                    f"parameter '{name}': an empty list leaves no variant; name a value or leave the parameter out"
                )
        if self.bisect is not None and self.bisect.parameter in self.parameters:
            raise ValueError(f"parameter '{self.bisect.parameter}' is bisected: take it out of 'parameters'")
        for parameters in self.known_variants():
            try:
                build(self.name, **parameters)
            except (LookupError, TypeError) as error:
                raise ValueError(str(error)) from error
        return self


class Rule(_Model):
    """A rule for trials: it matches if every given field matches."""

    engines: Annotated[list[EngineName], Distinct] = []
    profiles: Annotated[list[str], Distinct] = []
    policies: Annotated[list[PolicyName], Distinct] = []
    scenarios: Annotated[list[ScenarioName], Distinct] = []

    def matches(self, engine: str, profile: str, policy: str, scenario: str) -> bool:
        """Return whether the rule matches such a trial."""
        wanted = (self.engines, self.profiles, self.policies, self.scenarios)
        given = (engine, profile, policy, scenario)
        return all(value in names for value, names in zip(given, wanted, strict=True) if names)

    @model_validator(mode="after")
    def _says_something(self) -> Rule:
        if not (self.engines or self.profiles or self.policies or self.scenarios):
            raise ValueError(f"a rule names at least one of: {', '.join(Rule.model_fields)}")
        return self


class Sweep(_Model):
    """One profile of some engines with each combination of substeps and iterations: ``adapters.profile_variants``."""

    engines: Annotated[list[EngineName], Distinct] = Field(min_length=1)
    profile: str = "game"
    substeps: Annotated[list[StrictInt], Distinct] = []
    """Engine steps per frame; empty: the profile's."""
    iterations: Annotated[list[StrictInt], Distinct] = []
    """Iterations of the engine's solver per step; empty: the profile's."""

    def profiles(self) -> list[str]:
        """Return the names of the varied profiles."""
        varied = {"substeps": self.substeps, "iterations": self.iterations}
        named = {what: values for what, values in varied.items() if values}
        return [varied_name(self.profile, dict(zip(named, values, strict=True))) for values in product(*named.values())]


class Limits(_Model):
    """Limits of a trial and of a standing stack."""

    trial_wall_s: float = Field(default=60.0, gt=0)
    """Wall time [s] after which a trial stops and is censored."""
    memory_mib: int = Field(default=4096, ge=1)
    """Memory [MiB] above which a trial's process is ended. A trial of a hundred planks uses about 300 MiB."""
    creep_per_min: float = Field(default=CREEP_LIMIT_PER_MIN, gt=0)
    """Greatest creep of a stack that must stand, in thicknesses of a brick per minute."""
    ratio: bool = True
    """True if trials with an extension also measure the frame time without it on the same stack."""
    forces: bool = False
    """True if trials of an engine alone read its contact forces while a finished stack is watched, and compare them
    with the forces that contacts can exert."""


class Study(_Model):
    """A plan for comparing engines and policies."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$")
    description: str = ""
    engines: Annotated[list[EngineName], Distinct] = Field(min_length=1)
    profiles: Annotated[list[str], Distinct] = ["game"]
    """Profiles of every engine; may be empty if there is a sweep."""
    policies: Annotated[list[PolicyName], Distinct] = Field(min_length=1)
    scenario: list[ChosenScenario] = Field(min_length=1)
    seeds: int = Field(default=1, ge=1, le=MOST_SEEDS)
    """Number of seeds: 0 to ``seeds - 1`` are run; seed 0 builds exactly."""
    repeats: int = Field(default=1, ge=1, le=MOST_REPEATS)
    sweep: list[Sweep] = []
    """Further profiles of the engines that each names, as far as the study has these engines."""
    include: list[Rule] = []
    """If not empty, only trials are run that match at least one rule."""
    exclude: list[Rule] = []
    """Trials that match one of these rules are not run."""
    watch_s: float | None = Field(default=None, gt=0, le=MOST_WATCH_S)
    """Time [s] for which every trial watches after its last action; None: the scene's."""
    limits: Limits = Limits()

    def has_same_plan(self, other: Study) -> bool:
        """Return whether both studies plan the same trials: the description is prose."""
        return self.model_copy(update={"description": other.description}) == other

    def set_ups(self) -> list[tuple[str, str]]:
        """Return every engine with each of its profiles, once."""
        plain = [(engine, profile) for profile in self.profiles for engine in self.engines]
        swept = [
            (engine, profile)
            for sweep in self.sweep
            for engine in sweep.engines
            if engine in self.engines
            for profile in sweep.profiles()
        ]
        return list(dict.fromkeys(plain + swept))

    def admits(self, engine: str, profile: str, policy: str, scenario: str) -> bool:
        """Return whether the rules admit such a trial."""
        named = (engine, profile, policy, scenario)
        included = not self.include or any(rule.matches(*named) for rule in self.include)
        return included and not any(rule.matches(*named) for rule in self.exclude)

    @model_validator(mode="after")
    def _variants_come_once(self) -> Study:
        names = [build(one.name, **parameters).variant for one in self.scenario for parameters in one.known_variants()]
        _without_twins(names)
        return self

    @model_validator(mode="after")
    def _engines_have_the_profiles(self) -> Study:
        scenarios = [chosen.name for chosen in self.scenario]
        admitted = [
            (engine, profile, policy, scenario)
            for (engine, profile), policy, scenario in product(self.set_ups(), self.policies, scenarios)
            if self.admits(engine, profile, policy, scenario)
        ]
        if not self.set_ups():
            raise ValueError("field 'profiles': must not be empty without a sweep of one of the engines")
        if not admitted:
            raise ValueError("the rules of 'include' and 'exclude' leave no trial; remove or widen one")
        for engine, profile in dict.fromkeys((engine, profile) for engine, profile, _, _ in admitted):
            try:
                profile_named(engine, profile)
            except (UnknownNameError, ProfileError) as error:
                raise ValueError(str(error)) from error
        return self


_PARTS: Mapping[str, type[BaseModel]] = {
    "limits": Limits,
    "scenario": ChosenScenario,
    "sweep": Sweep,
    "include": Rule,
    "exclude": Rule,
}
_SCENARIO_PARTS: Mapping[str, type[BaseModel]] = {"tolerance": Tolerance, "bisect": Bisect}


def study_names() -> list[str]:
    """Return the names of the studies of the suite."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_study(name: str) -> Study:
    """Return the study of the suite with this name, or of the TOML file ``name``.

    Raises:
        UnknownNameError: if neither exists.
        StudyError: if the file is no valid study.
        EngineNotInstalledError: if the package of one of its engines is missing.
    """
    if name in study_names():
        path = FOLDER / f"{name}.toml"
    elif name.endswith(".toml"):
        path = Path(name)
    else:
        raise unknown_name("study", name, [*study_names(), "or a file FILE.toml"])
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: not valid TOML: {error}") from error
    return check_study(content, str(path))


def check_study(content: Mapping[str, object], source: str) -> Study:
    """Return a study from its fields; ``source`` names their origin in errors.

    Raises:
        StudyError: for an invalid field; the message names the source, the field and its allowed values.
        EngineNotInstalledError: if the package of one of its engines is missing.
    """
    try:
        return Study.model_validate(content)
    except ValidationError as error:
        complaints = [_complaint(detail) for detail in error.errors(include_url=False)]
        raise StudyError("\n".join(f"{source}: {complaint}" for complaint in dict.fromkeys(complaints))) from error


def _complaint(detail: Mapping[str, Any]) -> str:
    location = detail["loc"]
    if location[2:3] == ("parameters",) and len(location) > 4:  # a union has one error for each of its members
        return f"field '{field_name(location[:4])}': must be a number, a text, or a list of these"
    field = field_name(location)
    if detail["type"] == "extra_forbidden":
        owner = _PARTS.get(str(location[0]), Study) if len(location) > 1 else Study
        owner = _SCENARIO_PARTS.get(str(location[2]), owner) if len(location) > 3 else owner
        return str(unknown_name("field", field.rpartition(".")[2], owner.model_fields))
    return f"field '{field}': {plain_words(detail)}" if field else plain_words(detail)
