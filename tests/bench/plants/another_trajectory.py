"""Imported in every trial's process of a run (see ``planted_bench``)."""

from dataclasses import replace

from adapters.base import Simulation

_spawn = Simulation.spawn


def _a_nanometre_off(simulation, brick):
    x, y, z = brick.position
    return _spawn(simulation, replace(brick, position=(x + 1e-9, y, z)))


Simulation.spawn = _a_nanometre_off
