"""What is special to MuJoCo: slots, ghosts, speculative contacts, its own sleep, silent resets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from adapters.base import Simulation
from adapters.registry import open_engine
from scenarios.model import Brick
from stability_core.port import GROUND

FRAME_S = 1 / 60
PLANK = Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.0, 0.0039))
CUBE = Brick((0.02, 0.02, 0.02), 0.005, (0.0, 0.0, 0.01))


def at(brick: Brick, x: float = 0.0, z: float = 0.0) -> Brick:
    """The brick with its lower face at height z."""
    return replace(brick, position=(x, 0.0, z + brick.size[2] / 2))


def tower(levels: int) -> list[Brick]:
    return [at(brick, z=i * 0.0078) for i, brick in enumerate([PLANK] * levels)]


def advance(simulation: Simulation, frames: int) -> None:
    for _ in range(frames):
        simulation.step(FRAME_S)


def build(bricks: Sequence[Brick], expected: Sequence[Brick], *, observed: bool) -> np.ndarray:
    simulation = open_engine("mujoco", "game", expected=expected)
    if observed:
        assert len(simulation.port.contacts()) == 0
    for brick in bricks:
        simulation.spawn(brick)
        advance(simulation, 5)
    return np.hstack(simulation.poses()[1:])


def test_an_unexpected_brick_finds_the_others_as_they_were() -> None:
    """The model is compiled anew, once for every doubling; a compilation must not nudge what stands.

    The tolerance is that of the solver, whose problem has other empty rows.
    """
    bricks = [*tower(4), at(CUBE, x=0.2), at(CUBE, x=0.3)]
    expected = build(bricks, bricks, observed=False)
    assert build(bricks, (), observed=False) == pytest.approx(expected, abs=1e-9)


def test_ghosts_that_are_not_shown_change_nothing() -> None:
    bricks = tower(4)
    assert np.array_equal(build(bricks, bricks, observed=True), build(bricks, bricks, observed=False))


def test_freezing_survives_a_compilation_bit_by_bit() -> None:
    simulation = open_engine("mujoco", "game", expected=[PLANK])
    plank = simulation.spawn(at(PLANK, z=0.1))
    advance(simulation, 3)  # nobody has looked on so far, so there are no ghosts yet
    simulation.port.sleep([plank])
    before = np.hstack(simulation.poses()[1:])
    advance(simulation, 3)
    simulation.spawn(at(CUBE, x=0.2))
    advance(simulation, 3)
    assert np.array_equal(np.hstack(simulation.poses()[1:])[:1], before)


@pytest.mark.parametrize("profile", ["game", "tuned"])
@pytest.mark.parametrize("height", [0.05, 0.3, 1.0])
def test_a_falling_plank_does_not_pass_through_a_frozen_one(profile: str, height: float) -> None:
    """It falls up to 70 mm in a frame, nine times the thickness; the speculative contact must stop it and
    report its speed, to within what gravity adds in a frame.

    Before that it is listed across the gap, at the lower speeds of the last frames of its fall.
    """
    simulation = open_engine("mujoco", profile, expected=[PLANK] * 2)
    simulation.port.sleep([simulation.spawn(at(PLANK))])
    simulation.spawn(at(PLANK, z=0.0078 + height))
    speeds = []
    for _ in range(120):
        simulation.step(FRAME_S)
        contacts = simulation.port.contacts()
        speeds.extend(-(contacts.relative_velocity * contacts.normal).sum(axis=1))
    assert simulation.poses()[1][1, 2] == pytest.approx(0.0117, abs=0.1e-3)
    assert max(speeds) == pytest.approx(np.sqrt(2 * 9.81 * height), abs=9.81 * FRAME_S)


@pytest.mark.parametrize(("lower_by", "listed"), [(0.0, True), (0.3e-3, True), (0.9e-3, False)])
def test_a_support_that_is_just_missed_is_listed(lower_by: float, listed: bool) -> None:
    """A plank over two frozen cubes, one of them lower: within half a millimetre it will bear load as well.

    Until then it bears nothing: the plank lies level on the other cube, sunk in by less than a tenth.
    """
    simulation = open_engine("mujoco", "game", expected=[CUBE, CUBE, PLANK])
    assert len(simulation.port.contacts()) == 0
    cubes = [simulation.spawn(at(CUBE, x=-0.01)), simulation.spawn(at(CUBE, x=0.04, z=-lower_by))]
    simulation.port.sleep(cubes)
    plank = simulation.spawn(at(PLANK, z=0.02))
    advance(simulation, 20)
    contacts = simulation.port.contacts()
    below = {int(body) for body in np.concatenate([contacts.body_a, contacts.body_b]) if body != plank}
    assert (cubes[1] in below) == listed
    assert simulation.poses()[1][2, 2] == pytest.approx(0.0239, abs=0.1e-3)


@pytest.mark.parametrize("sleeping", ["native", "raised"])
def test_a_sleeping_brick_falls_when_its_support_goes(sleeping: str) -> None:
    """MuJoCo itself would leave it in the air."""
    simulation = open_engine("mujoco", "game", sleeping=sleeping, expected=tower(2))
    lower, _ = (simulation.spawn(brick) for brick in tower(2))
    advance(simulation, 120)
    asleep = simulation.poses()[1][1]
    advance(simulation, 10)
    assert np.array_equal(simulation.poses()[1][1], asleep)  # it does sleep
    simulation.remove(lower)
    advance(simulation, 60)
    assert simulation.poses()[1][0, 2] == pytest.approx(0.0039, abs=0.1e-3)


def test_a_diverged_world_is_not_put_back_to_its_start() -> None:
    """As shipped, MuJoCo resets such a world without a word, and the brick would seem to stand."""
    simulation = open_engine("mujoco", "default", expected=[PLANK])
    plank = simulation.spawn(at(PLANK))
    simulation.push(plank, (0.0, 0.0, 1e12))
    advance(simulation, 3)
    assert not abs(simulation.poses()[1][0, 2]) < 1.0


def test_a_slot_does_not_hand_its_contacts_to_the_next_brick() -> None:
    simulation = open_engine("mujoco", "game", expected=[PLANK])
    port = simulation.port
    first = simulation.spawn(at(PLANK))
    advance(simulation, 5)
    assert set(port.contacts().body_a) == {GROUND}
    simulation.remove(first)
    second = simulation.spawn(at(PLANK, z=0.5))
    assert second != first
    assert len(port.contacts()) == 0


@pytest.mark.parametrize("profile", ["default", "game", "tuned"])
def test_knobs_are_what_the_engine_runs_with(profile: str) -> None:
    simulation = open_engine("mujoco", profile, sleeping="raised")
    simulation.spawn(PLANK)
    simulation.step(FRAME_S)
    option, knobs = simulation._engine.slots.model.opt, simulation.info.profile.knobs
    assert option.sleep_tolerance == knobs["option.sleep_tolerance"].value
    assert option.timestep * simulation.info.profile.substeps == pytest.approx(FRAME_S)
    if profile != "default":
        assert option.impratio == knobs["option.impratio"].value
        two_steps = float(knobs["contact_steps"].value) * option.timestep
        assert simulation._engine.slots.model.geom_solref.tolist() == [[two_steps, 1.0]] * 2
