"""The engines: which file, class and package each one has. An engine's file is imported only when it is first used."""

from __future__ import annotations

import importlib.metadata
from dataclasses import dataclass

from scenarios.lookup import look_up


@dataclass(frozen=True, slots=True)
class Entry:
    """Where an engine is to be found."""

    module: str
    simulation: str
    package: str
    """The distribution that brings the engine, and whose version is the engine's."""


ENGINES: dict[str, Entry] = {
    "bullet": Entry("adapters._bullet", "BulletSimulation", "pybullet"),
    "mujoco": Entry("adapters._mujoco", "MujocoSimulation", "mujoco"),
    "dart": Entry("adapters._dart", "DartSimulation", "dartpy"),
    "physx": Entry("adapters._physx", "PhysxSimulation", "sapien"),
    "pymunk": Entry("adapters._pymunk", "PymunkSimulation", "pymunk"),
    "rapier": Entry("adapters._rapier", "RapierSimulation", "rapier3d"),
    "box3d": Entry("adapters._box3d", "Box3dSimulation", "robox3d"),
}


def engine_version(engine: str) -> str:
    """Return the version of an engine's package, which stands in every record.

    Raises:
        UnknownNameError: if there is no such engine.
        PackageNotFoundError: if its package is missing.
    """
    return importlib.metadata.version(look_up("engine", engine, ENGINES).package)
