"""A pile on MuJoCo: the adapter adds no motion and no second solve to the engine's own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from adapters.registry import open_engine  # noqa: E402
from scenarios.model import Brick  # noqa: E402
from scenarios.scenes.poured_pile import poured_pile  # noqa: E402
from stability_core.ports.mujoco_release import HAS_SLEEP, HAS_SPECULATIVE  # noqa: E402

FRAME_S = 1 / 60
FRAMES = 90
PILE = poured_pile(bricks=12)
"""Bricks at the heights of their first contacts, which tumble into a pile."""


def piled(expected: list[Brick], profile: str = "game", *, observed: bool = False) -> Any:
    """Return a simulation that holds the pile, with slots for ``expected``, and with ghosts if it is observed."""
    simulation = open_engine("mujoco", profile, world=PILE.world, expected=expected)
    if observed:
        assert len(simulation.port.contacts()) == 0
    for brick in PILE.bricks:
        simulation.spawn(brick)
    return simulation


def solves(simulation: Any) -> int:
    """Return how often MuJoCo has solved for the forces of a step."""
    return int(simulation._engine.slots.data.timer[mujoco.mjtTimer.mjTIMER_FORWARD].number)


def advance(simulation: Any, frames: int) -> None:
    for _ in range(frames):
        simulation.step(FRAME_S)


@pytest.mark.skipif(not HAS_SPECULATIVE, reason="written in the XML of MuJoCo 4")
@pytest.mark.parametrize("spare", [0, 12])
def test_a_pile_moves_bit_by_bit_as_in_a_plain_model(spare: int) -> None:
    """A model without slots, ghosts and masks, with the settings of `game` written by hand, is the engine itself.

    Empty slots change nothing either, because MuJoCo solves the bricks in touch apart from all others.
    """
    size, mass = PILE.bricks[0].size, PILE.bricks[0].mass
    half = " ".join(repr(edge / 2) for edge in size)
    body = f'<body><freejoint/><geom type="box" size="{half}" mass="{mass!r}"/></body>'
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
        <option timestep="{FRAME_S!r}" gravity="0 0 -9.81" cone="elliptic" impratio="10">
            <flag speculative="enable" autoreset="disable"/></option>
        <default><geom friction="{PILE.world.friction}" solref="{2 * FRAME_S!r} 1" solimp="0.99 0.999 1e-4 0.5 2"
            gap="0.00025"/></default>
        <worldbody><geom type="plane" size="0 0 1"/>{body * len(PILE.bricks)}</worldbody></mujoco>""")
    data = mujoco.MjData(model)
    poses = data.qpos.reshape(-1, 7)
    for row, brick in zip(poses, PILE.bricks, strict=True):
        row[:3], row[3:] = brick.position, brick.quaternion
    simulation = piled([*PILE.bricks, *PILE.bricks[:spare]])
    for _ in range(FRAMES):
        mujoco.mj_step(model, data)
        simulation.step(FRAME_S)
    assert np.array_equal(np.hstack(simulation.poses()[1:]), poses)
    simulation.close()


@pytest.mark.skipif(not HAS_SLEEP, reason="parked bricks do not sleep in this release")
@pytest.mark.parametrize("profile", ["game", "tuned"])
def test_a_pile_without_sleeping_is_solved_once_a_step(profile: str) -> None:
    """MuJoCo solves a step twice in which a body falls asleep. Without sleeping no body does, empty slots included."""
    simulation = piled([*PILE.bricks, *PILE.bricks], profile)
    advance(simulation, 1)  # compiles the model, which solves once for the bodies that start asleep
    before = solves(simulation)
    advance(simulation, FRAMES)
    assert solves(simulation) - before == FRAMES * simulation.info.profile.substeps
    simulation.close()


@pytest.mark.skipif(not HAS_SLEEP, reason="parked bricks do not sleep in this release")
def test_freezing_costs_one_further_solve() -> None:
    """MuJoCo puts the parked bricks to sleep in the next step, however many, and they stay asleep beside live ones."""
    simulation = piled(list(PILE.bricks), observed=True)
    advance(simulation, FRAMES)
    before = solves(simulation)
    simulation.port.sleep(simulation.poses()[0].tolist()[:6])
    advance(simulation, FRAMES)
    assert solves(simulation) - before == FRAMES + 1
    simulation.close()
