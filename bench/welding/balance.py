"""The local test of equilibrium: contact forces within their friction cones must hold one body and its load.

For a body with load w (force and moment about its centre), and with edges d_j of the friction cones of its contacts as
wrenches, the test solves

    minimise  |r|^2 + ridge |f|^2   over f >= 0,   with r = sum_j f_j d_j + w

Forces are in units of the load, and moments in units of the load times the body's size. The body is in equilibrium if
|r| is small. The ridge makes the forces unique, so that a body on several supports shares its load among all of them.

The dual problem has six unknowns y, however many contacts there are:

    f = max(0, -D^T y) / ridge,     y - w - D f = 0,     r = y

Newton's method solves it. Its derivative is I + D_+ D_+^T / ridge, with the edges D_+ whose force is positive.

The load is one of two:

- own: the body's own weight. Every contact may push the body, also a contact with a body above.
- carried: the body's weight, and the weights that it carries, as in Eqs 1 to 5 of Thomsen and Kraus. A contact is
  load-bearing if its friction cone contains the vertical. The test proceeds from the top down along these contacts. The
  vertical part of each force on a load-bearing contact of a tested body is a load of the body below, at the place of
  the contact. This contact pushes the body below in no other way. All other contacts push both of their bodies, as with
  the own weight.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from stability_core.port import BoolArray, FloatArray, IntArray

RIDGE = 1e-5
"""Weight of the forces' squares. The residual of a balanced body is of this size."""
EDGES = 8
"""Number of edges of the pyramid inside the friction cone, which holds at least 92 % of the cone's friction."""
MAX_ITERATIONS = 60
"""Greatest number of Newton's steps. Piles of 60 bricks took at most 21."""
TOLERANCE = 1e-9
"""Length of the gradient at which Newton's method ends, in units of the load."""


class Touches(NamedTuple):
    """The n contact points that may carry force."""

    a: IntArray
    """Row of the first body, or -1 for a body that never yields, shape (n,)."""
    b: IntArray
    """Row of the second body, or -1, shape (n,)."""
    point: FloatArray
    """Points [m], shape (n, 3)."""
    normal: FloatArray
    """Unit normals from a to b, shape (n, 3)."""
    friction: FloatArray
    """Coulomb coefficients, shape (n,)."""
    bears: BoolArray
    """True for a load-bearing contact, shape (n,)."""


@numba.njit(cache=True)
def _order(count: int, touches: Touches, height: FloatArray, up: FloatArray) -> IntArray:
    """Return the rows of all bodies, each after the bodies on it, or, in a circle, the highest body first.

    A body stands on another if a load-bearing contact of both pushes it up.
    """
    above = np.zeros((count, count), np.bool_)
    for i in range(len(touches.a)):
        a, b = touches.a[i], touches.b[i]
        if touches.bears[i] and a >= 0 and b >= 0:
            if np.dot(touches.normal[i], up) > 0.0:
                above[a, b] = True  # b stands on a
            else:
                above[b, a] = True
    waiting = above.sum(axis=1)
    ordered = np.empty(count, np.int64)
    is_done = np.zeros(count, np.bool_)
    for place in range(count):
        best = -1
        for row in range(count):
            if is_done[row]:
                continue
            if (
                best < 0
                or waiting[row] < waiting[best]
                or (waiting[row] == waiting[best] and height[row] > height[best])
            ):
                best = row
        is_done[best] = True
        ordered[place] = best
        for row in range(count):
            if above[row, best]:
                waiting[row] -= 1
    return ordered


@numba.njit(cache=True)
def _edges_of(touches: Touches, rows: IntArray, sign: FloatArray, center: FloatArray, size: float) -> FloatArray:
    """Return the wrenches (6, n * EDGES) of forces along the edges of n friction cones, each with unit normal force.

    The moments are about ``center``, in units of force times ``size``.
    """
    wrenches = np.empty((6, len(rows) * EDGES))
    for i in range(len(rows)):
        normal = sign[i] * touches.normal[rows[i]]
        arm = (touches.point[rows[i]] - center) / size
        helper = np.zeros(3)
        helper[np.argmin(np.abs(normal))] = 1.0
        first = np.cross(normal, helper)
        first /= np.sqrt(np.dot(first, first))
        second = np.cross(normal, first)
        for edge in range(EDGES):
            angle = 2.0 * np.pi * edge / EDGES
            force = normal + touches.friction[rows[i]] * (np.cos(angle) * first + np.sin(angle) * second)
            wrenches[:3, i * EDGES + edge] = force
            wrenches[3:, i * EDGES + edge] = np.cross(arm, force)
    return wrenches


@numba.njit(cache=True)
def _value(residual: FloatArray, load: FloatArray, forces: FloatArray) -> float:
    """Return the dual function, which Newton's method minimises."""
    value: float = 0.5 * np.dot(residual, residual) - np.dot(residual, load) + 0.5 * RIDGE * np.dot(forces, forces)
    return value


@numba.njit(cache=True)
def _forces(wrenches: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the forces (n,) along the edges ``wrenches`` (6, n) that best balance ``load`` (6,), and the residual."""
    residual = load.copy()
    forces = np.maximum(0.0, -(residual @ wrenches)) / RIDGE
    value = _value(residual, load, forces)
    for _ in range(MAX_ITERATIONS):
        gradient = residual - load - wrenches @ forces
        if np.sqrt(np.dot(gradient, gradient)) < TOLERANCE:
            break
        pushing = np.ascontiguousarray(wrenches[:, forces > 0.0])
        step = np.linalg.solve(np.eye(6) + pushing @ pushing.T / RIDGE, gradient)
        slope = np.dot(step, gradient)
        length = 1.0
        for _ in range(30):
            trial = residual - length * step
            forces = np.maximum(0.0, -(trial @ wrenches)) / RIDGE
            there = _value(trial, load, forces)
            if there <= value - 0.1 * length * slope:
                break
            length *= 0.5
        residual, value = trial, there
    return forces, residual


@numba.njit(cache=True)
def _pushing(touches: Touches, body: int, loads: BoolArray, rows: IntArray, sign: FloatArray) -> int:
    """List the contacts that may push ``body``: all its contacts except load-bearing contacts with a body in ``loads``.

    Args:
        touches: all contacts.
        body: the body's row.
        loads: True for each tested body, because its weight is already a load of the bodies below, shape (m,).
        rows: output, the rows of the contacts.
        sign: output, 1 for a normal towards the body, -1 for a normal away from it.

    Returns:
        Number of listed contacts.
    """
    found = 0
    for i in range(len(touches.a)):
        a, b = touches.a[i], touches.b[i]
        if a != body and b != body:
            continue
        other = b if a == body else a
        if touches.bears[i] and other >= 0 and loads[other]:
            continue
        rows[found], sign[found] = i, 1.0 if b == body else -1.0
        found += 1
    return found


@numba.njit(cache=True)
def residuals(
    center: FloatArray,
    size: FloatArray,
    mass: FloatArray,
    gravity: FloatArray,
    touches: Touches,
    carried: bool,
) -> FloatArray:
    """Return the length of the force and moment that each body lacks for equilibrium, shape (m,).

    The unit of the force is the body's load, and the unit of the moment is the load times the body's size.

    Args:
        center: centres of mass [m] of the m bodies, shape (m, 3).
        size: sizes [m], shape (m,). A body of size 0 has no contact, and therefore lacks its whole weight.
        mass: masses [kg], shape (m,).
        gravity: gravity [m/s2], shape (3,).
        touches: the contact points that may carry force.
        carried: True to load each body also with the bodies on it, False to load each body with its own weight only.
    """
    count, strength = len(mass), np.sqrt(np.dot(gravity, gravity))
    up = -gravity / strength
    lacking = np.ones(count)
    borne = np.zeros((count, 6))  # force [N], and moment [N m] about the body's own centre, from the bodies on it
    is_done, nobody = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    rows, sign = np.empty(len(touches.a), np.int64), np.empty(len(touches.a))
    for body in _order(count, touches, center @ up, up):
        is_done[body] = True
        if size[body] == 0.0:
            continue
        found = _pushing(touches, body, is_done if carried else nobody, rows, sign)
        load = borne[body].copy()
        load[:3] += mass[body] * gravity
        unit = mass[body] * strength + np.sqrt(np.dot(borne[body, :3], borne[body, :3]))
        load[:3] /= unit
        load[3:] /= unit * size[body]
        wrenches = _edges_of(touches, rows[:found], sign[:found], center[body], size[body])
        forces, residual = _forces(wrenches, load)
        lacking[body] = np.sqrt(np.dot(residual, residual))
        if not carried:
            continue
        for i in range(found):
            other = touches.a[rows[i]] if sign[i] > 0.0 else touches.b[rows[i]]
            if other < 0 or not touches.bears[rows[i]]:
                continue
            weight = 0.0
            for edge in range(i * EDGES, (i + 1) * EDGES):
                for k in range(3):
                    weight += unit * forces[edge] * wrenches[k, edge] * up[k]
            reaction = -weight * up
            borne[other, :3] += reaction
            borne[other, 3:] += np.cross(touches.point[rows[i]] - center[other], reaction)
    return lacking
