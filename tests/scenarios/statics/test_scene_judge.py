"""The judge's answer about a scene: verdict, margins and proof, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from scenarios.model import Brick, Expectation, Place, Remove, Scene, World
from scenarios.planks import LENGTH, MASS, THICKNESS, WIDTH, lay
from scenarios.registry import build
from scenarios.statics import judge
from scenarios.statics.contact_patch import GROUND

G = 9.81


def scene_of(*actions, friction=0.45, fixed=()):
    return Scene("mine", "mine", {}, World(friction=friction, fixed=fixed), actions, Expectation("study", ""), "")


def test_margins_of_one_plank():
    """It tips about its long edge at atan(width / thickness), slides at atan(mu), and bears any load."""
    answer = judge(scene_of(Place(0.0, (lay(0.0, level=1),))))
    assert answer.verdict == "stands"
    assert answer.margins.load_n.tolist() == [math.inf]
    assert answer.margins.tilt_deg == pytest.approx([math.degrees(math.atan(0.45))], abs=0.4)  # a pyramid of 16 sides
    assert answer.margins.friction == 0.0
    (force,) = answer.forces
    assert (force.first, force.second) == (GROUND, 0)
    assert force.force == pytest.approx((0, 0, MASS * G))


def test_the_load_margin_of_an_overhang():
    """The top of three planks: its load turns both upper planks about the end of the lowest one."""
    step = 0.3 * LENGTH
    answer = judge(scene_of(*(Place(t, (lay(t * step, level=t + 1),)) for t in range(3))))
    # About the end of the lowest plank, at L / 2: the two upper ones at 0.3 L and 0.6 L.
    margin = MASS * G * ((0.5 - 0.3) - (0.6 - 0.5)) / (0.6 - 0.5)
    assert answer.margins.load_n[2] == pytest.approx(margin, rel=1e-6)
    assert answer.state.level == 3


def test_the_friction_margin_of_a_slope():
    tilted = replace(scene_of(Place(0.0, (lay(0.0, level=1),))), world=World(0.45, (G * 0.28, 0.0, -G * 0.96)))
    answer = judge(tilted)
    assert answer.verdict == "stands"
    assert answer.margins.friction == pytest.approx(0.28 / 0.96, rel=2e-3)
    assert max(force.friction_used for force in answer.forces) == pytest.approx(0.28 / 0.96, rel=1e-6)


def test_a_scene_that_falls_has_its_mechanism_and_its_time():
    overhanging = Brick((LENGTH, WIDTH, THICKNESS), MASS, (0.7 * LENGTH, 0.0, 1.5 * THICKNESS), level=2)
    answer = judge(scene_of(Place(0.0, (lay(0.0, level=1),)), Place(1.0, (overhanging,))))
    assert (answer.verdict, answer.state.time, answer.margins, answer.forces) == ("falls", 1.0, None, ())
    assert np.abs(answer.mechanism[0]).max() < 1e-6  # the lower plank stays
    assert answer.mechanism[1, 4] > 0.1  # the upper one turns about +y, over its edge at +x


def test_a_removal_is_judged():
    answer = judge(scene_of(Place(0.0, (lay(0.0, level=1),)), Place(1.0, (lay(0.0, level=2),)), Remove(3.0, 0)))
    assert (answer.verdict, answer.state.time, answer.state.present) == ("falls", 3.0, (1,))


def test_doubt_names_its_reason():
    assert "convention" in judge(build("card_house", storeys=1, friction=0.2)).why
    assert "has the action Push" in judge(build("pushed_plank")).why
