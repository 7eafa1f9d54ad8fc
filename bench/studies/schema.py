"""The schema of a study: engines, scenes, policies and the limits of a trial.

A study is a TOML file. The studies of the suite are in the folder of this module. The schema checks all names before
the run. An error names the file, the field and the fix.
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
"""Folder of the studies of the suite."""

Value: TypeAlias = StrictInt | StrictFloat | StrictStr
"""Value of a parameter of a scenario."""


class StudyError(ValueError):
    """An invalid study; the message names the file, the field and the fix."""


MOST_SEEDS = 100_000
"""Greatest number of seeds, because a greater number is a typing error, and the list of its trials would fill the
memory."""
MOST_REPEATS = 1_000
"""Greatest number of repeats, because a greater number is a typing error, and the list of its trials would fill the
memory."""
MOST_WATCH_S = 100 * 3600.0
"""Greatest time of a watch [s], because a longer time is a typing error."""


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
        raise ValueError(f"each entry must occur once, got {', '.join(twins)} more than once; remove the repetition")
    return names


EngineName = Annotated[str, _known("engine", ENGINES)]
PolicyName = Annotated[str, _known("policy", BENCH_POLICIES)]
ScenarioName = Annotated[str, _known("scenario", SCENARIOS)]
Distinct = AfterValidator(_without_twins)


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class ChosenScenario(_Model):
    """A scenario of a study, with its parameters; each combination of listed values gives a variant."""

    name: ScenarioName
    parameters: Mapping[str, Value | list[Value]] = {}
    tolerance: Tolerance = Tolerance()
    """Tolerance for comparisons of the scenario's trials with the trials of another run."""
    bisect: Bisect | None = None
    """Parameter whose threshold the study searches in every variant; None without a search."""

    def variants(self) -> Iterator[dict[str, Value]]:
        """Yield the parameters of every variant: all combinations of listed values, without the bisected parameter."""
        choices = [value if isinstance(value, list) else [value] for value in self.parameters.values()]
        for values in product(*choices):
            yield dict(zip(self.parameters, values, strict=True))

    def known_variants(self) -> Iterator[dict[str, Value]]:
        """Yield the parameters of every variant; a bisected parameter takes the values at both ends of its range."""
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
                    f"parameter '{name}' needs at least one value, got an empty list; add a value, or leave out the "
                    "parameter"
                )
        if self.bisect is not None and self.bisect.parameter in self.parameters:
            raise ValueError(
                f"parameter '{self.bisect.parameter}' must not be in 'parameters', because 'bisect' varies it: remove "
                "the parameter from 'parameters'"
            )
        for parameters in self.known_variants():
            try:
                build(self.name, **parameters)
            except (LookupError, TypeError) as error:
                raise ValueError(str(error)) from error
        return self


class Rule(_Model):
    """A condition by which a study includes or excludes trials.

    A rule matches a trial if every list that is not empty contains the trial's value: its engine, profile, policy or
    scenario.
    """

    engines: Annotated[list[EngineName], Distinct] = []
    profiles: Annotated[list[str], Distinct] = []
    policies: Annotated[list[PolicyName], Distinct] = []
    scenarios: Annotated[list[ScenarioName], Distinct] = []

    def matches(self, engine: str, profile: str, policy: str, scenario: str) -> bool:
        """Return whether the rule matches a trial with these names."""
        wanted = (self.engines, self.profiles, self.policies, self.scenarios)
        given = (engine, profile, policy, scenario)
        return all(value in names for value, names in zip(given, wanted, strict=True) if names)

    @model_validator(mode="after")
    def _says_something(self) -> Rule:
        if not (self.engines or self.profiles or self.policies or self.scenarios):
            raise ValueError(
                "a rule needs at least one field, got none; remove the rule, or add one of: "
                f"{', '.join(Rule.model_fields)}"
            )
        return self


class Sweep(_Model):
    """Variations of one profile of some engines: each combination of substeps and iterations."""

    engines: Annotated[list[EngineName], Distinct] = Field(min_length=1)
    profile: str = "game"
    substeps: Annotated[list[StrictInt], Distinct] = []
    """Numbers of engine steps per frame; empty for the profile's own number."""
    iterations: Annotated[list[StrictInt], Distinct] = []
    """Numbers of iterations of the engine's solver per step; empty for the profile's own number."""

    def profiles(self) -> list[str]:
        """Return the names of the varied profiles, or only the name of the profile itself without any values."""
        varied = {"substeps": self.substeps, "iterations": self.iterations}
        named = {what: values for what, values in varied.items() if values}
        return [varied_name(self.profile, dict(zip(named, values, strict=True))) for values in product(*named.values())]


class Limits(_Model):
    """Limits of a trial and of a standing stack."""

    trial_wall_s: float = Field(default=60.0, gt=0)
    """Wall time [s] after which a trial stops. The levels of a stopped trial are only lower bounds (censored)."""
    memory_mib: int = Field(default=4096, ge=1)
    """Resident memory [MiB] above which the harness ends a trial's process. The default is ample, because a hundred
    planks take about 300 MiB."""
    creep_per_min: float = Field(default=CREEP_LIMIT_PER_MIN, gt=0)
    """Greatest creep of a stack that must stand [thicknesses of a brick per minute]."""
    ratio: bool = True
    """True to time the baseline (all awake), the same stack without the extension, in trials with the extension."""
    forces: bool = False
    """True to audit the contact forces while a finished stack is watched, in trials of an engine alone."""


class Study(_Model):
    """Definition of a comparison of engines and policies."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$")
    description: str = ""
    engines: Annotated[list[EngineName], Distinct] = Field(min_length=1)
    profiles: Annotated[list[str], Distinct] = ["game"]
    """Profiles of every engine; the list may be empty if a sweep varies an engine of the study."""
    policies: Annotated[list[PolicyName], Distinct] = Field(min_length=1)
    scenario: list[ChosenScenario] = Field(min_length=1)
    seeds: int = Field(default=1, ge=1, le=MOST_SEEDS)
    """Number of seeds, which run from 0 to ``seeds - 1``; seed 0 has no placement noise."""
    repeats: int = Field(default=1, ge=1, le=MOST_REPEATS)
    """Number of repeats of each seed."""
    sweep: list[Sweep] = []
    """Variations of profiles; the study skips engines of a sweep that are not in ``engines``."""
    include: list[Rule] = []
    """Rules of which a trial must match at least one; empty to include all trials."""
    exclude: list[Rule] = []
    """Rules of which a trial must match none."""
    watch_s: float | None = Field(default=None, gt=0, le=MOST_WATCH_S)
    """Time for which every trial watches its scene after the last action [s]; None for the scene's own value."""
    limits: Limits = Limits()

    def has_same_plan(self, other: Study) -> bool:
        """Return whether both studies are equal except for the description."""
        return self.model_copy(update={"description": other.description}) == other

    def set_ups(self) -> list[tuple[str, str]]:
        """Return the distinct pairs of engine and profile, including the profiles of sweeps."""
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
        """Return whether the rules admit a trial with these names."""
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
            raise ValueError(
                "field 'profiles': must name at least one profile, because no sweep varies an engine of the study; "
                "add a profile"
            )
        if not admitted:
            raise ValueError(
                "the rules of 'include' and 'exclude' must admit at least one trial, but admit none; remove or widen "
                "a rule, or choose other engines, profiles, policies or scenarios"
            )
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
    """Return the names of the studies of the suite, sorted."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_study(name: str) -> Study:
    """Return the study of the suite named ``name``, or the study in the TOML file ``name``.

    Raises:
        UnknownNameError: if ``name`` is neither the name of a study nor ends with ``.toml``.
        StudyError: if the file is unreadable, or is not a valid study.
        EngineNotInstalledError: if the package of an engine of the study is missing.
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
        raise StudyError(f"{path}: cannot read this file ({error.strerror}); name a readable file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: not valid TOML: {error}; correct the file") from error
    return check_study(content, str(path))


def check_study(content: Mapping[str, object], source: str) -> Study:
    """Return the study with the given fields.

    Args:
        content: fields of the study, as in its TOML file.
        source: origin of the fields, for error messages.

    Raises:
        StudyError: for an invalid field or combination of fields; the message names the source and the fix.
        EngineNotInstalledError: if the package of an engine of the study is missing.
    """
    try:
        return Study.model_validate(content)
    except ValidationError as error:
        complaints = [_complaint(detail) for detail in error.errors(include_url=False)]
        raise StudyError("\n".join(f"{source}: {complaint}" for complaint in dict.fromkeys(complaints))) from error


def _complaint(detail: Mapping[str, Any]) -> str:
    location = detail["loc"]
    if location[2:3] == ("parameters",) and len(location) > 4:  # pydantic reports an error for each type of the union
        got = f"got {detail['input']!r:.80}: correct this value"
        return f"field '{field_name(location[:4])}': must be a number, a text, or a list of numbers or texts, {got}"
    field = field_name(location)
    if detail["type"] == "extra_forbidden":
        owner = _PARTS.get(str(location[0]), Study) if len(location) > 1 else Study
        owner = _SCENARIO_PARTS.get(str(location[2]), owner) if len(location) > 3 else owner
        return str(unknown_name("field", field.rpartition(".")[2], owner.model_fields))
    return f"field '{field}': {plain_words(detail)}" if field else plain_words(detail)
