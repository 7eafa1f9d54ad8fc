"""Decide whether the bodies of a snapshot stand: exact statics of rigid bodies under Coulomb friction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stability_core.equilibrium.faces import NOISE, rolling_bodies
from stability_core.equilibrium.problem import Problem
from stability_core.equilibrium.verdict import Verdict, decide, takes_part
from stability_core.frame_arrays import contact_arrays, mass_arrays
from stability_core.port import GROUND, BoolArray, Contacts, FloatArray, IntArray, Masses
from stability_core.upright import rotation_to_upright
from stability_core.validation import (
    BAD_CONTACT,
    BAD_MASS,
    FLIPPED,
    LISTED_TWICE,
    UNKNOWN_BODY,
    check_ids,
    check_shapes,
    fault_of,
    first_bad_contact,
    first_bad_mass,
)

ROUNDING = 1e-12
"""Tolerance of the cosine in the comparison of a contact's slope with its friction angle, because a horizontal face
without friction must count as load-bearing."""


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """The result of statics for one snapshot."""

    verdict: Verdict
    """The verdict:

    - ``stable``: ``forces`` that arise from zero load hold the bodies;
    - ``unstable``: bodies fall by the motion ``mechanism``;
    - ``doubt``: the search proves neither, or the forces do not arise from zero load.
    """
    residual: float
    """Largest imbalance of a body, relative to the largest force on the body. A moment counts over the body's size, and
    for a rolling body only beyond its slack (see ``faces``)."""
    forces: FloatArray | None
    """Force [N] on ``body_b`` of each contact, shape (n, 3). The opposite force acts on ``body_a``. None if the verdict
    is ``unstable``, or if the search finds no forces."""
    mechanism: FloatArray | None
    """Virtual velocity [m/s] and angular velocity [rad/s] of each body, shape (m, 6), in the order of the masses.
    With z up, the greatest component of the scaled motion is 1 m/s, where an angular velocity counts times the size of
    its body. None unless the verdict is ``unstable``."""
    in_doubt: BoolArray
    """Mask of the bodies that loading from zero does not hold, or for which no proof exists, shape (m,). The mask is
    False for all bodies unless the verdict is ``doubt``."""

    @property
    def stable(self) -> bool:
        """True if the verdict is ``stable``."""
        return self.verdict == "stable"


def solve_equilibrium(contacts: Contacts, masses: Masses, gravity: Sequence[float] = (0.0, 0.0, -9.81)) -> Equilibrium:
    """Decide whether all bodies stay at rest.

    Every row of ``contacts`` counts as touching, at any separation and velocity. Leave out rows that do not touch. Only
    the ground is fixed. Except for rounding, the verdict does not depend on the scale of length, mass or gravity. For a
    body that touches only in points and lines, the contact points may be off by a millionth of its size (see
    ``faces``).

    - "stable": contact forces in the Coulomb cones hold the bodies (``forces``), and arise by themselves. Either
      vertical forces on load-bearing contacts suffice, or loading from zero prestress comes to rest (see ``loading``).
      If forces exist with nine tenths of the friction, loading must come to rest with this friction as well.
    - "unstable": no contact forces hold the bodies. The motion ``mechanism`` is the proof (see ``newton``). An
      equilibrium that needs a force of more than a million times the weight of all bodies does not count.
    - "doubt": forces exist but do not arise by themselves, or the search finds no proof. For example, two walls could
      hold a brick between them only if something pressed the walls together.

    A step takes O(n) to O(n w^2) for n bodies in layers of w bodies. A decision takes 5 to 20 steps, or 10 to 60
    steps if the bodies need friction.

    Args:
        contacts: the touching points. ``body_a`` and ``body_b`` are ``GROUND`` or occur in ``masses``.
        masses: all bodies that must stand. ``removed`` has no effect.
        gravity: gravity vector [m/s2], in any direction.

    Raises:
        ValueError: in one of these cases:

            - the contacts or masses are malformed, or a mass is infinite;
            - a contact names a body that ``masses`` does not list, or ``masses`` lists a body twice;
            - the normals of all contacts with the ground point from b to a;
            - gravity is zero, or not a finite vector.
    """
    index_a, index_b = _checked(contacts, masses)
    down = np.asarray(gravity, np.float64)
    strength = float(np.linalg.norm(down)) if down.shape == (3,) else np.nan
    if not (np.isfinite(strength) and strength > 0.0):
        raise ValueError(
            f"gravity must be three finite numbers [m/s2], not all zero, got {gravity}: pass a vector such as "
            "(0.0, 0.0, -9.81)"
        )
    _refuse_flipped(contacts, masses, index_a, index_b, -down / strength)
    upright = rotation_to_upright(-down / strength)
    snapshot, size = _problem(contacts, masses, index_a, index_b, upright, strength)

    verdict, forces, rest, residual = decide(snapshot, _is_level(snapshot))
    motion = None
    if verdict == "unstable":
        forces = None  # these forces do not hold the bodies
        motion = np.hstack([-rest[:, :3] @ upright, -rest[:, 3:] / size[:, None] @ upright]) / np.abs(rest).max()
    in_doubt = takes_part(rest) if verdict == "doubt" else np.zeros(len(masses.body), np.bool_)
    return Equilibrium(verdict, residual, None if forces is None else forces @ upright, motion, in_doubt)


def _checked(contacts: Contacts, masses: Masses) -> tuple[IntArray, IntArray]:
    """Return the index in ``masses`` of both bodies of each contact, -1 for the ground.

    Raises:
        ValueError: for malformed contacts or masses.
    """
    check_shapes(contacts, masses)
    check_ids("contacts.body_a", contacts.body_a)
    check_ids("contacts.body_b", contacts.body_b)
    check_ids("masses.body", masses.body)
    row = first_bad_contact(contact_arrays(contacts))
    if row >= 0:
        raise fault_of(BAD_CONTACT, row, contacts, masses)
    row = first_bad_mass(mass_arrays(masses))
    if row >= 0:
        raise fault_of(BAD_MASS, row, contacts, masses)
    kinematic = np.flatnonzero(np.isinf(masses.mass))
    if len(kinematic):
        raise ValueError(
            f"masses row {kinematic[0]}: body {masses.body[kinematic[0]]} must have a finite mass, got inf: remove "
            f"the row, and replace the id of the body in the contacts by the id {GROUND} of the ground"
        )
    order = np.argsort(masses.body, kind="stable")
    listed = masses.body[order]
    twice = np.flatnonzero(listed[1:] == listed[:-1])
    if len(twice):
        raise fault_of(LISTED_TWICE, int(order[twice[0] + 1]), contacts, masses)
    order, listed = np.append(order, -1), np.append(listed, GROUND)  # the ground, and the end of the search
    indices = []
    for bodies in (contacts.body_a, contacts.body_b):
        place = np.where(bodies == GROUND, -1, np.searchsorted(listed[:-1], bodies))
        unknown = np.flatnonzero(listed[place] != bodies)
        if len(unknown):
            raise fault_of(UNKNOWN_BODY, int(unknown[0]), contacts, masses)
        indices.append(order[place])
    return indices[0], indices[1]


def _refuse_flipped(contacts: Contacts, masses: Masses, index_a: IntArray, index_b: IntArray, up: FloatArray) -> None:
    """Check that the normals of the contacts with the ground do not all point from b to a.

    With flipped normals, the ground would pull all bodies down.

    Raises:
        ValueError: if the normals of all contacts with the ground point from b to a. The message names one contact.
    """
    rows = np.flatnonzero((index_a < 0) | (index_b < 0))
    sign = np.where(index_a[rows] < 0, 1.0, -1.0)
    inward = sign[:, None] * contacts.normal[rows]
    to_center = masses.center_of_mass[np.maximum(index_a[rows], index_b[rows])] - contacts.point[rows]
    is_flipped = (inward @ up < 0.0) & (to_center @ up > 0.0) & ((inward * to_center).sum(axis=1) < 0.0)
    if len(rows) and is_flipped.all():
        raise fault_of(FLIPPED, int(rows[0]), contacts, masses)


def _sizes(contacts: Contacts, masses: Masses, index_a: IntArray, index_b: IntArray) -> FloatArray:
    """Return the longest lever of each body [m], 1 m without contacts, then infinity for the ground, shape (n + 1,)."""
    size = np.zeros(len(masses.body) + 1)
    for index in (index_a, index_b):
        moves = index >= 0
        lever = contacts.point[moves] - masses.center_of_mass[index[moves]]
        np.maximum.at(size, index[moves], np.linalg.norm(lever, axis=1))
    size[size == 0.0] = 1.0
    size[-1] = np.inf
    return size


def _problem(
    contacts: Contacts, masses: Masses, index_a: IntArray, index_b: IntArray, upright: FloatArray, gravity: float
) -> tuple[Problem, FloatArray]:
    """Return the statics problem with z up and dimensionless levers, and the size of each body [m], shape (n,).

    A body's size is its longest lever, so that forces and moments have the same scale in any unit of length.
    """
    n = len(masses.body)
    size = _sizes(contacts, masses, index_a, index_b)
    levers: list[FloatArray] = []
    for index in (index_a, index_b):
        lever = np.zeros((len(contacts), 3))
        moves = index >= 0
        lever[moves] = (
            (contacts.point[moves] - masses.center_of_mass[index[moves]]) @ upright.T / size[index[moves], None]
        )
        levers.append(lever)
    normal = contacts.normal @ upright.T
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    load = np.zeros((n, 6))
    load[:, 2] = masses.mass * gravity
    lever_a, lever_b = levers
    friction = np.asarray(contacts.friction, np.float64)
    slack = NOISE * load[:, 2] * rolling_bodies(index_a, index_b, contacts.point, normal, size)
    return Problem(index_a, index_b, lever_a, lever_b, normal, friction, load, slack), size[:-1]


def _is_level(problem: Problem) -> BoolArray:
    """Return the mask of the load-bearing contacts, shape (m,): their cones contain the vertical."""
    level: BoolArray = np.abs(problem.normal[:, 2]) >= 1.0 / np.sqrt(1.0 + problem.friction**2) - ROUNDING
    return level
