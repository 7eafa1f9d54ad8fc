"""The leaning test (Thomsen and Kraus 2015, Eqs 3 and 5-7): a body stands on one contact and leans on a second contact.

The paper's rule has a known weakness: the rule assumes that friction at the upper contact holds as much weight as
possible. Therefore the rule accepts some inverted Vs that must slip, with planks at 50 to 65 deg to the ground.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray
from stability_core.stack import NONE, Graph, count_patches, hull_of
from stability_core.stack_mass import nearest_vertex, pivot_of


@compiled
def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@compiled
def _dot(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@compiled
def _length(a: FloatArray) -> float:
    return float(np.sqrt(_dot(a, a)))


@compiled
def torque_induced_force(weight: FloatArray, center: FloatArray, pivot: FloatArray, contact: FloatArray) -> FloatArray:
    """Return the force [N], (3,), that gravity's torque about the pivot exerts on the leaning contact.

    The torque is T = (C_stack - P_pivot) x G (Eq. 3). The force is perpendicular to the lever r = C_contact - P_pivot,
    along T x r, so that |F| = |T| / |r| (Eq. 5 with sin(theta) = 1). If T x r is zero, the force is zero.

    Args:
        weight: gravitational force G on the body and its loads [N], shape (3,).
        center: C_stack [m], at which G acts, shape (3,).
        pivot: P_pivot [m], shape (3,).
        contact: C_contact [m], the centre of the leaning contact's area, shape (3,).
    """
    torque = _cross(center - pivot, weight)
    lever = contact - pivot
    direction = _cross(torque, lever)
    if _length(direction) == 0.0:
        return np.zeros(3)
    return direction * (_length(torque) / (_length(lever) * _length(direction)))


@compiled
def split_force(force: FloatArray, normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the normal force and the sliding force of a force [N] on a contact, each (3,).

    The normal force is the projection onto the inverted normal, or zero if the force pulls away. The sliding force is
    F_sliding = F - F_normal.

    Args:
        force: force F of the body on the contact [N], shape (3,).
        normal: unit normal of the contact towards the body, shape (3,).
    """
    normal_force = normal * min(0.0, _dot(force, normal))
    return normal_force, force - normal_force


@compiled
def holds_on_pivot(
    weight: FloatArray,
    force: FloatArray,
    normal: FloatArray,
    friction: float,
    pivot_normal: FloatArray,
    pivot_friction: float,
) -> bool:
    """Return True if the pivot does not slip under its part of the load (Eqs 6 and 7).

    The leaning contact bears the normal force F_normal and, by friction, a force F_friction along the sliding force:

    |F_friction| = mu |F_normal|    (Eq. 6)

    The pivot bears the rest of the weight G:

    F_pivot = -F_normal + G - F_friction    (Eq. 7)

    The test requires that the greatest friction at the pivot exceeds the sliding force of F_pivot.

    Args:
        weight: gravitational force G on the body and its loads [N], shape (3,).
        force: torque-induced force on the leaning contact [N], shape (3,).
        normal: unit normal of the leaning contact towards the body, shape (3,).
        friction: Coulomb coefficient mu of the leaning contact.
        pivot_normal: unit normal of the pivot towards the body, shape (3,).
        pivot_friction: Coulomb coefficient of the pivot.
    """
    normal_force, sliding = split_force(force, normal)
    friction_force = np.zeros(3)
    if _length(sliding) > 0.0:
        friction_force = sliding * (friction * _length(normal_force) / _length(sliding))
    on_pivot = weight - normal_force - friction_force
    pivot_normal_force, pivot_sliding = split_force(on_pivot, pivot_normal)
    return bool(pivot_friction * _length(pivot_normal_force) > _length(pivot_sliding))


@compiled
def leans_stably(graph: Graph, body: int, gravity: float) -> bool:
    """Return True if a body with its loads passes the paper's leaning test, which requires exactly two patches.

    Args:
        graph: the stack.
        body: row of a body with up-to-date patches.
        gravity: gravitational acceleration [m/s2], positive.
    """
    if count_patches(graph, body) != 2:
        return False
    at = pivot_of(graph, body)
    other = graph.bodies[body].first_support
    if other == at:
        other = graph.patches[at].next_support
    if other == NONE:
        return False
    foot, contact = graph.patches[at], graph.patches[other]
    center = graph.bodies[body].stack_center
    weight = np.array([0.0, 0.0, -gravity * graph.bodies[body].stack_mass])
    pivot = nearest_vertex(hull_of(foot), center)
    force = torque_induced_force(weight, center, pivot, contact.center)
    return holds_on_pivot(weight, force, contact.normal, contact.friction, foot.normal, foot.friction)
