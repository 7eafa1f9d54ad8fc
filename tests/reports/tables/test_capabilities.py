"""The table of what the engines show comes from a run's own environment."""

import json

from reports.records.folder import ResultsFolder
from reports.tables.capabilities import capability_table, capability_tables

ENGINES = {
    "one": {"version": "1.2", "capabilities": {"contact_points": "up to 4", "near_contacts": False, "planar": True}},
    "two": {"version": "3.4", "capabilities": {"contact_points": "1", "near_contacts": True, "planar": False}},
    "three": {"version": "1", "capabilities": {"planar": False, "reference": True}},
}


def test_engines_stand_side_by_side_as_they_describe_themselves(tmp_path) -> None:
    (tmp_path / "environment.json").write_text(json.dumps({"engines": ENGINES}))
    table = capability_table(ResultsFolder(tmp_path).engines)
    assert table.header == ("", "one", "two", "three")
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["version"] == ("1.2", "3.4", "1")
    assert rows["plays"] == ("planar scenes", "all scenes", "all scenes")
    assert rows["points that nearly touch"] == ("added by geometry", "listed", "-")
    assert rows["kind"] == ("-", "-", "reference engine")
    assert rows["contact forces"] == ("-", "-", "-"), "what an older run did not record is left open"


def test_joints_have_a_row_only_where_an_engine_has_joints() -> None:
    assert "joins bodies by" not in {row[0] for row in capability_table(ENGINES).rows}
    joining = {"version": "1", "capabilities": {"weld": "a joint"}}
    without = {"version": "1", "capabilities": {"weld": None}}
    rows = {row[0]: row[1:] for row in capability_table({**ENGINES, "four": joining, "five": without}).rows}
    assert rows["joins bodies by"] == ("-", "-", "-", "a joint", "-")


def test_a_folder_names_its_reference_engines(tmp_path) -> None:
    (tmp_path / "environment.json").write_text(json.dumps({"engines": ENGINES}))
    assert ResultsFolder(tmp_path).reference_engines == {"three"}


def test_a_folder_without_an_environment_has_no_engines(tmp_path) -> None:
    assert ResultsFolder(tmp_path).engines == {}
    assert capability_tables(ResultsFolder(tmp_path).engines) == []
