"""The Coulomb cone |f_t| <= mu f_n of a contact: the projection onto the cone, and the derivative of the projection.

A force f has the normal component f_n and the tangential component f_t. mu is the coefficient of friction. No pyramid
replaces the cone. The same code serves forces of a known direction, because with mu = 0 the cone is the ray along the
normal.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray


@compiled
def project(z: FloatArray, normal: FloatArray, friction: FloatArray, force: FloatArray) -> None:
    """Write the projection of ``z`` onto each contact's cone to ``force``.

    n is the unit normal, z_n = z . n, t = |z - z_n n|, and e is the direction of the tangential part z - z_n n:

    z                                                      inside the cone, t <= mu z_n
    0                                                      inside the polar cone, mu t <= -z_n
    s (n + mu e) with s = (z_n + mu t) / (1 + mu^2)        else

    Args:
        z: any vectors, shape (m, 3).
        normal: unit normals, shape (m, 3).
        friction: Coulomb coefficients, shape (m,).
        force: output, shape (m, 3).
    """
    for c in range(len(z)):
        nx, ny, nz = normal[c, 0], normal[c, 1], normal[c, 2]
        along = z[c, 0] * nx + z[c, 1] * ny + z[c, 2] * nz
        tx, ty, tz = z[c, 0] - along * nx, z[c, 1] - along * ny, z[c, 2] - along * nz
        mu = friction[c]
        across = np.sqrt(tx * tx + ty * ty + tz * tz)
        if along >= 0.0 and across <= mu * along:
            force[c, 0], force[c, 1], force[c, 2] = z[c, 0], z[c, 1], z[c, 2]
        elif mu * across <= -along:
            force[c, 0] = force[c, 1] = force[c, 2] = 0.0
        else:
            s = (along + mu * across) / (1.0 + mu * mu)
            slide = mu * s / across if across > 0.0 else 0.0
            force[c, 0], force[c, 1], force[c, 2] = s * nx + slide * tx, s * ny + slide * ty, s * nz + slide * tz


@compiled
def derivative(z: FloatArray, normal: FloatArray, mu: float, direction: FloatArray, weight: FloatArray) -> int:
    """Return the derivative of one contact's projection at ``z`` as a sum of k terms weight_k u_k u_k^T.

    identity                                               inside the cone
    0                                                      inside the polar cone
    w w^T + (mu s / t) (n x e) (n x e)^T                   else, with w = (n + mu e) / sqrt(1 + mu^2)

    See ``project`` for the symbols. The apex counts as inside the cone, so that a search from zero includes every
    contact. For mu = 0, the derivative outside the polar cone is n n^T.

    Args:
        z: point of evaluation, shape (3,).
        normal: unit normal, shape (3,).
        mu: Coulomb coefficient.
        direction: output, the unit vectors u_k in the first k rows, shape (3, 3).
        weight: output, their weights, shape (3,).

    Returns:
        k, from 0 to 3.
    """
    along = z[0] * normal[0] + z[1] * normal[1] + z[2] * normal[2]
    ex, ey, ez = z[0] - along * normal[0], z[1] - along * normal[1], z[2] - along * normal[2]
    across = np.sqrt(ex * ex + ey * ey + ez * ez)
    if along < 0.0 and mu * across <= -along:
        return 0
    if mu == 0.0:
        for k in range(3):
            direction[0, k] = normal[k]
        weight[0] = 1.0
        return 1
    if across <= mu * along:
        for k in range(3):
            for i in range(3):
                direction[k, i] = 1.0 if i == k else 0.0
            weight[k] = 1.0
        return 3
    ex, ey, ez = ex / across, ey / across, ez / across
    length = np.sqrt(1.0 + mu * mu)
    direction[0, 0], direction[1, 0] = (normal[0] + mu * ex) / length, normal[1] * ez - normal[2] * ey
    direction[0, 1], direction[1, 1] = (normal[1] + mu * ey) / length, normal[2] * ex - normal[0] * ez
    direction[0, 2], direction[1, 2] = (normal[2] + mu * ez) / length, normal[0] * ey - normal[1] * ex
    weight[0] = 1.0
    weight[1] = mu * (along + mu * across) / ((1.0 + mu * mu) * across)
    return 2


@compiled
def add_derivative_along(
    z: FloatArray, normal: FloatArray, friction: FloatArray, dz: FloatArray, force: FloatArray
) -> None:
    """Add the derivative of the projection at ``z`` (m, 3), along ``dz`` (m, 3), to ``force`` (m, 3)."""
    direction, weight = np.empty((3, 3)), np.empty(3)
    for c in range(len(z)):
        for k in range(derivative(z[c], normal[c], friction[c], direction, weight)):
            u = direction[k]
            along = weight[k] * (u[0] * dz[c, 0] + u[1] * dz[c, 1] + u[2] * dz[c, 2])
            for i in range(3):
                force[c, i] += along * u[i]
