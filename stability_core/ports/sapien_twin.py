"""Contacts of the present poses in SAPIEN, which cannot collide without a step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import sapien
from sapien import physx

from stability_core.ports.sapien_calls import Component
from stability_core.ports.sapien_shapes import copy_of

INSTANT_S = 1e-6
"""Step [s] of the second world: the step is short, so that the solver closes no gap."""


@contextmanager
def present_contacts(components: Mapping[int, Component]) -> Iterator[tuple[list[Any], dict[Component, int]]]:
    """Yield the contacts at the present poses, and the id of each component in these contacts.

    Both values are valid within the context. A second world with copies of the bodies, weightless and at rest, makes
    one step of ``INSTANT_S``. PhysX detects contacts at the start of a step. The first world does not change.

    Args:
        components: component of each body, by id. Bodies that are neither dynamic nor static become kinematic.
    """
    system = physx.PhysxCpuSystem()
    scene = sapien.Scene([system])
    ids: dict[Component, int] = {}
    try:
        for body, component in components.items():
            copied = _copy_of(component)
            entity = sapien.Entity()
            entity.add_component(copied)
            entity.pose = component.entity_pose
            scene.add_entity(entity)
            ids[copied] = body
        system.timestep = INSTANT_S
        system.step()
        yield system.get_contacts(), ids
    finally:
        scene.clear()


def _copy_of(component: Component) -> Component:
    """Return a weightless copy of a body."""
    is_static = isinstance(component, physx.PhysxRigidStaticComponent)
    copied = physx.PhysxRigidStaticComponent() if is_static else physx.PhysxRigidDynamicComponent()
    for shape in component.collision_shapes:
        copied.attach(copy_of(shape))
    if not is_static:
        copied.disable_gravity = True
        copied.kinematic = getattr(component, "kinematic", True)
    return copied
