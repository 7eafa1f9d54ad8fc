"""The judge's verdicts: which criterion decides, and what stays in doubt."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from scenarios.model import Expectation, Place, Scene, World
from scenarios.planks import LENGTH, THICKNESS, lay
from scenarios.statics.loading import load_from_zero
from scenarios.statics.truth import LESS_FRICTION, UndecidedError, equilibrium, first_fall, judge
from tests.scenarios.statics.masonry import (
    TABLE,
    arch,
    balls,
    inverted_v,
    jammed_rod,
    load_at_the_tip,
    logs,
    of_bricks,
    overhang,
    tight_courses,
)


def judged(pile):
    statics = judge(*pile)
    return statics.verdict, statics.by


# -- what decides ------------------------------------------------------------------------------------------------------


def test_normal_forces_decide_first():
    assert judged(of_bricks([lay(0.0, level=1), lay(0.3 * LENGTH, level=2)], 0.45)) == ("stable", "normal forces")
    assert judged(of_bricks(overhang(-1e-3), 0.45, walls=[TABLE])) == ("stable", "normal forces")


def test_vertical_forces_decide_on_a_slope():
    slope = math.radians(20)
    world = World(0.45, (9.81 * math.sin(slope), 0.0, -9.81 * math.cos(slope)))
    statics = equilibrium([lay(0.0, level=1), lay(0.3 * LENGTH, level=2)], world)
    assert (statics.verdict, statics.by, statics.frictionless) == ("stable", "vertical forces", False)
    assert np.cross(statics.forces, world.gravity) == pytest.approx(0, abs=1e-12)


def test_loading_decides_on_what_leans():
    assert judged(of_bricks(inverted_v(math.radians(72)), 0.45)) == ("stable", "loading")
    assert judged(arch(15, 0.12, 0.45)) == ("stable", "loading")
    assert judged(balls(0.02, 0.5)) == ("stable", "loading")


def test_the_cone_decides_on_what_must_fall():
    assert judged(of_bricks([lay(0.0, level=1), lay(0.6 * LENGTH, level=2)], 0.45)) == ("unstable", "cone")
    assert judged(arch(15, 0.105, 0.45)) == ("unstable", "cone")


# -- forces that exist and do not arise --------------------------------------------------------------------------------


@pytest.mark.parametrize(("beyond", "friction"), [(1, 0.45), (3, 0.45), (5, 0.45), (10, 0.45), (10, 0.8), (30, 0.8)])
@pytest.mark.parametrize("side", [1, -1])
def test_the_side_of_a_neighbour_holds_nothing(beyond, friction, side):
    """Nor does it in the mirror."""
    bricks = [
        replace(brick, position=(side * brick.position[0], *brick.position[1:])) for brick in overhang(beyond * 1e-3)
    ]
    table = replace(TABLE, position=(side * TABLE.position[0], *TABLE.position[1:]))
    statics = equilibrium(bricks, World(friction), walls=[table])
    assert (statics.verdict, statics.by, statics.balanced) == ("doubt", "loading", True)
    assert statics.why.startswith("needs prestress")
    assert not statics.stable


def test_nor_with_a_load_at_the_tip_or_a_v_elsewhere():
    bricks = overhang(5e-3)
    for more in ([load_at_the_tip(5e-3, 1e-3)], inverted_v(math.radians(72), x=1.0)):
        assert equilibrium([*bricks, *more], World(), walls=[TABLE]).verdict == "doubt"


@pytest.mark.parametrize("tilt", [1e-3, -1e-3, 1e-4, -1e-4])
def test_nor_with_a_normal_that_is_off_by_a_thousandth(tilt):
    assert judged(of_bricks(overhang(5e-3), 0.45, walls=[TABLE], tilt=tilt)) == ("doubt", "loading")


@pytest.mark.parametrize("degrees", [10, 17, 24])
def test_a_jammed_rod_is_in_doubt(degrees):
    rod, walls = jammed_rod(degrees)
    assert equilibrium([rod], World(), walls=walls).verdict == "doubt"


def test_a_scene_with_a_state_in_doubt_has_no_known_answer():
    pedestal = replace(TABLE, mass=100.0)
    brick, neighbour = overhang(5e-3)
    actions = (Place(0.0, (pedestal,)), Place(1.0, (neighbour,)), Place(2.0, (brick,)))
    scene = Scene("side", "side", {}, World(), actions, Expectation("study", ""), "")
    with pytest.raises(
        UndecidedError, match=r"side: .* in doubt after 3 placed bricks .needs prestress: loaded from zero, it"
    ):
        first_fall(scene)


def test_what_stands_only_with_all_its_friction_is_in_doubt():
    """Logs in three rows: forces exist from 0.46 on, but those that arise hold them only from 0.57 on."""
    statics = judge(*logs(3, 0.05, 0.6))
    assert statics.verdict == "doubt"
    assert statics.why.startswith(f"needs prestress with {LESS_FRICTION * 0.6:.3g} of friction")
    assert judged(logs(3, 0.05, 0.8)) == ("stable", "loading")


# -- limits ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [60, 72])
def test_where_no_forces_exist_with_less_friction_the_limit_is_sharp(degrees):
    """A V at its limit would fall with nine tenths of the friction, and that is no sign of prestress."""
    theta = math.radians(degrees)
    least = (1 / math.tan(theta) - THICKNESS / LENGTH) / 2
    assert judged(of_bricks(inverted_v(theta), 1.0001 * least)) == ("stable", "loading")
    assert judged(of_bricks(inverted_v(theta), 0.9999 * least)) == ("unstable", "cone")


ORDER = {"unstable": 0, "doubt": 1, "stable": 2}
PILES = {
    "balls": lambda mu: balls(0.02, mu),
    "balls apart": lambda mu: balls(0.3, mu),
    "logs of 2 rows": lambda mu: logs(2, 0.05, mu),
    "logs of 2 rows, apart": lambda mu: logs(2, 0.2, mu),
    "logs of 3 rows": lambda mu: logs(3, 0.05, mu),
    "arch": lambda mu: arch(15, 0.15, mu),
    "flat arch": lambda mu: arch(9, 0.2, mu, embrace=90.0),
}


@pytest.mark.parametrize("name", PILES)
def test_more_friction_never_turns_stable_into_doubt(name):
    verdicts = [judge(*PILES[name](friction)).verdict for friction in (0.1, 0.25, 0.35, 0.5, 0.8, 2.0)]
    assert all(ORDER[less] <= ORDER[more] for less, more in pairwise(verdicts)), verdicts
    assert verdicts[-1] == "stable"


@pytest.mark.slow
@pytest.mark.parametrize("name", PILES)
def test_nor_does_it_at_any_friction(name):
    verdicts = [judge(*PILES[name](friction)).verdict for friction in np.arange(0.05, 2.05, 0.05)]
    assert all(ORDER[less] <= ORDER[more] for less, more in pairwise(verdicts)), verdicts


@pytest.mark.slow
def test_what_vertical_forces_hold_comes_to_rest_when_loaded():
    """No theorem, hence a trial: tight courses on slopes of up to nine tenths of the friction."""
    asked = 0
    for seed in range(150):
        random = np.random.default_rng([13, seed])
        pile = of_bricks(tight_courses(random), 0.45)
        slope = 0.45 * random.uniform(0.1, 0.9)
        tilted = pile._replace(weights=pile.weights + np.abs(pile.weights[:, 2:]) * [slope, 0.0, 0.0])
        if judge(*tilted).by == "vertical forces":
            asked += 1
            assert load_from_zero(*tilted).verdict == "stands", seed
    assert asked > 30
