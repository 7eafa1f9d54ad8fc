"""How long a fall takes: the general formula against closed forms, an integrated equation of motion, and scaling."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from scipy.integrate import solve_ivp

from scenarios.model import Brick, World
from scenarios.planks import box
from scenarios.registry import build
from scenarios.scenes.shared.transforms import transformed
from scenarios.statics.falling import SLIDE_LIMIT, TILT_LIMIT, fall_time

G = 9.81


def block_beyond_an_edge(offset: float) -> tuple[list[Brick], World]:
    """A cube of 0.2 m whose middle lies ``offset`` [m] beyond the edge of a fixed table."""
    table = box((1.0, 1.0, 0.5), -0.5, level=1)
    cube = box((0.2, 0.2, 0.2), offset, level=1, bottom=0.5, mass=3.0)
    return [cube], World(friction=1.0, fixed=(table,))


@pytest.mark.parametrize("offset", [0.002, 0.01, 0.03])
def test_a_block_tips_about_an_edge_as_its_closed_form_says(offset):
    """t = acosh(1 + phi h / e) / s with s^2 = g h / (I / m); the block slides over no edge."""
    half = 0.1
    inertia = (0.2**2 + 0.2**2) / 12 + half**2 + offset**2  # about the edge, over mass [m2]
    rate = math.sqrt(G * half / inertia)
    expected = math.acosh(1 + TILT_LIMIT * half / offset) / rate
    assert fall_time(*block_beyond_an_edge(offset)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("offset", [0.002, 0.01, 0.03])
def test_the_formula_is_that_of_the_whole_equation_of_motion_to_two_percent(offset):
    """It is linear in the angle; up to 15 degrees sin and cos differ from that by up to 3 %."""
    arm, inertia = math.hypot(0.1, offset), 0.08 / 12 + 0.1**2 + offset**2
    begin = math.atan2(offset, 0.1)

    def motion(_, state):
        return [state[1], G * arm * math.sin(state[0]) / inertia]

    def has_toppled(_, state):
        return state[0] - begin - TILT_LIMIT

    has_toppled.terminal = True
    whole = solve_ivp(motion, (0, 10), [begin, 0.0], events=has_toppled, rtol=1e-10, atol=1e-12).t_events[0][0]
    assert fall_time(*block_beyond_an_edge(offset)) == pytest.approx(whole, rel=0.02)


@pytest.mark.parametrize(("theta", "margin"), [(15, -0.05), (20, -0.15), (25, -0.3)])
def test_a_tile_slides_down_a_ramp_as_its_closed_form_says(theta, margin):
    """x = a cos(theta) t^2 / 2 with a = g (sin(theta) - mu cos(theta)), but for the dilation of a projected force.

    With phi = atan(mu) the projected acceleration is g sin(theta - phi), down at theta - phi instead of theta. The
    pyramid of friction has an edge along the slope: nothing else differs.
    """
    scene = build("incline", theta=theta, margin=margin)
    angle, friction = math.radians(theta), scene.world.friction
    way, phi = SLIDE_LIMIT * min(scene.bricks[-1].size), math.atan(friction)
    forward = G * (math.sin(angle) - friction * math.cos(angle)) * math.cos(angle)
    dilated = math.cos(phi) * math.cos(angle - phi) / math.cos(angle)
    assert 0.95 < dilated < 1.05
    assert fall_time(scene.bricks, scene.world) == pytest.approx(math.sqrt(2 * way / (forward * dilated)), rel=1e-6)


def test_what_nothing_carries_falls_freely():
    """A brick in the air drops by its least edge."""
    brick = Brick((0.1, 0.1, 0.02), 1.0, (0.0, 0.0, 1.0))
    assert fall_time([brick], World()) == pytest.approx(math.sqrt(2 * 0.02 / G), rel=1e-9)


def test_what_stands_has_no_time_to_fall():
    with pytest.raises(ValueError, match="no brick moves"):
        fall_time(build("leaning_tower", levels=3).bricks, World())


@pytest.mark.parametrize(("name", "parameters"), [("leaning_tower", {"levels": 9}), ("plank_bridge", {"margin": -0.3})])
def test_time_goes_with_the_root_of_size_and_knows_neither_mass_nor_yaw(name, parameters):
    scene = build(name, **parameters)
    plain = fall_time(scene.bricks, scene.world)
    changed = [transformed(brick, 3.0, 7.0, 13.0) for brick in scene.bricks]
    # the pyramids inscribed into the cones of friction turn with the patches, and are off by 2 %
    assert fall_time(changed, scene.world) == pytest.approx(plain * math.sqrt(3), rel=0.01)


def test_the_farther_beyond_its_limit_the_faster_it_falls():
    times = [fall_time((s := build("cantilever", margin=margin)).bricks, s.world) for margin in (-0.05, -0.15, -0.3)]
    assert all(slow > fast for slow, fast in pairwise(times))


def test_gravity_sets_the_pace():
    scene = build("leaning_tower", levels=9)
    moon = replace(scene.world, gravity=(0.0, 0.0, -G / 6))
    assert fall_time(scene.bricks, moon) == pytest.approx(fall_time(scene.bricks, scene.world) * math.sqrt(6), rel=1e-9)
