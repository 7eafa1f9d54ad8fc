"""Imported in every trial's process of a run (see ``planted_bench``)."""

from adapters.base import Simulation

_spawn = Simulation.spawn


def _careless(simulation, brick):
    """The twelfth brick, the last of three levels of a 4-stack, is thrown rather than laid."""
    body = _spawn(simulation, brick)
    if body == 11:
        simulation.push(body, (0.01, 0.0, 0.0))
    return body


Simulation.spawn = _careless
