"""Scenarios by name: ids, parameters, and errors that name the fix."""

from itertools import product

import pytest

from scenarios.lookup import UnknownNameError, one_of
from scenarios.registry import SCENARIOS, build


@pytest.mark.parametrize("name", SCENARIOS)
def test_defaults_make_the_plain_id_and_are_recorded(name):
    scene = build(name)
    assert (scene.scenario, scene.variant) == (name, name)
    assert scene.parameters == SCENARIOS[name].parameters
    assert SCENARIOS[name].description.endswith(".")


@pytest.mark.parametrize(
    ("name", "parameters", "variant"),
    [
        ("card_house", {"storeys": 2}, "card_house-2"),
        ("card_house", {"theta": 75, "storeys": 2}, "card_house-2-theta75"),
        ("card_house", {"friction": 0.3}, "card_house-friction0.3"),
        ("leaning_tower", {"ratio": 10}, "leaning_tower-10"),
        ("leaning_tower", {"levels": 10}, "leaning_tower-levels10"),
        ("leaning_tower", {"ratio": 8.5, "levels": 13}, "leaning_tower"),
        ("four_stack", {"levels": 3.0}, "four_stack-3"),
    ],
)
def test_the_id_names_what_differs_from_the_defaults(name, parameters, variant):
    assert build(name, **parameters).variant == variant


def test_no_two_variants_share_an_id():
    choices = product([1, 2, 3], [70, 72.0, 72.5, 75, 80], [0.1, 0.45, 0.7, 1, 1.5])
    houses = [build("card_house", storeys=n, theta=theta, friction=mu) for n, theta, mu in choices]
    assert len({house.variant for house in houses}) == len(houses)


def test_an_unknown_scenario_names_its_nearest_match():
    with pytest.raises(UnknownNameError, match="unknown scenario 'card_huose'; did you mean 'card_house'"):
        build("card_huose")


def test_an_unknown_parameter_names_its_nearest_match():
    with pytest.raises(UnknownNameError, match="unknown parameter of four_stack 'level'; did you mean 'levels'"):
        build("four_stack", level=3)


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        (
            "four_stack",
            {"levels": 0},
            "levels must be a whole number from 1 to 200, got 0: give a number in this range",
        ),
        ("four_stack", {"levels": 2.5}, "levels must be a whole number"),
        ("four_stack", {"levels": True}, "levels must be a whole number"),
        ("four_stack", {"levels": "3"}, "levels must be a whole number"),
        ("plank_tower", {"levels": float("nan")}, "levels must be a whole number"),
        ("leaning_tower", {"ratio": float("nan")}, "ratio must be a number from 1.1 to 1000, got nan"),
        ("leaning_tower", {"ratio": -8.5}, "ratio must be a number"),
        ("leaning_tower", {"ratio": float("inf")}, "ratio must be a number"),
        ("brick_wall", {"width": 1}, "width must be a whole number from 2"),
        ("card_house", {"storeys": 11}, "storeys must be a whole number from 1 to 10"),
        ("card_house", {"storeys": 2, "theta": 65}, "theta is too flat for more than one storey, got 65"),
        ("table", {"legs": 5}, "legs must be a whole number from 2 to 4"),
        ("incline", {"margin": 0.6}, "margin must be a number from -0.5 to 0.5"),
        ("jenga", {"left": "midle"}, "left must be middle or side, got 'midle': give one"),
        ("cantilever", {"taken": "load", "margin": -0.3}, "margin must be positive with taken = 'load', got -0.3"),
        ("corbelled_arch", {"margin": -0.4}, "margin must be above -0.124"),
        ("card_house", {"friction": -0.1}, "friction must be a number"),
    ],
)
def test_a_value_that_makes_no_scene_names_what_is_allowed(name, parameters, message):
    with pytest.raises(ValueError, match=f"scenario {name}: {message}"):
        build(name, **parameters)


@pytest.mark.parametrize(
    ("names", "text"),
    [("", "no name, because none exists"), ("a", "a"), ("ab", "a or b"), ("abc", "one of a, b or c")],
)
def test_a_choice_reads_well_for_any_number_of_names(names: str, text: str) -> None:
    assert one_of(names) == text
