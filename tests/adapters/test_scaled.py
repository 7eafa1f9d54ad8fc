"""A larger world is the same world in larger units: all of it but the engine's absolute constants."""

from __future__ import annotations

import numpy as np
import pytest

from adapters import ENGINES, ProfileError, capabilities, open_engine, profile_named
from adapters._havok import HavokSimulation
from adapters.conformance.rig import LENGTH, MASS, advance, frozen_column, place_on, plank, velocity
from adapters.profile_variants import profile_of
from scenarios.lookup import UnknownNameError
from scenarios.model import World
from scenarios.registry import build

WEIGHTLESS = World(gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("engine", ENGINES)
def test_what_flies_freely_flies_alike_to_the_last_bit(engine: str) -> None:
    """Times four, a power of two, rounds nothing: only the engine's absolute constants could make the worlds differ."""
    paths = []
    for profile in ("game", f"game@scale={4 * profile_named(engine, 'game').scale:g}"):
        simulation = open_engine(engine, profile)
        body = simulation.spawn(plank(0.1, 5.0, lean=0.3))
        simulation.push(body, (0.3 * MASS, 0.0, 0.2 * MASS))
        path = []
        for _ in range(30):
            simulation.step(simulation.info.frame_s)
            path.append(np.hstack([*simulation.poses()[1:], *simulation.velocities()]))
        paths.append(np.array(path))
        simulation.close()
    np.testing.assert_array_equal(*paths)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_port_speaks_unscaled_si(engine: str) -> None:
    simulation = open_engine(engine, "game@scale=100")
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 1.0)
    contacts, masses = simulation.port.contacts(), simulation.port.masses()
    assert set(contacts.body_a) | set(contacts.body_b) == {support, body}
    assert np.ptp(contacts.point[:, 0]) == pytest.approx(LENGTH, rel=0.01)
    assert np.abs(contacts.separation).max() < 0.2e-3
    assert np.abs(contacts.relative_velocity).max() < 1e-2
    assert masses.mass.tolist() == [MASS]
    assert simulation.world.gravity == (0.0, 0.0, -9.81)
    plain = open_engine(engine, "game")
    assert simulation.info.unit_scale / 100 == plain.info.unit_scale / plain.info.profile.scale
    plain.close()
    simulation.close()


@pytest.mark.parametrize("engine", [name for name in ENGINES if not capabilities(name).planar])
def test_a_large_scene_has_ground_below_all_of_it(engine: str) -> None:
    simulation = open_engine(engine, "game@scale=100")
    body = place_on(simulation, 0, x=1.8)
    advance(simulation, 0.5)
    assert simulation.poses()[1][body, 2] > 0
    simulation.close()


def test_an_impulse_is_that_of_the_scene() -> None:
    simulation = open_engine("bullet", "game@scale=10", world=WEIGHTLESS)
    body = simulation.spawn(plank(z=0.5))
    simulation.push(body, (0.4 * MASS, 0.0, 0.0))
    assert velocity(simulation, body)[0] == pytest.approx(0.4, rel=1e-12)
    simulation.close()


# -- profiles by name --------------------------------------------------------------------------------


def test_an_engine_without_iterations_says_so() -> None:
    with pytest.raises(
        ProfileError,
        match=r"profile 'game@iterations=9': .*, but the engine havok has no knob of this kind: vary 'substeps'",
    ):
        profile_of(HavokSimulation, "game@iterations=9")


def test_a_name_varies_a_profile() -> None:
    base, varied = profile_named("bullet", "game"), profile_named("bullet", "game@scale=10,substeps=2,iterations=80")
    assert (varied.scale, varied.substeps) == (10.0, 2)
    assert varied.name == "game@scale=10,substeps=2,iterations=80"
    assert varied.knobs["numSolverIterations"].value == 80
    assert {name: knob for name, knob in varied.knobs.items() if name in base.knobs} == dict(base.knobs)


def test_only_lengths_chosen_for_the_bricks_follow_the_world() -> None:
    plain, scaled = (profile_named("rapier", name).knobs for name in ("game", "game@scale=10"))
    assert {name for name in plain if plain[name].value != scaled[name].value} == {"length_unit"}
    assert scaled["length_unit"].value == 10 * float(plain["length_unit"].value)
    assert profile_named("bullet", "game@scale=10").knobs == profile_named("bullet", "game").knobs


@pytest.mark.parametrize(
    "engine", [name for name in ENGINES if ENGINES[name].load().iterations and name != "staggered"]
)  # one turn of staggered solves a stack without friction exactly; test_staggered.py varies its turns
def test_iterations_are_those_of_the_engines_own_solver(engine: str) -> None:
    """The varied knob takes effect: fewer iterations leave a stack of live bricks elsewhere than many do.

    Without ``matrix_free_min_rows``, the dense solver of DART, which does not iterate, would solve so small a stack.
    """
    heights = []
    for iterations in (1, 500):
        more = ",matrix_free_min_rows=1" if engine == "dart" else ""
        simulation = open_engine(engine, f"game@iterations={iterations}{more}")
        for level in range(4):
            place_on(simulation, level)
        advance(simulation, 0.2)
        heights.append(simulation.poses()[1][:, 2])
        simulation.close()
    assert not np.array_equal(*heights)


@pytest.mark.parametrize(
    ("name", "error", "message"),
    [
        ("gam@scale=10", UnknownNameError, "unknown profile of engine bullet 'gam'; did you mean 'game'?"),
        (
            "game@scal=10",
            UnknownNameError,
            "unknown variation of a profile of engine 'bullet' 'scal'; did you mean 'scale'?",
        ),
        ("game@", UnknownNameError, "unknown variation of a profile of engine 'bullet' ''"),
        ("game@scale=0", ProfileError, "profile 'game@scale=0': scale must be a positive, finite number, got '0'"),
        ("game@scale=nan", ProfileError, "scale must be a positive, finite number, got 'nan'"),
        ("game@substeps=2.5", ProfileError, "substeps must be a whole number from 1, got '2.5'"),
        ("game@iterations", ProfileError, "iterations must be a whole number from 1, got ''"),
    ],
)
def test_a_name_that_makes_no_profile_is_refused_with_the_fix(name: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        open_engine("bullet", name)
    assert message in str(caught.value)


@pytest.mark.parametrize("scale", [1, 10])
@pytest.mark.parametrize(("size", "fit"), [(0.1, 0.05), (0.2, 0.1), (0.3, 1.0), (1.0, 1.0), (100.0, 1.0)])
def test_lengths_that_a_profile_chose_for_planks_shrink_with_small_bricks(size, fit, scale):
    scene = build("four_stack", levels=1, size=size)
    name = f"game@scale={scale}" if scale > 1 else "game"
    simulation = open_engine("physx", name, world=scene.world, expected=scene.bricks)
    assert simulation.info.profile.knobs["contact_offset"].value == pytest.approx(1e-3 * fit * scale)
    simulation.close()
