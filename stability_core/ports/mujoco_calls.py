"""Contacts in MuJoCo's arrays, for the port and for the suite's adapter.

MuJoCo lists the contacts at the start of the latest step, and ``cvel`` holds the velocities at that time. Contacts and
velocities together give the approach speed before the solver stops the bodies.
"""

from __future__ import annotations

import copy
from typing import Any, TypeAlias

import mujoco
import numpy as np

from stability_core.port import FloatArray, IntArray
from stability_core.ports.mujoco_release import SLEEPING_OR_SPECULATIVE
from stability_core.ports.shared.vectors import cross

Model: TypeAlias = Any
"""A compiled ``mujoco.MjModel``."""
Data: TypeAlias = Any
"""A ``mujoco.MjData``."""
Found: TypeAlias = Any
"""The contacts of a ``mujoco.MjData``."""


def collided_copy(model: Model, data: Data) -> Data:
    """Return a copy of the state with the contacts at the present poses, also of sleeping bodies."""
    copied = copy.copy(data)
    flags = model.opt.enableflags
    model.opt.enableflags = flags & ~SLEEPING_OR_SPECULATIVE
    mujoco.mj_kinematics(model, copied)
    mujoco.mj_comPos(model, copied)
    mujoco.mj_collision(model, copied)
    model.opt.enableflags = flags
    return copied


def relative_velocities(model: Model, data: Data, bodies: IntArray, points: FloatArray) -> FloatArray:
    """Return velocities (n, 3) [m/s] of the second body relative to the first, at the start of the latest step.

    Args:
        model: the compiled model.
        data: its state, or a ``collided_copy`` of the state.
        bodies: MuJoCo's ids of both bodies of each contact, shape (n, 2).
        points: contact points [m] in the world's frame, shape (n, 3).
    """
    twists = data.cvel[bodies]  # angular, then linear at the centre of mass of the body's tree
    arms = points[:, None] - data.subtree_com[model.body_rootid[bodies]]
    velocities: FloatArray = twists[:, :, 3:] + cross(twists[:, :, :3], arms)
    return velocities[:, 1] - velocities[:, 0]


def contact_forces(model: Model, data: Data, rows: IntArray) -> FloatArray:
    """Return the forces (n, 3) [N] on the second body at ``rows`` (n,) of MuJoCo's contacts in the latest step.

    The forces are in the world's frame. A contact without a constraint has zero force.

    The constraint forces of a contact depend on the model's friction cone and on the contact's dimension d:

    - Elliptic cone: the normal force, then two tangential forces, then d - 3 moments.
    - Pyramid: a force along each of 2 (d - 1) edges, in pairs n + mu t and n - mu t. n is the unit normal, t a unit
      tangent, and mu the coefficient of friction.
    - Frictionless, d = 1: the normal force.
    """
    found = data.contact
    forces = np.zeros((len(rows), 3))
    address, dim = found.efc_address[rows], found.dim[rows]
    for size in np.unique(dim).tolist():
        solved = np.flatnonzero((address >= 0) & (dim == size))
        first = address[solved, None]
        if size == 1:
            forces[solved, :1] = data.efc_force[first]
        elif model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC:
            forces[solved] = data.efc_force[first + np.arange(3)]
        else:
            edges = data.efc_force[first + np.arange(2 * (size - 1))]
            forces[solved, 0] = edges.sum(axis=1)
            forces[solved, 1:] = found.friction[rows[solved], :2] * (edges[:, :4:2] - edges[:, 1:4:2])
    in_world: FloatArray = np.einsum("ni,nij->nj", forces, found.frame[rows].reshape(-1, 3, 3))
    return in_world


def speculative_rows(found: Found, rows: IntArray) -> IntArray:
    """Return the places in ``rows`` (n,) of speculative contacts.

    A speculative contact has a force before the bodies touch. MuJoCo does not measure its distance.
    """
    places: IntArray = np.flatnonzero((found.efc_address[rows] >= 0) & (found.dist[rows] > found.includemargin[rows]))
    return places


def fall(model: Model, falls: np.ndarray[Any, np.dtype[np.bool_]]) -> FloatArray:
    """Return the change (n, 3) [m/s] by gravity, in one step, of the velocity of each second body against the first.

    A pair with a speculative contact falls freely for that step, because the bodies do not touch yet.

    Args:
        model: the compiled model.
        falls: mask of the bodies that fall, shape (n, 2) for n pairs.
    """
    gained: FloatArray = model.opt.gravity * model.opt.timestep
    both = falls.astype(np.float64)
    changes: FloatArray = (both[:, 1:] - both[:, :1]) * gained
    return changes
