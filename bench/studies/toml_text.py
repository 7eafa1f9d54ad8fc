"""Conversion of a resolved study to TOML, for a results folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from bench.studies.schema import Study
from bench.studies.tolerance import Tolerance


def to_toml(study: Study) -> str:
    """Return the study as TOML, without fields that are None, empty lists of rules, and default tolerances.

    ``json`` writes the values, because JSON's strings, numbers and flat lists are valid TOML.
    """
    content = study.model_dump()
    scenarios, limits = content.pop("scenario"), content.pop("limits")
    rules = {kind: content.pop(kind) for kind in ("sweep", "include", "exclude")}
    lines = [*_assignments(content), "", "[limits]", *_assignments(limits)]
    for kind, those in rules.items():
        for rule in those:
            lines += ["", f"[[{kind}]]", *_assignments({field: names for field, names in rule.items() if names})]
    for scenario in scenarios:
        lines += ["", "[[scenario]]", f"name = {json.dumps(scenario['name'])}"]
        if scenario["parameters"]:
            lines += ["", "[scenario.parameters]", *_assignments(scenario["parameters"])]
        if allowed := _set_tolerances(scenario["tolerance"]):
            lines += ["", "[scenario.tolerance]", *_assignments(allowed)]
        if scenario["bisect"] is not None:
            lines += ["", "[scenario.bisect]", *_assignments(scenario["bisect"])]
    return "\n".join(lines) + "\n"


def _set_tolerances(tolerance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tolerances that differ from their defaults."""
    usual = Tolerance().model_dump()
    return {name: value for name, value in tolerance.items() if value != usual[name]}


def _assignments(fields: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in fields.items() if value is not None]
