"""Adapters with a planted fault, and what a check of the conformance suite must say about them."""

import pytest

from adapters._bullet import BulletSimulation
from adapters.conformance import Check, ConformanceError, Rig
from adapters.port import EnginePort


def assert_caught(broken: type[BulletSimulation | EnginePort], check: Check) -> None:
    """Fail unless the check raises an error for the adapter of Bullet, or for its port, with the fault."""
    simulation = broken
    if issubclass(broken, EnginePort):
        simulation = type(broken.__name__, (BulletSimulation,), {"port_type": broken})
    rig = Rig(lambda world: simulation(BulletSimulation.profiles["game"], world, "off", ()), simulation.capabilities)
    with pytest.raises(ConformanceError):
        check.run_in(rig)
