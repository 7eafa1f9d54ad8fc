"""Ports to simulations that the user owns, and ``attach``, which attaches an extension in one call.

The engines are optional. The module of a port imports its engine. ``attach``, or a read of the attribute
``stability_core.ports.NAME``, loads the port's module on first use.
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
"""Python package of each engine, by the name of its port. The wheel's extra has the name of the port."""
_PORT_OF = {package: name for name, package in ENGINES.items()} | {"pybullet_utils": "pybullet"}
"""Name of the port, by the top-level package that defines the class of a world."""
WITH_OBJECTS = ("pymunk", "dart")
"""Ports of engines whose bodies are objects without numbers."""


def attach(
    world: Any,
    bodies: Collection[Any] | None = None,
    policy: str | Policy = "equilibrium",
    settings: Settings | None = None,
) -> Attachment:
    """Attach the stability extension to a simulation that you own.

    Call ``update(dt)`` of the result after your steps of ``dt`` seconds in all. Joints, robots and other bodies outside
    the extension's control keep their settings.

    Args:
        world: PyBullet's client id (an integer) or client object; MuJoCo's ``MjData``; SAPIEN's ``Scene`` or its
            ``physx_system``; Rapier's ``PhysicsWorld``; pymunk's ``Space``; DART's ``World``.
        bodies: the bodies to control; None for all bodies that can freeze, now and later. In MuJoCo, None means all
            bodies with a ghost. The bodies have these forms:

            - PyBullet: body ids;
            - MuJoCo: body ids or names;
            - SAPIEN: ``entity.per_scene_id``;
            - Rapier: ``id_of(handle)`` of ``stability_core.ports.rapier``;
            - pymunk: ``pymunk.Body``;
            - DART: skeletons or body nodes.
        policy: a name of ``POLICIES``, or a policy of your own.
        settings: the tolerances; None for the default tolerances.

    Returns:
        The attachment; for pymunk and DART an ``ObjectAttachment``, whose methods accept bodies.

    Raises:
        TypeError: if the world, or an object in ``bodies``, has a type that no port can use.
        ImportError: if Python cannot import the package of the engine.
        ValueError: if a body cannot freeze, the world has no gravity, or the port cannot follow the world; the message
            names the fix.
        KeyError: if a body is not in the world (DART).
        UnknownNameError: if ``POLICIES`` does not contain ``policy``.
        RuntimeError: if the world has an open attachment, or is inside a step (pymunk).
    """
    name = _engine_of(world)
    kind = ObjectAttachment if name in WITH_OBJECTS else Attachment
    return kind(_module(name).open_port(world, bodies), policy, settings)


def warm_up(policy: str = "equilibrium") -> float:
    """Compile the kernels of ``policy`` and of contact areas, or read Numba's cache.

    ``attach`` compiles these kernels on first use. Call this function where the wait matters least, because the
    compilation takes minutes, once per version.

    Returns:
        The time [s] of the policy's kernels; 0 if this process has compiled or read the kernels before.

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
        ImportError: if Python cannot import the package of the engine.
    """
    try:
        return importlib.import_module(f"stability_core.ports.{name}")
    except ModuleNotFoundError as error:
        if error.name != ENGINES[name]:
            raise
        raise ImportError(
            f"the port to {name} needs the package {ENGINES[name]}: install the package with pip install "
            f"'stability-core[{name}]'"
        ) from error


def __getattr__(name: str) -> ModuleType:
    """Return the module of the port ``name``, and load the module on first use.

    Raises:
        AttributeError: if no port has this name.
        ImportError: if Python cannot import the package of the engine.
    """
    if name in ENGINES:
        return _module(name)
    *others, last = ENGINES
    ports = f"{', '.join(others)} or {last}"
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}: use one of the ports {ports}")
