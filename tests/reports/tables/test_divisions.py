"""Divisions: scenes on which profiles were tuned, and scenes held out."""

import re

from adapters import ENGINES, profiles
from adapters.profile import AS_SHIPPED
from reports.tables.divisions import division_tables
from scenarios.divisions import TUNED_ON, is_held_out
from scenarios.registry import SCENARIOS
from tests.reports.studies import FALLS, failed, record

WORDS = {
    "4-stack": "four_stack",
    "inverted V": "card_house",
    "card house": "card_house",
    "leaning tower": "leaning_tower",
    "columns": "plank_tower",
    "ladders of planks": "four_stack",
}


def test_every_scene_that_a_profile_names_is_marked():
    assert set(TUNED_ON) <= set(SCENARIOS)
    for engine in ("bullet", "mujoco", "dart", "physx", "rapier", "box3d", "pymunk"):
        assert engine in ENGINES
        for profile in profiles(engine).values():
            scenes = profile.tuned_by.partition(", on ")[2]
            if profile.tuned_by == AS_SHIPPED or not scenes:
                continue
            named = [re.sub("^the ", "", one) for one in re.split(", | and ", scenes)]
            assert {WORDS[name] for name in named} <= set(TUNED_ON), profile.tuned_by


def test_both_scores_stand_side_by_side():
    records = [
        record(scene="four_stack-3", scenario="four_stack"),
        record(scene="brick_wall", scenario="brick_wall", pair="x"),
        record(scene="brick_wall-2", scenario="brick_wall", pair="x", expectation=FALLS, verdict="false_stand"),
        failed("timeout", scene="table", scenario="table"),
        record(scene="four_stack-3", scenario="four_stack", policy="paper", verdict="creeps"),
    ]
    (table,) = division_tables(records)
    assert table.rows == (
        ("bullet", "game", "none", "1/1", "100", "1/2", "50", "-", "0/1"),
        ("bullet", "game", "paper", "0/1", "0", "-", "-", "-", "-"),
    )


def test_a_study_of_one_division_has_no_such_table():
    assert division_tables([record(scenario="four_stack")]) == []
    assert division_tables([record(scenario="table")]) == []
    assert is_held_out("table")
    assert not is_held_out("card_house")
