"""The limits of the tilt test: by closed form, and by bisection of exact statics."""

import numpy as np
import pytest

from bench.trial.own_contacts import PRECISION, limit_slope
from reports.tables.tilt import slope_at
from scenarios.model import Place, World
from scenarios.planks import MU
from scenarios.registry import build
from scenarios.scenes.tilt_test import AXES, tilt_limits, tilted_bricks
from scenarios.statics.contact_patch import contact_patches

DOWN_BACK = (0.0, -1.0)
"""The low end at -x: the face that the judge takes as a ridge's normal then belongs to the other plank."""


def by_the_judge(stack: str, axis: tuple[float, float], ridge: str) -> float:
    bricks = tilted_bricks(stack)
    centers = np.array([brick.position for brick in bricks])
    found = limit_slope(bricks, World(friction=MU), axis, contact_patches(bricks, ridge=ridge), centers)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("stack", "heading", "known"),
    [
        ("column", "along", 24.228),
        ("column", "across", 16.699),
        ("v", "along", 2.117),
        ("v", "across", 11.631),
        pytest.param("card_house", "along", 2.117, marks=pytest.mark.slow),
        pytest.param("card_house", "across", 4.714, marks=pytest.mark.slow),
    ],
)
def test_closed_form_and_exact_statics_have_the_same_limit(stack: str, heading: str, known: float) -> None:
    exact = tilt_limits(stack, heading).exact
    assert exact == pytest.approx(known, abs=5e-4)
    assert by_the_judge(stack, AXES[heading], "bisector") == pytest.approx(exact, abs=PRECISION)


def test_with_a_face_as_the_ridges_normal_the_limit_depends_on_whose() -> None:
    limits = tilt_limits("v", "along")
    assert limits.least < limits.exact < limits.greatest
    assert by_the_judge("v", AXES["along"], "face") == pytest.approx(limits.greatest, abs=PRECISION)
    assert by_the_judge("v", DOWN_BACK, "face") == pytest.approx(limits.least, abs=PRECISION)


@pytest.mark.parametrize("stack", ["column", "v", "card_house"])
@pytest.mark.parametrize("heading", AXES)
def test_gravity_turns_slowly_past_every_limit(stack: str, heading: str) -> None:
    scene, limits = build("tilt_test", stack=stack, heading=heading), tilt_limits(stack, heading)
    times = np.arange(0.0, scene.done_s, 0.01)
    slopes = np.array([slope_at(scene, time) for time in times])
    slow = (slopes[:-1] > max(0.0, limits.least - 1.0)) & (slopes[1:] < limits.greatest + 1.0)
    assert np.diff(slopes)[slow] == pytest.approx(0.1 * 0.01)
    assert slopes[-1] > limits.greatest + 5.9
    first, *tilts = scene.actions
    assert isinstance(first, Place)
    assert [tilt.until for tilt in tilts[:-1]] == pytest.approx([tilt.time for tilt in tilts[1:]])
