"""The forms of issues are well formed and name what exists."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from adapters import ENGINES
from scenarios.registry import SCENARIOS

FOLDER = Path(__file__).parent.parent / ".github" / "ISSUE_TEMPLATE"
FORMS = {path.stem: path for path in FOLDER.glob("*.yml") if path.stem != "config"}
TYPES = {"markdown", "input", "textarea", "dropdown", "checkboxes"}


def form(name: str) -> dict[str, Any]:
    loaded: dict[str, Any] = yaml.safe_load(FORMS[name].read_text(encoding="utf-8"))
    return loaded


def test_there_is_a_form_for_each_kind_of_issue() -> None:
    assert set(FORMS) == {"adapter_bug", "wrong_verdict", "new_scene", "new_engine"}


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_well_formed(name: str) -> None:
    content = form(name)
    assert {"name", "description", "title", "labels", "body"} == set(content)
    fields = [field for field in content["body"] if field["type"] != "markdown"]
    ids = [field["id"] for field in fields]
    assert len(set(ids)) == len(ids)
    assert all(field["type"] in TYPES for field in content["body"])
    assert all(field["attributes"]["label"] for field in fields)
    assert any(field.get("validations", {}).get("required") for field in fields)
    for field in fields:
        if field["type"] in {"dropdown", "checkboxes"}:
            assert len(field["attributes"]["options"]) > 1


def test_every_engine_can_be_chosen() -> None:
    [engine] = [field for field in form("adapter_bug")["body"] if field.get("id") == "engine"]
    assert engine["attributes"]["options"] == list(ENGINES)


@pytest.mark.parametrize("name", FORMS)
def test_commands_name_engines_and_scenes_that_exist(name: str) -> None:
    text = FORMS[name].read_text(encoding="utf-8")
    assert set(re.findall(r"--engine (\w+)", text)) <= set(ENGINES)
    assert set(re.findall(r"--scenario (\w+)(?!\w|\.toml)", text)) <= set(SCENARIOS)
