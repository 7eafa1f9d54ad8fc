"""Residuals of reported contact forces against the laws of contact: Coulomb's cone, and no force across a gap."""

from __future__ import annotations

import numpy as np

from stability_core.port import GROUND, Contacts, FloatArray


def ground_force(contacts: Contacts) -> FloatArray:
    """Return the total force (3,) [N] of the ground and the fixed boxes on the bodies.

    Raises:
        ValueError: if the contacts have no forces.
    """
    force = _forces(contacts)
    on_b, on_a = contacts.body_a == GROUND, contacts.body_b == GROUND
    total: FloatArray = force[on_b].sum(axis=0) - force[on_a].sum(axis=0)
    return total


def cone_excess(contacts: Contacts) -> FloatArray:
    """Return the excess [N] of friction over its bound mu f at each contact, shape (n,); 0 inside the cone.

    The bound is the coefficient of friction mu times the normal force f. At a contact with a pulling normal force the
    excess is the sum of its friction and mu times the pull.

    Raises:
        ValueError: if the contacts have no forces.
    """
    force = _forces(contacts)
    normal = np.einsum("ij,ij->i", force, contacts.normal)
    friction = np.linalg.norm(force - normal[:, None] * contacts.normal, axis=1)
    excess: FloatArray = np.maximum(0.0, friction - contacts.friction * normal)
    return excess


def complementarity(contacts: Contacts, weight: float, length: float) -> FloatArray:
    """Return the natural residual |min(f / weight, s / length)| of each contact, shape (n,), without unit.

    With the normal force f and the separation s, a residual of 0 means 0 <= f, 0 <= s and f s = 0. The residual is

    - the larger of overlap and pull, if the bodies overlap or the force pulls;
    - the smaller of force and gap, if the force presses and the bodies are apart;
    - NaN if the engine does not report the separation.

    Args:
        contacts: contacts with forces.
        weight: unit of force [N]: the weight of a brick.
        length: unit of length [m]: the thickness of a brick.

    Raises:
        ValueError: if the contacts have no forces.
    """
    normal = np.einsum("ij,ij->i", _forces(contacts), contacts.normal)
    residual: FloatArray = np.abs(np.minimum(normal / weight, contacts.separation / length))
    return residual


def _forces(contacts: Contacts) -> FloatArray:
    if contacts.force is None:
        raise ValueError(
            "contacts.force must hold forces, got None: use an engine whose capabilities state forces, and a profile "
            "without 'forces=0'"
        )
    return contacts.force
