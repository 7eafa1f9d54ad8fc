"""``check_port`` passes a sound port, and names the fix for each that breaks a promise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from adapters import open_engine
from scenarios.model import Brick, World
from stability_core import PortError, check_port

PLANK = (0.117, 0.0234, 0.0078)
ENGINES = ("bullet", "mujoco", "dart", "physx", "rapier", "box3d", "jolt", "havok", "ode", "pymunk")


def lying(engine: str):
    """A simulation with a plank on the ground and one upon it."""
    simulation = open_engine(engine, "game", world=World())
    for level in range(2):
        simulation.spawn(Brick(PLANK, 0.0119, (0.0, 0.0, (level + 0.5) * PLANK[2])))
    return simulation


@pytest.mark.parametrize("engine", ENGINES)
def test_every_adapter_passes(engine):
    simulation = lying(engine)
    try:
        lines = check_port(simulation.port, lambda: simulation.step(1 / 60))
    finally:
        simulation.close()
    assert "stayed frozen for 10 frames without moving" in lines[-1]


class Mutant:
    """A port that spoils the data of a sound port."""

    def __init__(self, port, **spoil) -> None:
        self._port, self._spoil = port, spoil

    def _spoilt(self, name, value):
        return self._spoil[name](value) if name in self._spoil else value

    def contacts(self):
        return self._spoilt("contacts", self._port.contacts())

    def masses(self):
        return self._spoilt("masses", self._port.masses())

    def sleep(self, bodies):
        if "sleep" not in self._spoil:
            self._port.sleep(bodies)

    def wake(self, bodies):
        if "wake" not in self._spoil:
            self._port.wake(bodies)


MUTANTS = {
    "change the sign of all normals": {"contacts": lambda c: replace(c, normal=-c.normal)},
    "unit normal": {"contacts": lambda c: replace(c, normal=2.0 * c.normal)},
    "finite point": {"contacts": lambda c: replace(c, point=c.point * np.nan)},
    "give bodies that never move the id -1": {
        "contacts": lambda c: replace(c, body_a=np.where(c.body_a < 0, 99, c.body_a))
    },
    "the signed distance in metres": {"contacts": lambda c: replace(c, separation=c.separation + 1.0)},
    "friction of body 0 with the ground must be above 0": {"contacts": lambda c: replace(c, friction=0.0 * c.friction)},
    "must hold integers": {"masses": lambda m: replace(m, body=m.body + 0.5)},
    "positive mass": {"masses": lambda m: replace(m, mass=-m.mass)},
    "must have shape": {"masses": lambda m: replace(m, mass=m.mass[:1])},
    "must list body 0 after wake": {"wake": None},
}


@pytest.mark.parametrize("fix", MUTANTS)
def test_each_fault_is_named_with_its_fix(fix):
    simulation = lying("mujoco")
    try:
        with pytest.raises(PortError, match=fix):
            check_port(Mutant(simulation.port, **MUTANTS[fix]), lambda: simulation.step(1 / 60))
    finally:
        simulation.close()


def test_a_sleeper_that_falls_is_named():
    """Its support is taken while it sleeps: only a port that fixes it leaves it in the air."""
    simulation = lying("mujoco")
    port = simulation.port
    taken = []

    def step():
        if len(taken) == 0 and frames[0] == 122:
            simulation.move(0, (0.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))
            taken.append(0)
        frames[0] += 1
        simulation.step(1 / 60)

    frames = [0]
    try:
        with pytest.raises(PortError, match=r"must not move after sleep|must keep its place"):
            check_port(Mutant(port, sleep=None), step)
    finally:
        simulation.close()


def test_nothing_at_rest_is_named():
    simulation = open_engine("mujoco", "game", world=World())
    try:
        simulation.spawn(Brick(PLANK, 0.0119, (0.0, 0.0, 1.0)))
        with pytest.raises(PortError, match="no contact with the ground in the last frame"):
            check_port(simulation.port, lambda: simulation.step(1 / 60), frames=5)
    finally:
        simulation.close()
