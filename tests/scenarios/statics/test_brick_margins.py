"""Margins of bricks against closed forms: lever arms of a leaning tower, and angles of slopes, blocks and stacks."""

import math

import numpy as np
import pytest

from scenarios.model import Brick, World
from scenarios.planks import GRAVITY, LENGTH, MASS, MU, THICKNESS, WIDTH, box, lay
from scenarios.registry import build
from scenarios.statics.brick_margins import BrickMargins, brick_margins
from scenarios.statics.contact_patch import contact_patches

WEIGHT = MASS * GRAVITY
EXACT = 1e-6
"""Relative tolerance: the solver's is 1e-10, and contact patches are exact to rounding."""


def margins_of(bricks, world: World | None = None) -> BrickMargins:
    world = World(friction=MU) if world is None else world
    centers = np.array([brick.position for brick in bricks])
    weights = np.outer([brick.mass for brick in bricks], world.gravity)
    return brick_margins(centers, weights, contact_patches(bricks, world.fixed), world.friction, LENGTH)


def tower(levels: int, offset: float) -> list[Brick]:
    return [lay(level * offset, level=level + 1) for level in range(levels)]


@pytest.mark.parametrize("levels", [3, 5, 8])
def test_the_load_of_a_leaning_tower_is_that_of_the_lever_at_its_weakest_edge(levels: int) -> None:
    """Over the edge e of each plank below brick k: s (x_k - e) = sum of W (e - x_m) over the planks m above it."""
    offset = LENGTH / 8.5
    x = offset * np.arange(levels)
    expected = []
    for brick in range(levels):
        limits = [np.inf]
        for below in range(-1, brick):  # -1: the lowest plank turns over its own edge on the ground
            edge, above = (x[below] if below >= 0 else x[0]) + LENGTH / 2, x[below + 1 :]
            if x[brick] > edge:
                limits.append(WEIGHT * (edge - above).sum() / (x[brick] - edge))
        expected.append(min(limits))
    load = margins_of(tower(levels, offset)).load_n
    assert np.isfinite(load).sum() == sum(brick * offset > LENGTH / 2 for brick in range(levels))
    assert load == pytest.approx(expected, rel=EXACT)


@pytest.mark.parametrize("theta", [0.0, 10.0, 20.0])
def test_a_block_on_a_slope_bears_the_tilt_that_friction_leaves(theta: float) -> None:
    """The tilt margin is atan(mu) - theta downhill; the weight has no lever, as the block is flat."""
    lean = math.radians(theta)
    world = World(friction=0.6, gravity=(GRAVITY * math.sin(lean), 0.0, -GRAVITY * math.cos(lean)))
    [tilt] = margins_of([box((0.04, 0.04, 0.008), 0.0, level=1)], world).tilt_deg
    assert tilt == pytest.approx(math.degrees(math.atan(0.6)) - theta, rel=EXACT)


def test_a_slim_block_tips_before_it_slides() -> None:
    """A block of width b and height h tips at atan(b / h), about the edge nearest to its centre."""
    [tilt] = margins_of([box((0.05, 0.02, 0.1), 0.0, level=1)]).tilt_deg
    assert tilt == pytest.approx(math.degrees(math.atan(0.02 / 0.1)), rel=EXACT)


def test_the_four_stack_bears_any_load_and_tilts_as_far_as_its_friction() -> None:
    """Every plank's centre lies over planks on both sides, down to the ground, and two levels are too flat to tip."""
    bricks = build("four_stack", levels=2).bricks
    margins = margins_of(bricks)
    assert np.isinf(margins.load_n).all()
    assert margins.tilt_deg == pytest.approx(math.degrees(math.atan(MU)), rel=EXACT)


def test_a_brick_in_the_air_has_no_margin_and_leaves_those_of_the_others_as_they_are() -> None:
    plank, other = lay(0.0, level=1), lay(1.0, level=1)
    flying = lay(0.0, level=5)
    alone, together = margins_of([plank, other]), margins_of([plank, other, flying])
    assert (together.load_n[2], together.tilt_deg[2]) == (0.0, 0.0)
    assert together.tilt_deg[:2] == pytest.approx(alone.tilt_deg)
    assert np.isinf(together.load_n[:2]).all()


def test_a_tower_that_must_fall_has_no_margin_above_its_lowest_plank() -> None:
    margins = margins_of(tower(9, LENGTH / 8.5))
    assert margins.load_n == pytest.approx([np.inf] + [0.0] * 8)
    assert margins.tilt_deg == pytest.approx([math.degrees(math.atan(MU))] + [0.0] * 8)


def test_bricks_of_two_stacks_have_the_tilt_of_their_own_stack() -> None:
    """A column of n planks tips across its width at atan(WIDTH / (n THICKNESS)), if that is below atan(mu)."""
    high = [lay(0.0, level=level) for level in range(1, 9)]
    margins = margins_of([*high, lay(1.0, level=1)]).tilt_deg
    assert margins[:8] == pytest.approx(math.degrees(math.atan(WIDTH / (8 * THICKNESS))), rel=EXACT)
    assert margins[8] == pytest.approx(math.degrees(math.atan(MU)), rel=EXACT)


def test_a_margin_is_where_equilibrium_ends() -> None:
    """A weight of 0.999 times the margin can be added to the top plank, one of 1.001 times cannot."""
    *below, top = tower(8, LENGTH / 8.5)
    load = margins_of([*below, top]).load_n[-1]
    for factor, stands in ((0.999, True), (1.001, False)):
        heavier = Brick(top.size, top.mass + factor * load / GRAVITY, top.position, top.quaternion, top.level)
        assert bool(margins_of([*below, heavier]).tilt_deg[-1] > 0) is stands
