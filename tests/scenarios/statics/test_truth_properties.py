"""What holds for every pile: symmetries that statics must not notice, and proofs that anyone can check."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.model import Brick, World
from scenarios.planks import LENGTH, THICKNESS, lay, lean
from scenarios.statics.contact_patch import GROUND
from scenarios.statics.truth import equilibrium

# -- piles -----------------------------------------------------------------------------------------------------------


@st.composite
def towers(draw):
    """Flat planks, each shifted and turned against the one below; about half of them stand."""
    bricks, x, y = [], 0.0, 0.0
    for level in range(1, draw(st.integers(2, 6)) + 1):
        bricks.append(lay(x, y, yaw=draw(st.floats(-math.pi, math.pi)), level=level))
        x, y = x + draw(st.floats(-0.02, 0.02)), y + draw(st.floats(-0.02, 0.02))
    return bricks


@st.composite
def roofed_vs(draw):
    """An inverted V, and a plank that lies on both its upper edges more or less evenly."""
    theta = draw(st.floats(0.9, 1.4))
    spread, top = LENGTH * math.cos(theta), LENGTH * math.sin(theta) + THICKNESS * math.cos(theta)
    pair = [lean(-spread, theta=theta, toward=1, level=1), lean(spread, theta=theta, toward=-1, level=1)]
    return [*pair, lay(draw(st.floats(-0.01, 0.01)), draw(st.floats(-5e-3, 5e-3)), level=2, bottom=top)]


@st.composite
def leans(draw):
    """A plank that leans over the upper edge of a block, or over its corner if the block is turned."""
    theta = draw(st.floats(0.3, 1.3))
    height = draw(st.floats(0.5, 0.95)) * LENGTH * math.sin(theta)
    yaw = draw(st.one_of(st.just(0.0), st.floats(-0.3, 0.3)))
    long, wide = 0.05, 0.005
    reach = (long * math.cos(yaw) + wide * math.sin(abs(yaw))) / 2
    (block,) = turned([Brick((long, wide, height), 0.05, (0.0, 0.0, height / 2))], yaw)
    return [
        lean(0.0, theta=theta, toward=1, level=1),
        replace(block, position=(height / math.tan(theta) + reach, 0.0, height / 2)),
    ]


piles = st.one_of(towers(), roofed_vs(), leans())
frictions = st.floats(0.05, 0.9)


def turned(bricks, yaw):
    """The bricks, turned about the z axis by ``yaw`` [rad]."""
    c, s = math.cos(yaw), math.sin(yaw)
    h, k = math.cos(yaw / 2), math.sin(yaw / 2)
    moved = []
    for brick in bricks:
        (x, y, z), (q0, q1, q2, q3) = brick.position, brick.quaternion
        quaternion = (h * q0 - k * q3, h * q1 - k * q2, h * q2 + k * q1, h * q3 + k * q0)
        moved.append(replace(brick, position=(c * x - s * y, s * x + c * y, z), quaternion=quaternion))
    return moved


def mirrored(bricks):
    """The bricks in a mirror that stands on the plane x = 0; a box is its own mirror image."""
    moved = []
    for brick in bricks:
        (x, y, z), (q0, q1, q2, q3) = brick.position, brick.quaternion
        moved.append(replace(brick, position=(-x, y, z), quaternion=(q0, q1, -q2, -q3)))
    return moved


def scaled(bricks, factor):
    """Every length times ``factor``, of the same wood."""
    return [
        replace(
            brick,
            size=tuple(factor * edge for edge in brick.size),
            mass=factor**3 * brick.mass,
            position=tuple(factor * x for x in brick.position),
        )
        for brick in bricks
    ]


# -- symmetries --------------------------------------------------------------------------------------------------------


@settings(max_examples=25)
@given(piles, frictions, st.floats(-math.pi, math.pi))
def test_turning_or_mirroring_the_whole_changes_nothing(bricks, friction, yaw):
    statics = equilibrium(bricks, World(friction))
    verdict = statics.verdict
    assert statics.balanced == (verdict != "unstable")
    assert equilibrium(turned(bricks, yaw), World(friction)).verdict == verdict
    assert equilibrium(mirrored(bricks), World(friction)).verdict == verdict


@settings(max_examples=25)
@given(piles, frictions, st.sampled_from([1 / 15, 1e3 / 7.8, 8e3 / 7.8]))
def test_planks_of_half_a_millimetre_or_of_eight_metres_behave_alike(bricks, friction, factor):
    here, there = (equilibrium(pile, World(friction)) for pile in (bricks, scaled(bricks, factor)))
    assert there.verdict == here.verdict
    assert there.residual == pytest.approx(here.residual, rel=1e-6, abs=1e-9)


@settings(max_examples=15)
@given(piles, frictions)
def test_neither_gravity_nor_density_matters(bricks, friction):
    heavy = [replace(brick, mass=20 * brick.mass) for brick in bricks]
    verdict = equilibrium(bricks, World(friction)).verdict
    assert equilibrium(heavy, World(friction, (0.0, 0.0, -1.62))).verdict == verdict


@pytest.mark.parametrize("yaw", [0.1, 0.3, 0.7])
@pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6])
def test_coulombs_cone_is_round(yaw, distance):
    """A V that is turned against the pyramids' first sides needs the friction that it needs unturned."""
    theta = 1.2
    least = (1 / math.tan(theta) - THICKNESS / LENGTH) / 2
    spread = LENGTH * math.cos(theta)
    pair = [lean(-spread, theta=theta, toward=1, level=1), lean(spread, theta=theta, toward=-1, level=1)]
    assert equilibrium(turned(pair, yaw), World(least * (1 + distance))).verdict == "stable"
    assert equilibrium(turned(pair, yaw), World(least * (1 - distance))).verdict == "unstable"


# -- proofs ------------------------------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(piles, frictions)
def test_every_verdict_comes_with_its_proof(bricks, friction):
    """Stable, or in doubt: forces inside Coulomb's cone that balance every brick. Unstable: a motion in which gravity
    does work and every contact opens by at least mu times its slip, so that no force Coulomb allows does less than
    none."""
    statics = equilibrium(bricks, World(friction))
    if statics.balanced:
        check_forces(bricks, statics, friction)
    else:
        assert statics.verdict == "unstable"
        check_motion(bricks, statics, friction)


def check_forces(bricks, statics, friction):
    pressure = np.einsum("pd,pd->p", statics.forces, statics.normals)
    friction_force = np.linalg.norm(statics.forces - pressure[:, None] * statics.normals, axis=1)
    weight = sum(brick.mass for brick in bricks) * 9.81
    assert (pressure >= -1e-9 * weight).all()
    assert (friction_force <= friction * pressure + 1e-9 * weight).all()
    for index, brick in enumerate(bricks):
        force, moment = np.array([0.0, 0.0, -9.81 * brick.mass]), np.zeros(3)
        for point, (first, second), on_second in zip(statics.points, statics.bodies, statics.forces, strict=True):
            sign = (second == index) - (first == index)
            force += sign * on_second
            moment += sign * np.cross(point - brick.position, on_second)
        assert np.abs(force).max() <= 1e-8 * weight
        assert np.abs(moment).max() <= 1e-8 * weight * LENGTH


def check_motion(bricks, statics, friction):
    length = np.mean([max(brick.size) for brick in bricks])
    falling = sum(brick.mass * -velocity[2] for brick, velocity in zip(bricks, statics.mechanism, strict=True))
    assert falling > 0
    for point, (first, second), normal in zip(statics.points, statics.bodies, statics.normals, strict=True):
        apart = np.zeros(3)
        for body, sign in ((first, -1), (second, 1)):
            if body != GROUND:
                linear, angular = np.split(statics.mechanism[body], 2)
                apart += sign * (linear + np.cross(angular, point - bricks[body].position) / length)
        opening = apart @ normal
        slip = np.linalg.norm(apart - opening * normal)
        assert opening - friction * slip >= -1e-7


def test_a_leaning_tower_falls_whole_from_its_lowest_plank():
    """The paper's collapse is too vertical; the mechanism turns all planks but the lowest about that one's edge."""
    planks = [lay(index * LENGTH / 8.5, level=index + 1) for index in range(9)]
    motion = equilibrium(planks, World()).mechanism
    assert motion[0] == pytest.approx(0, abs=1e-9)
    turning = motion[1:, 4]
    assert (turning > 0).all()
    assert turning == pytest.approx(turning[0])
