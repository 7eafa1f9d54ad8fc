"""The reference engine after Kaufman et al. 2008: its projections, its stopping, and scenes with a known answer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters import open_engine
from adapters._staggered import StaggeredSimulation
from adapters._staggered_programs import impact, normal_rows
from adapters.reference.contact_rows import EARTH, ContactRows, contact_rows
from scenarios.model import Brick, Quaternion, Vector, World
from scenarios.registry import build

STEP = 1 / 60
PLANK = (0.117, 0.0234, 0.0078)
MASS = 0.0119


def opened(profile: str = "tuned", friction: float = 0.45, fixed: tuple[Brick, ...] = ()) -> StaggeredSimulation:
    simulation = open_engine("staggered", profile, world=World(friction=friction, fixed=fixed))
    assert isinstance(simulation, StaggeredSimulation)
    return simulation


def about_y(degrees: float) -> Quaternion:
    half = math.radians(degrees) / 2
    return math.cos(half), 0.0, math.sin(half), 0.0


def card(size: Vector, x: float, z: float, degrees: float) -> Brick:
    """Return a card centred on y = 0, whose long edge rises from +x towards +z by an angle."""
    return Brick(size, MASS, (x, 0.0, z), about_y(-degrees))


def thin_storey() -> list[Brick]:
    """Return the lowest storey of SCISim's card house: three Vs of thin cards at 65 degrees, and two roofs."""
    length, thickness, lean = 0.0877, 0.001, 65.0
    size = length, 0.038, thickness
    c, s = math.cos(math.radians(lean)), math.sin(math.radians(lean))
    height, reach = (length * s + thickness * c) / 2, (length * c + thickness * s) / 2
    pitch = 2 * (length * c + thickness * s) + 2e-4
    cards = [
        card(size, middle + side * reach, height, -side * lean)
        for middle in (-pitch, 0.0, pitch)
        for side in (-1.0, 1.0)
    ]
    inner, outer = 5e-5, pitch + 3e-3  # the roofs meet above the middle V, and overhang the others
    roof = (outer - inner, 0.038, thickness)
    return cards + [card(roof, side * (inner + outer) / 2, 2 * height + thickness / 2, 0.0) for side in (-1.0, 1.0)]


def run(simulation: StaggeredSimulation, frames: int) -> list[tuple[int, float, float]]:
    turns = []
    for _ in range(frames):
        simulation.step(STEP)
        turns.append((simulation.turns.count, simulation.turns.residual, simulation.turns.rise))
    return turns


def problem_of(simulation: StaggeredSimulation) -> ContactRows:
    boxes, gravity = simulation._boxes, np.array([0.0, 0.0, -EARTH])
    return contact_rows(boxes, simulation._detector.find(boxes, gravity, STEP), gravity, STEP, EARTH * STEP)


def house(storeys: int) -> list[Brick]:
    return [brick for action in build("card_house", storeys=storeys).actions for brick in action.bricks]


# -- the projections ---------------------------------------------------------------------------------


def test_no_half_step_adds_energy() -> None:
    """A card house lands, stands and is struck: both programs are projections, and what they round is 1e-9."""
    simulation = opened()
    bodies = [simulation.spawn(brick) for brick in house(2)]
    turns = run(simulation, 20)
    simulation.push(bodies[-1], (0.3 * MASS, 0.0, -0.5 * MASS))
    turns += run(simulation, 5)
    simulation.close()
    assert max(rise for _, _, rise in turns) <= 1e-9
    assert max(count for count, _, _ in turns) > 3, "the scene is hard enough to alternate"


def test_an_impact_is_the_nearest_velocity_that_approaches_nothing() -> None:
    simulation = opened()
    for brick in house(2):
        simulation.spawn(brick)
    run(simulation, 5)
    problem = problem_of(simulation)
    simulation.close()
    normals, before, least = normal_rows(problem), problem.start.ravel(), -np.maximum(problem.gap, 0.0)
    solved = impact(normals, before, least)
    slack = normals @ solved.velocity - least
    assert slack.min() > -1e-8
    assert solved.alpha.min() > -1e-8
    assert np.abs(slack * solved.alpha).max() < 1e-7
    np.testing.assert_allclose(solved.velocity, before + normals.T @ solved.alpha, atol=1e-8)


def test_a_step_obeys_coulombs_law_when_its_residual_is_small() -> None:
    """Friction lies within mu alpha along both tangents, at the bound and against the slip where a contact slips."""
    simulation = opened(friction=0.2)
    simulation.spawn(card(PLANK, 0.0, PLANK[2] / 2, 0.0))
    simulation.spawn(card(PLANK, 0.02, 1.5 * PLANK[2], 0.0))
    simulation.push(1, (0.5 * MASS, 0.1 * MASS, 0.0))
    run(simulation, 3)
    problem = problem_of(simulation)
    velocity, impulse, turns = simulation._solver.solve(problem, np.zeros((len(problem), 2)))
    simulation.close()
    assert turns.residual <= simulation._solver.tolerance
    of_bodies = np.vstack([velocity, np.zeros(6)])[problem.body]
    slip = np.einsum("ckbj,cbj->ck", problem.jacobian[:, 1:], of_bodies)
    bound = 0.2 * impulse[:, :1]
    assert (np.abs(impulse[:, 1:]) <= bound + 1e-5).all()
    slides = np.abs(slip) > 1e-3
    assert slides.any()
    np.testing.assert_allclose(impulse[:, 1:][slides], (-np.sign(slip) * bound)[slides], atol=1e-5)


def test_the_best_of_too_few_turns_is_kept() -> None:
    """The residual of n turns never rises with n, although that of a single turn does."""
    simulation = opened("default")
    for brick in house(2):
        simulation.spawn(brick)
    problem = problem_of(simulation)
    least = []
    for turns in range(1, 12):
        solver = open_engine("staggered", f"default@iterations={turns}", world=World(friction=0.45))
        assert isinstance(solver, StaggeredSimulation)
        _, _, record = solver._solver.solve(problem, np.zeros((len(problem), 2)))
        least.append(record.residual)
        solver.close()
    simulation.close()
    assert np.all(np.diff(least) <= 0.0)
    assert least[-1] < least[0]


def test_a_brick_squeezed_between_fixed_boxes_stays_finite_and_still() -> None:
    """No velocity of the brick avoids both: a slab that the host lowers onto it, and the ground."""
    simulation = opened()
    body = simulation.spawn(card(PLANK, 0.0, PLANK[2] / 2, 0.0))
    press = simulation.spawn(Brick((0.3, 0.3, 0.01), 1.0, (0.0, 0.0, PLANK[2] + 0.006), moved=True))
    for _ in range(20):
        simulation.drive(press, (0.0, 0.0, -0.01), (0.0, 0.0, 0.0))
        simulation.step(STEP)
    linear, _ = simulation.velocities()
    simulation.close()
    assert np.abs(linear[body]).max() < 0.02


# -- scenes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", ["default", "game", "tuned"])
def test_both_cones_agree_on_a_v_and_on_a_slope(profile: str) -> None:
    """Above and below its limit a V stands or slips, whether friction is a box or a disc."""
    for friction, stands in ((0.45, True), (0.11, False)):
        falls = []
        for cone in ("box", "disc"):
            simulation = opened(f"{profile}@cone={cone}", friction)
            for brick in house(1):
                simulation.spawn(brick)
            run(simulation, 24)
            falls.append(float(np.ptp(simulation.poses()[1][:, 0])))
            simulation.close()
        assert falls[0] == pytest.approx(falls[1], abs=1e-4)
        assert (falls[0] < 0.046) == stands


@pytest.mark.slow
def test_thin_cards_of_scisims_scene_stand() -> None:
    """Cards 1 mm thick and 88 mm long at 65 degrees, mu 0.8: feet need cot(65 deg) = 0.47."""
    simulation = opened(friction=0.8)
    for brick in thin_storey():
        simulation.spawn(brick)
    before = simulation.poses()[1]
    turns = run(simulation, 120)
    moved = float(np.abs(simulation.poses()[1] - before).max())
    simulation.close()
    assert moved < 0.5e-3, "half of a card's thickness"
    assert max(rise for _, _, rise in turns) <= 1e-9


def test_an_unknown_cone_is_refused() -> None:
    with pytest.raises(ValueError, match="the knob 'cone' must be box or disc, got 'ring'"):
        open_engine("staggered", "game@cone=ring")


@pytest.mark.parametrize("sleeping", ["native", "raised"])
def test_it_has_no_sleeping_of_its_own(sleeping: str) -> None:
    with pytest.raises(NotImplementedError, match="no sleeping of its own"):
        open_engine("staggered", sleeping=sleeping)  # type: ignore[arg-type]
