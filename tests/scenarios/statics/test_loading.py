"""Loading from zero: which forces arise, and which only could."""

import math
from itertools import pairwise

import numpy as np
import pytest

from scenarios.model import Brick
from scenarios.planks import LENGTH, THICKNESS
from scenarios.statics.contact_patch import GROUND, Patch
from scenarios.statics.force_balance import solve_balance
from scenarios.statics.loading import MOST_SAG, load_from_zero
from tests.scenarios.statics.masonry import (
    BRICK,
    TABLE,
    arch,
    balls,
    inverted_v,
    jammed_rod,
    load_at_the_tip,
    logs,
    of_bricks,
    on_table,
    overhang,
    tight_courses,
)

WALLS = [Brick((0.1, 0.1, 0.4), 1.0, (x, 0.0, 0.2)) for x in (-0.1, 0.1)]


def loaded(pile):
    return load_from_zero(*pile).verdict


def has_forces(pile):
    """Whether forces in the Coulomb cones balance the weights."""
    return solve_balance(*pile).balanced


# -- a brick that overhangs, beside a neighbour ------------------------------------------------------------------------


@pytest.mark.parametrize(("beyond", "friction"), [(1, 0.45), (3, 0.45), (5, 0.45), (10, 0.45), (10, 0.8), (30, 0.8)])
def test_a_brick_that_overhangs_falls_though_its_neighbours_side_could_hold_it(beyond, friction):
    """It holds up to mu^2 L / 2 in theory: 10.1 mm at 0.45 and 32 mm at 0.8. As it turns its end moves away."""
    pile = of_bricks(overhang(beyond * 1e-3), friction, walls=[TABLE])
    assert has_forces(pile)
    assert loaded(pile) == "falls"


def test_it_stands_on_the_other_side_of_the_edge():
    assert loaded(of_bricks(overhang(-1e-3), 0.45, walls=[TABLE])) == "stands"


@pytest.mark.parametrize("neighbour", [0.01, 0.1, 1.0, 100.0])
def test_the_weight_of_the_neighbour_does_not_matter(neighbour):
    pile = of_bricks(overhang(1e-3, neighbour=neighbour), 0.45, walls=[TABLE])
    assert loaded(pile) == "falls"


def test_a_load_on_the_tip_does_not_help():
    pile = of_bricks([*overhang(5e-3), load_at_the_tip(5e-3, 1e-3)], 0.45, walls=[TABLE])
    assert has_forces(pile)
    assert loaded(pile) == "falls"


def test_a_v_elsewhere_does_not_help():
    """The V presses as it loads, and says nothing about the brick."""
    standing = inverted_v(math.radians(72), x=1.0)
    assert loaded(of_bricks(standing, 0.45)) == "stands"
    assert loaded(of_bricks([*standing, *overhang(5e-3)], 0.45, walls=[TABLE])) == "falls"


@pytest.mark.parametrize("neighbour", [0.1, 10.0, 100.0])
@pytest.mark.parametrize("tilt", [1e-3, -1e-3, 1e-4, -1e-4])
def test_a_normal_that_is_off_by_a_thousandth_does_not_help(tilt, neighbour):
    """A face that leans over the brick's end by 0.06 deg stops it in theory, once it has moved 1,000 times as far."""
    pile = of_bricks(overhang(5e-3, neighbour=neighbour), 0.45, walls=[TABLE], tilt=tilt)
    assert has_forces(pile)
    loading = load_from_zero(*pile)
    assert loading.verdict != "stands"
    assert loading.sag > 3 * MOST_SAG


@pytest.mark.parametrize("outer", [0.1, 0.5, 5.0])
def test_a_brick_is_held_by_a_neighbour_into_which_it_turns(outer):
    """A block on a pillar of its own: the brick turns outward and presses on it, which holds unless it is too light."""
    beyond = 5e-3
    pillar = Brick((0.09, 0.06, 0.1), 1.0, (beyond + BRICK[0], 0.0, 0.05))
    block = Brick(BRICK, outer, (beyond + BRICK[0], 0.0, 0.1 + BRICK[2] / 2))
    brick = on_table(beyond)
    assert loaded(of_bricks([brick, block], 0.45, walls=[TABLE, pillar])) == "stands"
    light = Brick(BRICK, 0.01, block.position)
    assert loaded(of_bricks([brick, light], 0.45, walls=[TABLE, pillar])) == "falls"


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.45, 2.0])
def test_a_brick_between_walls_falls_at_any_friction(friction):
    block = Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.2))
    pile = of_bricks([block], friction, walls=WALLS)
    assert has_forces(pile) == (friction > 0)
    loading = load_from_zero(*pile)
    assert loading.verdict == "falls"
    assert loading.acceleration == pytest.approx(1)


@pytest.mark.parametrize("degrees", [10, 17, 24])
def test_a_rod_between_walls_holds_only_if_it_is_hammered_in(degrees):
    """Friction of 0.45 carries up to 24.2 deg."""
    rod, walls = jammed_rod(degrees)
    pile = of_bricks([rod], 0.45, walls=walls)
    assert has_forces(pile)
    assert loaded(pile) == "falls"


# -- what leans, and stands --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [60, 72])
def test_a_v_stands_and_falls_on_either_side_of_its_limit(degrees):
    theta = math.radians(degrees)
    least = (1 / math.tan(theta) - THICKNESS / LENGTH) / 2
    for factor, verdict in ((1.0001, "stands"), (1.05, "stands"), (4.0, "stands"), (0.999, "falls"), (0.9, "falls")):
        assert loaded(of_bricks(inverted_v(theta), factor * least)) == verdict, factor


@pytest.mark.parametrize(
    ("thickness", "friction", "verdict"),
    [
        *((0.105, mu, "falls") for mu in (0.3, 0.32, 0.35, 0.45)),
        *((0.12, mu, "falls") for mu in (0.3, 0.32, 0.35)),  # too thin for so little friction: it slides
        *((0.12, mu, "stands") for mu in (0.45, 0.8)),
        *((0.2, mu, "stands") for mu in (0.32, 0.35, 0.45)),
        (0.2, 0.3, "falls"),
    ],
)
def test_an_arch_of_15_voussoirs_stands_if_forces_exist(thickness, friction, verdict):
    pile = arch(15, thickness, friction)
    assert has_forces(pile) == (verdict == "stands")
    assert loaded(pile) == verdict


def test_an_arch_stands_to_within_a_thousandth_of_its_limit():
    """Couplet and Heyman: t / R >= 0.107426 with many voussoirs; 50 fall just short of 0.1075."""
    assert loaded(arch(50, 0.1075, 0.45)) == "stands"
    assert loaded(arch(50, 0.1074, 0.45)) != "stands"


@pytest.mark.slow
def test_an_arch_of_200_voussoirs_stands_to_within_a_thousandth_of_its_limit():
    loading = load_from_zero(*arch(200, 0.1075, 0.45))
    assert loading.verdict == "stands"
    assert 30 < loading.sag < 70  # hinges collect what 200 joints give: a limit of the sag must leave room for that
    assert loaded(arch(200, 0.1074, 0.45)) != "stands"


ROLLING = {
    "logs of 2 rows": (lambda mu: logs(2, 0.05, mu)),
    "logs of 3 rows": (lambda mu: logs(3, 0.05, mu)),
    "logs of 3 rows, apart": (lambda mu: logs(3, 0.2, mu)),
    "logs of 4 rows": (lambda mu: logs(4, 0.05, mu)),
    "balls": (lambda mu: balls(0.02, mu)),
    "balls apart": (lambda mu: balls(0.3, mu)),
    "arch": (lambda mu: arch(15, 0.15, mu)),
}
ORDER = {"falls": 0, "doubt": 1, "stands": 2}


@pytest.mark.parametrize("name", ROLLING)
def test_more_friction_never_makes_it_fall(name):
    verdicts = [loaded(ROLLING[name](friction)) for friction in (0.05, 0.28, 0.35, 0.5, 0.8, 2.0)]
    assert all(ORDER[less] <= ORDER[more] for less, more in pairwise(verdicts)), verdicts
    assert {verdicts[0], verdicts[-1]} == {"falls", "stands"}


# -- what forces without friction hold, and what nothing holds ---------------------------------------------------------


@pytest.mark.parametrize("height", [1, 10, 60])
def test_a_tower_stands_however_far_it_sinks(height):
    """The topmost brick sinks by n^2 / 2 times its own compression, and is at rest on the one below."""
    tower = [Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.05 + 0.1 * level)) for level in range(height)]
    loading = load_from_zero(*of_bricks(tower, 0.45))
    assert loading.verdict == "stands"
    assert loading.sag == pytest.approx(1)


def test_one_falling_brick_is_seen_beside_a_tower_that_sinks():
    tower = [Brick((0.1, 0.1, 0.1), 1.0, (1.0, 0.0, 0.05 + 0.1 * level)) for level in range(30)]
    assert loaded(of_bricks([*tower, *overhang(1e-3)], 0.45, walls=[TABLE])) != "stands"


def test_a_brick_in_the_air_falls():
    loading = load_from_zero(np.zeros((1, 3)), np.array([[0.0, 0.0, -1.0]]), [], 0.45, 1.0)
    assert (loading.verdict, loading.sag) == ("falls", math.inf)
    assert loading.acceleration == pytest.approx(1)


def test_no_unit_matters():
    """Lengths times 1e3, weights times 1e-3: the same sag, the same acceleration."""
    centers, weights, patches, friction, length = of_bricks(overhang(1e-3), 0.45, walls=[TABLE])
    large = [patch._replace(points=1e3 * patch.points) for patch in patches]
    here = load_from_zero(centers, weights, patches, friction, length)
    there = load_from_zero(1e3 * centers, 1e-3 * weights, large, friction, 1e3 * length)
    assert there.acceleration == pytest.approx(here.acceleration, rel=1e-6)


def test_inertia_does_not_matter_for_what_stands():
    pile = of_bricks(inverted_v(math.radians(60)), 0.3)
    light = load_from_zero(*pile, gyration=1e-8 * np.tile(np.eye(3), (2, 1, 1)))
    assert light.verdict == loaded(pile) == "stands"
    assert light.sag == pytest.approx(load_from_zero(*pile).sag, rel=1e-3)


def test_a_pile_slides_alike_in_all_directions():
    """A block on an incline, gravity tilted: it holds up to atan(mu) whichever way the slope points."""
    square = np.array([[x, y, 0.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    patch = Patch(GROUND, 0, square, np.array([0.0, 0.0, 1.0]))
    for heading in (0.0, 0.3, 0.7):
        for factor, verdict in ((0.999, "stands"), (1.001, "falls")):
            slope = factor * 0.45
            weight = np.array([[slope * math.cos(heading), slope * math.sin(heading), -1.0]])
            assert load_from_zero(np.array([[0.0, 0.0, 0.1]]), weight, [patch], 0.45, 1.0).verdict == verdict


@pytest.mark.slow
def test_random_tight_courses_fall_unless_their_sides_are_pressed():
    """200 of seeds [11, n]: 110 need no side and stand, 90 could be held by sides, of which 3 or less stand."""
    verdicts = {True: [], False: []}
    for seed in range(200):
        pile = of_bricks(tight_courses(np.random.default_rng([11, seed])), 0.45)
        balance = solve_balance(*pile)
        if balance.balanced:
            verdicts[balance.frictionless].append(loaded(pile))
    assert set(verdicts[True]) == {"stands"}
    assert verdicts[False].count("stands") <= 3
    assert len(verdicts[False]) > 20
