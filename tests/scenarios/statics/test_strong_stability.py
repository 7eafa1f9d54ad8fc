"""Strong stability: is rest the only thing that rigid bodies can do?"""

import math

import numpy as np
import pytest

from scenarios.model import Brick
from scenarios.planks import LENGTH, THICKNESS, lay
from scenarios.registry import build
from scenarios.statics.force_balance import solve_balance
from scenarios.statics.loading import load_from_zero
from scenarios.statics.strong_stability import strong_stability
from tests.scenarios.statics.masonry import (
    TABLE,
    arch,
    balls,
    inverted_v,
    jammed_rod,
    logs,
    of_bricks,
    overhang,
    tight_courses,
)


def strength(pile, **options):
    return strong_stability(*pile, **options).verdict


def pile_of_scene(name, **parameters):
    scene = build(name, **parameters)
    pile = of_bricks(scene.bricks, scene.world.friction)
    return pile._replace(weights=np.outer([brick.mass for brick in scene.bricks], scene.world.gravity))


@pytest.mark.parametrize("neighbour", [0.1, 10.0])
@pytest.mark.parametrize(("beyond", "verdict"), [(-1e-3, "strong"), (1e-3, "weak"), (5e-3, "weak"), (10e-3, "weak")])
def test_a_brick_that_overhangs_beside_a_neighbour_may_fall(beyond, verdict, neighbour):
    """Forces that hold it exist in all four cases."""
    assert strength(of_bricks(overhang(beyond, neighbour=neighbour), 0.45, walls=[TABLE])) == verdict


@pytest.mark.parametrize("friction", [0.2, 0.45])
def test_a_brick_between_walls_may_fall(friction):
    walls = [Brick((0.1, 0.1, 0.4), 1.0, (x, 0.0, 0.2)) for x in (-0.1, 0.1)]
    block = Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.2))
    found = strong_stability(*of_bricks([block], friction, walls=walls))
    assert found.verdict == "weak"
    assert found.fall == pytest.approx(1)


def test_a_rod_between_walls_may_fall():
    rod, walls = jammed_rod(17)
    assert strength(of_bricks([rod], 0.45, walls=walls)) == "weak"


@pytest.mark.parametrize("degrees", [60, 72])
def test_a_v_is_strong_above_its_least_friction(degrees):
    theta = math.radians(degrees)
    least = (1 / math.tan(theta) - THICKNESS / LENGTH) / 2
    for factor, verdict in ((0.9, "weak"), (0.99, "weak"), (1.01, "strong"), (1.5, "strong"), (3.0, "strong")):
        assert strength(of_bricks(inverted_v(theta), factor * least)) == verdict, factor


@pytest.mark.parametrize("held_by", [2, 3, 4])
@pytest.mark.parametrize(("margin", "verdict"), [(0.15, "strong"), (0.05, "strong"), (-0.05, "weak"), (-0.15, "weak")])
def test_a_plank_at_a_wall_is_strong_above_its_least_friction(held_by, margin, verdict):
    """Halves of walls and tiles lie behind each other, and are solved as one in the plane."""
    found = strong_stability(*pile_of_scene("wall_plank", held_by=held_by, margin=margin))
    assert found.verdict == verdict
    assert found.choices <= 18


@pytest.mark.parametrize(("margin", "verdict"), [(0.05, "strong"), (-0.05, "weak")])
def test_a_tile_on_a_ramp_is_strong_above_its_least_friction(margin, verdict):
    assert strength(pile_of_scene("incline", margin=margin)) == verdict


def test_a_card_house_of_two_storeys_is_strong():
    assert strength(pile_of_scene("card_house", storeys=2)) == "strong"


def test_logs_in_two_rows_are_strong_and_in_three_may_roll_apart():
    """Rolling needs no more friction than 0.3: it is a solution at any, beside rest."""
    assert strength(logs(2, 0.05, 0.28)) == "weak"
    assert strength(logs(2, 0.05, 0.5)) == "strong"
    assert strength(logs(3, 0.05, 0.8)) == "weak"
    assert load_from_zero(*logs(3, 0.05, 0.8)).verdict == "stands"


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "verdict"), [(0.3, "weak"), (0.5, "strong")])
def test_balls_are_solved_in_space(friction, verdict):
    assert strength(balls(0.02, friction)) == verdict


@pytest.mark.slow
def test_a_small_arch_is_strong():
    assert strength(arch(5, 0.12, 0.45), seconds=300) == "strong"


def test_what_takes_too_long_is_in_doubt():
    assert strength(arch(11, 0.12, 0.45), seconds=1) == "doubt"


def test_what_pressure_alone_holds_is_strong():
    """Proof: if normal forces p >= 0 balance the weights, w . a = -p . J_n a <= 0 for every a that does not overlap."""
    for shifts in ((0, 0.2, 0.4), (0.0, 0.3, 0.1), (0, -0.2, 0.25)):
        pile = of_bricks([lay(shift * LENGTH, level=level) for level, shift in enumerate(shifts, start=1)], 0.45)
        assert solve_balance(*pile).frictionless
        assert strength(pile) == "strong"


def test_what_falls_when_loaded_is_never_strong():
    """A theorem: the acceleration that is left is a solution. Tight courses of two to four bricks on their pedestal."""
    asked = 0
    for seed in range(400):
        if asked == 15:
            break
        bricks = tight_courses(np.random.default_rng([11, seed]))
        if len(bricks) > 5:
            continue
        pile = of_bricks(bricks, 0.45)
        balance = solve_balance(*pile)
        if balance.balanced and not balance.frictionless:
            loading = load_from_zero(*pile)
            if loading.verdict == "falls" and loading.acceleration > 0.05:
                asked += 1
                assert strength(pile, seconds=20) == "weak", seed
    assert asked == 15
