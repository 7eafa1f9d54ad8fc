"""Ports to simulations that the user owns: ``attach`` an extension in one call.

The engines are optional. Each port is a module, which imports its engine. ``attach`` and ``stability_core.ports.NAME``
load this module on first use.
"""

from __future__ import annotations

import importlib
from collections.abc import Collection
from types import ModuleType
from typing import Any

from stability_core import extension
from stability_core.policies import Policy
from stability_core.ports.attachment import Attachment
from stability_core.ports.object_attachment import ObjectAttachment
from stability_core.ports.shared.shapes import compile_kernels
from stability_core.settings import Settings

__all__ = ["Attachment", "ObjectAttachment", "attach", "warm_up"]

ENGINES = {
    "pybullet": "pybullet",
    "mujoco": "mujoco",
    "sapien": "sapien",
    "rapier": "rapier3d",
    "pymunk": "pymunk",
    "dart": "dartpy",
}
"""Python package of each engine, by the name of its port and of the wheel's extra."""
_PORT_OF = {package: name for name, package in ENGINES.items()} | {"pybullet_utils": "pybullet"}
"""Name of the port, by the package that defines the class of a world."""
WITH_OBJECTS = ("pymunk", "dart")
"""Ports of engines whose bodies are objects without numbers."""


def attach(
    world: Any,
    bodies: Collection[Any] | None = None,
    policy: str | Policy = "equilibrium",
    settings: Settings | None = None,
) -> Attachment:
    """Attach the stability extension to a simulation that you own.

    Call ``update(dt)`` of the result after your steps of ``dt`` seconds. Other bodies, joints and robots keep their
    settings.

    Args:
        world: PyBullet's client id (an integer) or client object; MuJoCo's ``MjData``; SAPIEN's ``Scene`` or its
            ``physx_system``; Rapier's ``PhysicsWorld``; pymunk's ``Space``; DART's ``World``.
        bodies: the engine's ids of the bodies to control, or pymunk's bodies, or DART's skeletons; None for all bodies
            that can freeze, now and later.
        policy: a name of ``POLICIES``, or a policy of your own.
        settings: the tolerances.

    Returns:
        The attachment; for pymunk and DART an ``ObjectAttachment``, whose methods accept bodies.

    Raises:
        TypeError: if no port knows the engine of the world.
        ImportError: if Python does not find the package of the engine.
        ValueError: if a body cannot freeze, or the world has no gravity; the message names the fix.
        RuntimeError: if the world has an open attachment.
    """
    name = _engine_of(world)
    kind = ObjectAttachment if name in WITH_OBJECTS else Attachment
    return kind(_module(name).open_port(world, bodies), policy, settings)


def warm_up(policy: str = "equilibrium") -> float:
    """Compile the kernels of ``policy`` and of the ports, or read Numba's cache; return the time of the core [s].

    ``attach`` compiles the core and the ports on first use. Call this function where the wait matters least, because
    the compilation takes minutes, once per version.

    Raises:
        UnknownNameError: if ``POLICIES`` does not contain ``policy``.
    """
    seconds = extension.warm_up(policy)
    compile_kernels()
    return seconds


def _engine_of(world: object) -> str:
    """Return the name of the port for a world.

    Raises:
        TypeError: if no port knows the engine of the world.
    """
    package = type(world).__module__.split(".")[0]
    if isinstance(world, int) and not isinstance(world, bool):
        return "pybullet"
    if package in _PORT_OF:
        return _PORT_OF[package]
    raise TypeError(
        f"attach() cannot use {type(world).__qualname__} from {package}: pass PyBullet's client id, MuJoCo's MjData, "
        "SAPIEN's Scene, Rapier's PhysicsWorld, pymunk's Space or DART's World; for another engine write a port, "
        "see the tutorial"
    )


def _module(name: str) -> ModuleType:
    """Return the module of a port.

    Raises:
        ImportError: if Python does not find the package of the engine.
    """
    try:
        return importlib.import_module(f"stability_core.ports.{name}")
    except ModuleNotFoundError as error:
        if error.name != ENGINES[name]:
            raise
        raise ImportError(
            f"the port to {name} needs the package {ENGINES[name]}: pip install 'stability-core[{name}]'"
        ) from error


def __getattr__(name: str) -> ModuleType:
    """Load the module of a port on first use."""
    if name in ENGINES:
        return _module(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}: use one of the ports {', '.join(ENGINES)}")
