"""Thresholds by bisection: the limit of a stack on an engine, and the limit by exact statics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

from reports.records.trial import Status, TrialRecord
from reports.statistics.groups import groups_of
from scenarios.bisection import Bisection, Bracket
from scenarios.parameters import Value
from scenarios.registry import build, with_defaults
from scenarios.statics.contact_patch import Ridge
from scenarios.statics.truth import UndecidedError, first_fall

EXACT_SHARE = 0.02
"""Tolerance of the bisection by exact statics over the tolerance of the bisection on the engine. The ratio is small, so
that the error of the exact limit is negligible."""


def stood(status: Status) -> bool | None:
    """Return whether the stack of a trial with this status stood; None for a status that does not decide."""
    return {"completed": True, "collapsed": False}.get(status)


@dataclass(frozen=True, slots=True)
class Threshold:
    """The limit of one stack on one engine and profile under one policy, over all seeds."""

    scene: str
    """Name of the scenario, and the parameters that the study sets."""
    parameter: str
    """Name of the bisected parameter."""
    engine: str
    profile: str
    policy: str
    brackets: tuple[Bracket, ...]
    """Brackets of the limit, one per seed and repeat. A bracket is the interval of the parameter in which the outcome
    changes between standing and falling."""
    exact: tuple[float | None, float | None]
    """Limits by exact statics with either convention for the normal of a ridge (where two leaning planks meet): first
    the bisector, then a face normal. None if unknown."""

    @property
    def whole(self) -> Bracket | None:
        """Bracket that encloses the brackets of all seeds; None unless each seed has a threshold."""
        if not all(bracket.is_found for bracket in self.brackets):
            return None
        low, high = min(one.low for one in self.brackets), max(one.high for one in self.brackets)
        return self.brackets[0]._replace(low=low, high=high)

    @property
    def why(self) -> str:
        """Reason for a missing threshold as text; empty if there is a threshold."""
        reasons = ["not finished" if one.next else one.why for one in self.brackets if not one.is_found]
        count = f" ({len(reasons)} of {len(self.brackets)} seeds)" if len(self.brackets) > 1 else ""
        return f"{reasons[0]}{count}" if reasons else ""


def bisected_scenarios(study: Mapping[str, Any]) -> set[str]:
    """Return the names of the scenarios of a study that have a bisected parameter."""
    return {chosen["name"] for chosen in study.get("scenario", ()) if "bisect" in chosen}


def of_fixed_scenes(records: Sequence[TrialRecord], study: Mapping[str, Any]) -> list[TrialRecord]:
    """Return the records of scenarios without a bisected parameter, because one step of a bisection is not a result."""
    bisected = bisected_scenarios(study)
    return [record for record in records if record.scenario not in bisected]


def thresholds_of(records: Sequence[TrialRecord], study: Mapping[str, Any]) -> list[Threshold]:
    """Return the thresholds of a study, in the order of its scenarios; empty without a bisected parameter.

    Args:
        records: records of the study's trials.
        study: content of the study file in the results folder.
    """
    in_order = [record for group in groups_of(records) for record in group.trials]
    found = []
    for chosen in study.get("scenario", ()):
        if "bisect" in chosen:
            found += _of_scenario(chosen, [record for record in in_order if record.scenario == chosen["name"]])
    return found


def _of_scenario(chosen: Mapping[str, Any], records: Sequence[TrialRecord]) -> list[Threshold]:
    bisect, fixed = chosen["bisect"], chosen.get("parameters", {})
    search = Bisection(float(bisect["low"]), float(bisect["high"]), float(bisect["tolerance"]))
    found = []
    for values in product(*(value if isinstance(value, list) else [value] for value in fixed.values())):
        variant = dict(zip(fixed, values, strict=True))
        name = ", ".join([chosen["name"], *(f"{name} {value}" for name, value in variant.items())])
        found += _of_variant(name, variant, bisect["parameter"], search, records)
    return found


def _of_variant(
    scene: str, variant: Mapping[str, Value], parameter: str, search: Bisection, records: Sequence[TrialRecord]
) -> list[Threshold]:
    """Return the thresholds of one variant; parameters that the study does not set have their defaults."""
    scenario = scene.partition(",")[0]
    rest = with_defaults(scenario, variant)
    del rest[parameter]
    answers: dict[tuple[str, str, str], dict[tuple[int, int], dict[float, bool | None]]] = {}
    for record in records:
        parameters = with_defaults(scenario, record.parameters)
        value = float(parameters.pop(parameter))
        if parameters == rest:
            by_seed = answers.setdefault((record.engine, record.profile, record.policy), {})
            by_seed.setdefault((record.seed, record.repeat), {})[value] = stood(record.status)
    exact = exact_limits(scenario, tuple(rest.items()), parameter, search)
    return [
        Threshold(scene, parameter, *set_up, tuple(search.bracket(one) for one in by_seed.values()), exact)
        for set_up, by_seed in answers.items()
    ]


@lru_cache(maxsize=256)
def exact_limits(
    scenario: str, rest: tuple[tuple[str, Value], ...], parameter: str, search: Bisection
) -> tuple[float | None, float | None]:
    """Return the limits that a bisection with exact statics finds, for both conventions for the normal of a ridge.

    The first limit is for the bisector, the second is for a face normal. A scene in doubt counts as fallen. A limit is
    None in two cases:

    - the answer is the same at both ends of the search;
    - exact statics cannot judge a scene; see ``first_fall``.

    Args:
        scenario: name of the scenario.
        rest: parameters of the scenario without the bisected parameter.
        parameter: name of the bisected parameter.
        search: search on the engine. The search by exact statics has the same ends, and ``EXACT_SHARE`` times the
            tolerance.
    """

    def limit(ridge: Ridge) -> float | None:
        def stands(value: float) -> bool:
            scene = build(scenario, **{**dict(rest), parameter: value})
            try:
                return first_fall(scene, ridge=ridge) is None
            except UndecidedError:
                return False

        try:
            bracket = Bisection(search.low, search.high, EXACT_SHARE * search.tolerance).search(stands)
        except ValueError:  # exact statics cannot judge the scene
            return None
        return bracket.middle if bracket.is_found else None

    return limit("bisector"), limit("face")
