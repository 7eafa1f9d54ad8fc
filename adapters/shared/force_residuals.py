"""How far reported contact forces are from what contacts allow: Coulomb's cone, and no force across a gap."""

from __future__ import annotations

import numpy as np

from stability_core.port import GROUND, Contacts, FloatArray


def ground_force(contacts: Contacts) -> FloatArray:
    """Return the force (3,) [N] with which all that never moves acts on the bodies.

    Raises:
        ValueError: if the contacts have no forces.
    """
    force = _forces(contacts)
    on_b, on_a = contacts.body_a == GROUND, contacts.body_b == GROUND
    total: FloatArray = force[on_b].sum(axis=0) - force[on_a].sum(axis=0)
    return total


def cone_excess(contacts: Contacts) -> FloatArray:
    """Return by how much the friction at each contact exceeds mu times its normal force, shape (n,) [N]; 0 inside.

    A contact that pulls allows no friction, so that all of its friction counts, and mu times the pull.

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

    With f the normal force and s the separation, 0 <= f, 0 <= s and f s = 0 hold where it is 0. It is the overlap of
    what overlaps, the pull of what pulls, and the lesser of force and gap of what is apart. NaN where an engine does
    not report the separation.

    Args:
        contacts: with forces.
        weight: unit of force [N]: that of a brick.
        length: unit of length [m]: the thickness of a brick.

    Raises:
        ValueError: if the contacts have no forces.
    """
    normal = np.einsum("ij,ij->i", _forces(contacts), contacts.normal)
    residual: FloatArray = np.abs(np.minimum(normal / weight, contacts.separation / length))
    return residual


def _forces(contacts: Contacts) -> FloatArray:
    if contacts.force is None:
        raise ValueError("these contacts have no forces: ask only engines whose capabilities report them")
    return contacts.force
