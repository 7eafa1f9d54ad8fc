"""``prepare``: add the ghosts of free bodies to a model before its compilation."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any, TypeAlias

import mujoco

Spec: TypeAlias = Any
"""A ``mujoco.MjSpec``."""

SUFFIX = "__ghost"
"""End of a ghost's name, after the name of its body."""
TINY = 1e-300
"""Gravity compensation of a controlled body that has none in the model. A parked body needs compensation, and MuJoCo
computes no compensation if every body has 0. The value is too small to change a sum of forces."""
_COPIED = (
    "type", "size", "pos", "quat", "fromto", "meshname", "friction", "condim", "priority", "solref", "solimp",
    "solmix", "margin", "gap", "fitscale",
)  # fmt: skip


def prepare(spec: Spec, bodies: Collection[str] | None = None) -> Spec:
    """Add ghosts to a model, so that the extension can freeze bodies.

    Call the function before ``spec.compile()``. Each controlled body gets a ghost: an invisible mocap body with the
    same geoms. The ghost collides only while the body is frozen. Other bodies, joints, actuators and sensors keep their
    ids and their motions. A frozen body must be able to sleep. The function therefore enables MuJoCo's sleeping, but
    for frozen bodies only, unless the model has enabled sleeping.

    Args:
        spec: the model.
        bodies: names of the bodies to control; None for all bodies that can freeze. These bodies have a free joint as
            their only joint, a geom that collides, and no bodies below them. They have no explicit contact pair and no
            equality constraint. With None, the function gives names to bodies without a name.

    Returns:
        The same model.

    Raises:
        ValueError: if a body is unknown or cannot freeze, if no body can freeze, or if the model has ghosts already.
    """
    if any(body.name.endswith(SUFFIX) for body in spec.bodies):
        raise ValueError(
            "this model has ghosts already: call prepare() once, before spec.compile(); to add bodies later, keep the "
            "spec unprepared and prepare a copy of it, spec.copy()"
        )
    chosen = _free_bodies(spec) if bodies is None else [_checked(spec, name) for name in bodies]
    if not chosen:
        raise ValueError(
            "prepare() found no body that could freeze: omit the argument bodies, or name at least one body, and give "
            "the bodies of the stack a free joint (<freejoint/>), one geom or more, and no bodies below them"
        )
    _let_frozen_sleep(spec)
    for body in chosen:
        _add_ghost(spec, body)
    return spec


def _free_bodies(spec: Spec) -> list[Any]:
    """Return the bodies that can freeze; name bodies without a name."""
    chosen = [body for body in spec.worldbody.bodies if _reason_against(spec, body) is None]
    for number, body in enumerate(chosen):
        body.name = body.name or f"free_body_{number}"
    return chosen


def _checked(spec: Spec, name: str) -> Any:
    """Return a body by its name.

    Raises:
        ValueError: if the body is unknown or cannot freeze.
    """
    body = spec.body(name)
    if body is None:
        known = ", ".join(repr(body.name) for body in _free_bodies(spec))
        fix = f"pass names of bodies that can freeze: {known}" if known else "add the body, with a free joint"
        raise ValueError(f"this model has no body {name!r}: {fix}")
    reason = _reason_against(spec, body)
    if reason:
        raise ValueError(f"body {name!r} {reason}")
    return body


def _reason_against(spec: Spec, body: Any) -> str | None:
    """Return why a body cannot freeze; None if it can freeze."""
    if body.mocap or [joint.type for joint in body.joints] != [mujoco.mjtJoint.mjJNT_FREE]:
        return "has no free joint as its only joint: prepare free bodies only, because the port leaves robots alone"
    if body.bodies:
        return "carries other bodies: prepare bodies without bodies below them"
    if not any(geom.contype or geom.conaffinity for geom in body.geoms):
        return "collides with nothing: give one of its geoms a contype or a conaffinity above 0"
    names = {geom.name for geom in body.geoms if geom.name}
    if any(pair.geomname1 in names or pair.geomname2 in names for pair in spec.pairs):
        return (
            "has a geom in an explicit contact pair: delete the <pair>, because the pair acts also on the frozen body"
        )
    tied = {equality.name1 for equality in spec.equalities} | {equality.name2 for equality in spec.equalities}
    if body.name and body.name in tied:
        return "has an equality constraint: delete the constraint, because the constraint would pull the frozen body"
    return None


def _let_frozen_sleep(spec: Spec) -> None:
    """Enable MuJoCo's sleeping for frozen bodies only, unless the model has enabled sleeping."""
    flag = mujoco.mjtEnableBit.mjENBL_SLEEP.value
    if spec.option.enableflags & flag:
        return
    spec.option.enableflags |= flag
    for body in _roots(spec.worldbody):
        body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER


def _roots(parent: Any) -> Iterator[Any]:
    """Yield the roots of the kinematic trees below a body, because MuJoCo allows a sleep policy at roots only."""
    for body in parent.bodies:
        if body.joints:
            yield body
        else:
            yield from _roots(body)


def _add_ghost(spec: Spec, body: Any) -> None:
    """Add the ghost of a body, at the end of the world's bodies, so that other bodies keep their ids.

    The ghost excludes contacts with the bodies with which the body excludes contacts.
    """
    body.gravcomp = body.gravcomp or TINY
    ghost = spec.worldbody.add_body(name=body.name + SUFFIX, mocap=True, pos=body.pos, quat=body.quat)
    for geom in body.geoms:
        copied = {name: getattr(geom, name) for name in _COPIED}
        ghost.add_geom(**copied, contype=0, conaffinity=0, rgba=[0, 0, 0, 0], mass=0, density=0)
    for exclude in list(spec.excludes):
        names = exclude.bodyname1, exclude.bodyname2
        if body.name in names:
            other = names[names[0] == body.name]
            spec.add_exclude(bodyname1=ghost.name, bodyname2=other)
