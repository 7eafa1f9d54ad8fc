"""The limits of the scenes that are bisected: by closed form, and by bisection of exact statics."""

import math

import pytest

from scenarios.bisection import Bisection
from scenarios.planks import LENGTH, THICKNESS
from scenarios.registry import build
from scenarios.statics.truth import first_fall

SLOPE = math.tan(math.radians(20.0))
BISECTOR = math.degrees(math.atan(1 / (2 * 0.3 + THICKNESS / LENGTH)))
FACE = 90.0 - math.degrees(math.atan(0.3))


@pytest.mark.parametrize(
    ("scenario", "parameters", "parameter", "closed_form", "ridge"),
    [
        ("slope", {"theta": 20.0}, "friction", SLOPE, "bisector"),
        ("slope", {"theta": 20.0, "friction": 0.6}, "ratio", 1 / SLOPE, "bisector"),
        ("overhang", {}, "reach", 0.5, "bisector"),
        ("leaning_pair", {"friction": 0.3}, "theta", BISECTOR, "bisector"),
        ("leaning_pair", {"friction": 0.3}, "theta", FACE, "face"),
    ],
)
def test_closed_form_and_exact_statics_have_the_same_limit(scenario, parameters, parameter, closed_form, ridge) -> None:
    def stands(value: float) -> bool:
        return first_fall(build(scenario, **parameters, **{parameter: value}), ridge=ridge) is None

    search = Bisection(0.97 * closed_form, 1.02 * closed_form, 1e-3 * closed_form)
    found = search.search(stands)
    assert found.is_found
    assert found.low <= closed_form * (1 + 1e-9)
    assert closed_form <= found.high * (1 + 1e-9)


@pytest.mark.parametrize(
    ("scenario", "parameters", "outcome"),
    [
        ("slope", {"friction": 0.39}, "stand"),
        ("slope", {"friction": 0.34}, "fall"),
        ("slope", {"ratio": 2.6}, "stand"),
        ("slope", {"ratio": 2.95}, "fall"),
        ("slope", {"friction": 0.37}, "study"),
        ("overhang", {"reach": 0.47}, "stand"),
        ("overhang", {"reach": 0.53}, "fall"),
        ("leaning_pair", {"theta": 50.0}, "fall"),
        ("leaning_pair", {"theta": 65.0}, "study"),
        ("leaning_pair", {"theta": 80.0}, "stand"),
    ],
)
def test_an_answer_is_claimed_off_the_limit_and_statics_agrees(scenario, parameters, outcome) -> None:
    scene = build(scenario, **parameters)
    assert scene.expectation.outcome == outcome
    if outcome != "study":
        assert first_fall(scene) == first_fall(scene, ridge="face") == scene.expectation.level
