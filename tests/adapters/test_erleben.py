"""The reference engine after Erleben 2007: its sweeps, what it holds, and its false stands, which are a finding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters import open_engine
from adapters._erleben import ErlebenSimulation
from adapters._erleben_solver import ErlebenSolver
from adapters._staggered_solver import StaggeredSolver
from adapters.reference.contact_rows import EARTH, contact_rows
from scenarios.model import Brick, World
from scenarios.registry import build

STEP = 1 / 60
PLANK = (0.117, 0.0234, 0.0078)
THICKNESS = PLANK[2]


def opened(profile: str, friction: float = 0.45) -> ErlebenSimulation:
    simulation = open_engine("erleben", profile, world=World(friction=friction))
    assert isinstance(simulation, ErlebenSimulation)
    return simulation


def bricks_of(scene: str, **parameters: float) -> list[Brick]:
    return [brick for action in build(scene, **parameters).actions for brick in action.bricks]


def sink(profile: str, bricks: list[Brick], seconds: float, friction: float = 0.45) -> float:
    """Return by how much [m] the centre of any brick falls after all are set down at once."""
    simulation = opened(profile, friction)
    for brick in bricks:
        simulation.spawn(brick)
    before = simulation.poses()[1][:, 2]
    for _ in range(round(seconds * 60)):
        simulation.step(STEP)
    after = simulation.poses()[1][:, 2]
    simulation.close()
    return float((before - after).max())


@pytest.mark.parametrize(("scene", "push", "friction"), [("card_house", 0.0, 0.0), ("plank_tower", 1.0, 0.2)])
def test_sweeps_converge_to_the_quadratic_programs(scene: str, push: float, friction: float) -> None:
    """With the whole step for all bodies and 1,000 sweeps, the bodies move as by both programs of ``staggered``, which
    share no line with the sweeps: a V without friction, and two planks of which the upper one slides."""
    simulation = opened("default", friction)
    for brick in bricks_of(scene)[:2]:
        body = simulation.spawn(brick)
    simulation.push(body, (push * 0.0119, 0.0, 0.0))
    boxes, gravity = simulation._boxes, np.array([0.0, 0.0, -EARTH])
    found = simulation._detector.find(boxes, gravity, STEP)
    problem = contact_rows(boxes, found, gravity, STEP, EARTH * STEP)
    simulation.close()
    velocity, _, displacement = ErlebenSolver(friction, 1.0, 1000).solve(problem)
    exact, _, turns = StaggeredSolver(friction, 1e-8, 200, 5, "box").solve(problem, np.zeros((len(problem), 2)))
    assert len(problem) in (8, 10)
    assert turns.residual < 1e-7
    np.testing.assert_allclose(velocity + displacement, exact, atol=1e-4)


def test_a_structured_stack_stands_without_sinking() -> None:
    """Twelve levels of crossed pairs, set down in place, sink by less than a hundredth of a millimetre in a second."""
    assert sink("default", bricks_of("four_stack", levels=12), 1.0) < 1e-5


@pytest.mark.parametrize("profile", ["default", "game"])
def test_a_leaning_tower_that_must_fall_stands(profile: str) -> None:
    """The finding: 13 levels lean by more than a plank's length, and no layer feels the weight above it."""
    assert sink(profile, bricks_of("leaning_tower", levels=13), 1.5) < 0.05 * THICKNESS


def test_a_cantilever_beyond_its_limit_stands() -> None:
    """The finding, once more: the load tips the plank only if the plank feels the load."""
    assert sink("default", bricks_of("cantilever", margin=-0.3), 1.5) < 0.05 * THICKNESS


def test_the_layers_feel_the_weight_above_if_part_of_the_step_is_for_all() -> None:
    """The tower sags at once by a twentieth of a plank; placed one a second, it falls at 10 levels (related work)."""
    assert sink("tuned", bricks_of("leaning_tower", levels=13), 0.5) > 0.05 * THICKNESS


def test_a_slippery_v_falls() -> None:
    assert sink("game", bricks_of("card_house", friction=0.11), 0.5, friction=0.11) > THICKNESS


def test_an_overlap_is_removed_in_a_step_without_velocity() -> None:
    """Half a millimetre of overlap with the ground: the whole depth as a displacement, as the author coded it."""
    simulation = opened("default")
    body = simulation.spawn(Brick(PLANK, 0.0119, (0.0, 0.0, THICKNESS / 2 - 0.5e-3)))
    simulation.step(STEP)
    _, positions, _ = simulation.poses()
    linear, _ = simulation.velocities()
    simulation.close()
    assert positions[body, 2] == pytest.approx(THICKNESS / 2, abs=1e-6)
    assert np.abs(linear[body]).max() < 1e-6


def test_a_fraction_outside_its_range_is_refused() -> None:
    with pytest.raises(ValueError, match="the knob 'fraction' must be a number from 0 to 1, got 2"):
        open_engine("erleben", "default@fraction=2")


def test_it_has_no_sleeping_of_its_own() -> None:
    with pytest.raises(NotImplementedError, match="no sleeping of its own"):
        open_engine("erleben", sleeping="native")


def test_a_pair_slides_along_its_tangent_with_coulombs_friction() -> None:
    """A plank pushed to 1 m/s stops after v / (mu g)."""
    simulation = opened("default", friction=0.3)
    body = simulation.spawn(Brick(PLANK, 0.0119, (0.0, 0.0, THICKNESS / 2)))
    simulation.push(body, (0.0119 * math.cos(0.7), 0.0119 * math.sin(0.7), 0.0))
    for _ in range(30):
        simulation.step(STEP)
    way = np.hypot(*simulation.poses()[1][body, :2])
    simulation.close()
    assert way == pytest.approx(1.0 / (2 * 0.3 * EARTH), rel=0.06), "a step of 1/60 s moves by 5 % more or less"
