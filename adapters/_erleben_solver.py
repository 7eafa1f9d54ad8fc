"""Shock propagation: the contact problem of a step, whole at first, then layer by layer from the ground up.

One step of length h, with the fraction phi:

    1. dynamics of all bodies over phi h
    2. for each layer from the ground up, with its floor fixed:
           displace the passengers to remove the overlaps of the layer's contacts (first-order correction, no velocity)
           dynamics of the passengers over (1 - phi) h

The module ``reference.layers`` defines layers, floors and passengers. Dynamics means: add gravity and steady forces,
then find impulses lambda by projected Gauss-Seidel sweeps. Each sweep refreshes the friction bounds. The scaled
velocities w, the rows J and the driven velocities drive come from ``reference.contact_rows``. The gap is g, the time of
the dynamics t, and the coefficient of friction mu:

    0 <= lambda_n  complementary to  J_n w + drive + g / t >= 0,      |lambda_t| <= mu lambda_n along each tangent
    lambda_i <- clamp(lambda_i - (J_i w + drive_i + g_i / t) / |J_i|^2)

With phi = 0 no layer carries the weight above, because this weight acts on a fixed floor.

Source: K. Erleben, "Velocity-based shock propagation for multibody dynamics animation", ACM Transactions on Graphics
26(2), 2007, as in the author's own code in OpenTissue (class "constraint based shock propagation"). This module differs
in two points. The term g / t lets a point that does not touch yet close its gap g within the time t. The restitution is
0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from adapters.reference.contact_rows import ContactRows
from adapters.reference.layers import heights_of, layers_of
from stability_core.port import FloatArray, IntArray

MaskArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class ErlebenSolver:
    """Shock propagation with the settings of a profile."""

    friction: float
    """Coefficient of every contact."""
    fraction: float
    """The fraction phi of the step that the dynamics of all bodies cover."""
    sweeps: int
    """Number of Gauss-Seidel sweeps of each problem."""

    def solve(self, problem: ContactRows) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return velocities (m, 6), impulses (n, 3) along the rows, and corrections (m, 6).

        The velocities and corrections are scaled velocities. Impulses have the unit ``problem.impulse_unit``.
        """
        velocity = problem.start - problem.pull
        correction, impulse = np.zeros_like(velocity), np.zeros((len(problem), 3))
        height = heights_of(problem.body, len(velocity))
        layer = layers_of(problem.body, height)
        _propagate(
            problem.body, problem.jacobian, problem.drive, problem.gap, problem.pull, height, layer,
            np.argsort(layer, kind="stable"), np.argsort(height, kind="stable"), self.friction, self.fraction,
            self.sweeps, velocity, correction, impulse,
        )  # fmt: skip
        return velocity, impulse, correction


@numba.njit(cache=True)
def _propagate(
    body: IntArray,
    jacobian: FloatArray,
    drive: FloatArray,
    gap: FloatArray,
    pull: FloatArray,
    height: IntArray,
    layer: IntArray,
    by_layer: IntArray,
    by_height: IntArray,
    friction: float,
    fraction: float,
    sweeps: int,
    velocity: FloatArray,
    correction: FloatArray,
    impulse: FloatArray,
) -> None:
    """Advance ``velocity`` (m, 6) through a step; add impulses (n, 3), and displacements to ``correction`` (m, 6).

    Args:
        body: live bodies a and b of each contact, -1 for a body that contacts do not move, shape (n, 2).
        jacobian: rows of each contact, shape (n, 3, 2, 6).
        drive: velocities along the rows from bodies that the host moves, shape (n, 3).
        gap: gaps, divided by the distance that the velocity unit covers in a step, shape (n,).
        pull: velocities that gravity and steady forces add in a step, shape (m, 6).
        height: height of each body, shape (m,).
        layer: layer of each contact, shape (n,).
        by_layer: contacts in the order of their layers, shape (n,).
        by_height: bodies in the order of their heights, shape (m,).
        friction: coefficient of every contact.
        fraction: the fraction phi.
        sweeps: number of sweeps of each problem.
        velocity: velocities before the step.
        correction: zeros.
        impulse: zeros.
    """
    free = np.ones(len(velocity), np.bool_)
    if fraction > 0.0:
        velocity += fraction * pull
    room = np.maximum(gap, 0.0)
    _sweep(body, jacobian, drive, room, by_layer, free, friction, sweeps, velocity, impulse)
    moved = fraction * velocity
    left = gap.copy()
    if fraction > 0.0:
        for c in range(len(body)):
            left[c] += fraction * (_along(body, jacobian, c, 0, velocity) + drive[c, 0])
    free[:] = False
    contact, passenger = 0, 0
    while passenger < len(by_height):
        floor = height[by_height[passenger]] - 1
        begin = passenger
        while passenger < len(by_height) and height[by_height[passenger]] == floor + 1:
            free[by_height[passenger]] = True
            velocity[by_height[passenger]] += (1.0 - fraction) * pull[by_height[passenger]]
            passenger += 1
        first = contact
        while contact < len(by_layer) and layer[by_layer[contact]] == floor:
            contact += 1
        members = by_layer[first:contact]
        _separate(body, jacobian, gap, members, free, sweeps, correction)
        room = np.maximum(left, 0.0) / max(1.0 - fraction, 1e-12)
        _sweep(body, jacobian, drive, room, members, free, friction, sweeps, velocity, impulse)
        for k in range(begin, passenger):
            free[by_height[k]] = False
    # The pose advances by the final velocity for the whole step; the difference in the first part is a displacement.
    correction += moved - fraction * velocity


@numba.njit(cache=True)
def _along(body: IntArray, jacobian: FloatArray, c: int, k: int, velocity: FloatArray) -> float:
    """Return the velocity along row ``k`` of contact ``c``, without the velocities of bodies that the host moves."""
    total = 0.0
    for side in range(2):
        i = body[c, side]
        if i >= 0:
            for j in range(6):
                total += jacobian[c, k, side, j] * velocity[i, j]
    return total


@numba.njit(cache=True)
def _stiffness(body: IntArray, jacobian: FloatArray, c: int, k: int, free: MaskArray) -> float:
    """Return |J|^2 of row ``k`` of contact ``c``, summed over the free bodies."""
    total = 0.0
    for side in range(2):
        if body[c, side] >= 0 and free[body[c, side]]:
            for j in range(6):
                total += jacobian[c, k, side, j] ** 2
    return total


@numba.njit(cache=True)
def _push(
    body: IntArray, jacobian: FloatArray, c: int, k: int, free: MaskArray, amount: float, velocity: FloatArray
) -> None:
    """Apply the impulse ``amount`` along row ``k`` to the free bodies of contact ``c``."""
    for side in range(2):
        i = body[c, side]
        if i >= 0 and free[i]:
            for j in range(6):
                velocity[i, j] += amount * jacobian[c, k, side, j]


@numba.njit(cache=True)
def _sweep(
    body: IntArray,
    jacobian: FloatArray,
    drive: FloatArray,
    room: FloatArray,
    members: IntArray,
    free: MaskArray,
    friction: float,
    sweeps: int,
    velocity: FloatArray,
    impulse: FloatArray,
) -> None:
    """Apply projected Gauss-Seidel sweeps to the contacts ``members``, from zero impulses."""
    own = np.zeros((len(members), 3))
    stiffness = np.empty((len(members), 3))
    for m in range(len(members)):
        for k in range(3):
            stiffness[m, k] = _stiffness(body, jacobian, members[m], k, free)
    for _ in range(sweeps):
        for m in range(len(members)):
            c = members[m]
            for k in range(3):
                if stiffness[m, k] < 1e-12:
                    continue
                rate = _along(body, jacobian, c, k, velocity) + drive[c, k]
                if k == 0:
                    wanted = max(0.0, own[m, 0] - (rate + room[c]) / stiffness[m, 0])
                else:
                    bound = friction * own[m, 0]
                    wanted = min(max(own[m, k] - rate / stiffness[m, k], -bound), bound)
                _push(body, jacobian, c, k, free, wanted - own[m, k], velocity)
                own[m, k] = wanted
    for m in range(len(members)):
        for k in range(3):
            impulse[members[m], k] += own[m, k]


@numba.njit(cache=True)
def _separate(
    body: IntArray,
    jacobian: FloatArray,
    gap: FloatArray,
    members: IntArray,
    free: MaskArray,
    sweeps: int,
    correction: FloatArray,
) -> None:
    """Displace the free bodies by Gauss-Seidel sweeps without friction, to remove the overlaps of ``members``."""
    own = np.zeros(len(members))
    deepest = 0.0
    for m in range(len(members)):
        deepest = min(deepest, gap[members[m]])
    if deepest == 0.0:
        return
    for _ in range(sweeps):
        for m in range(len(members)):
            c = members[m]
            stiffness = _stiffness(body, jacobian, c, 0, free)
            if stiffness < 1e-12:
                continue
            rate = 0.0
            for side in range(2):
                i = body[c, side]
                if i >= 0 and free[i]:
                    for j in range(6):
                        rate += jacobian[c, 0, side, j] * correction[i, j]
            wanted = max(0.0, own[m] - (rate + gap[c]) / stiffness)
            _push(body, jacobian, c, 0, free, wanted - own[m], correction)
            own[m] = wanted
