"""Is there an equilibrium? A second-order cone program by Clarabel: code of another kind, by other people.

Used by tests only. The least t such that contact forces inside the true Coulomb cones leave no more than t of any
force or moment unbalanced.
"""

from __future__ import annotations

import clarabel
import numpy as np
from scipy import sparse

from stability_core import GROUND, Contacts, Masses

G = 9.81


def least_imbalance(
    contacts: Contacts, masses: Masses, *, must_rest: np.ndarray | None = None, grip: float = 1.0
) -> float:
    """The least imbalance of a body, over the mean weight.

    Args:
        contacts: the touching points.
        masses: n bodies, z up.
        must_rest: which bodies must be balanced, shape (n,); None for all. The others may fall: contacts press on each
            with no more than its weight.
        grip: by what each friction coefficient is multiplied.
    """
    n, m = len(masses.body), len(contacts)
    rests = np.ones(n, np.bool_) if must_rest is None else must_rest
    index = {int(body): i for i, body in enumerate(masses.body)} | {GROUND: -1}
    unit = float((masses.mass * G).mean())
    size = float(np.ptp(contacts.point, axis=0).max()) or 1.0 if m else 1.0
    balance = np.zeros((6 * n, 3 * m))
    for c in range(m):
        for body, sign in ((index[int(contacts.body_a[c])], -1.0), (index[int(contacts.body_b[c])], 1.0)):
            if body < 0:
                continue
            x, y, z = (contacts.point[c] - masses.center_of_mass[body]) / size
            lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            balance[6 * body : 6 * body + 3, 3 * c : 3 * c + 3] = sign * np.eye(3)
            balance[6 * body + 3 : 6 * body + 6, 3 * c : 3 * c + 3] = sign * lever
    weight = np.zeros(6 * n)
    weight[2::6] = masses.mass * G / unit
    held = np.repeat(rests, 6)
    rows = balance[held]
    t = -np.ones((len(rows), 1))
    upward = balance[2::6][~rests]
    cones = [clarabel.NonnegativeConeT(2 * len(rows) + len(upward) + 1)]
    blocks = [
        np.hstack([rows, t]),
        np.hstack([-rows, t]),
        np.hstack([upward, np.zeros((len(upward), 1))]),
        np.hstack([np.zeros((1, 3 * m)), [[-1.0]]]),
    ]
    right = [weight[held], -weight[held], weight[2::6][~rests], np.zeros(1)]
    for c in range(m):
        cone = np.zeros((4, 3 * m + 1))
        normal = contacts.normal[c]
        cone[0, 3 * c : 3 * c + 3] = -grip * contacts.friction[c] * normal
        cone[1:, 3 * c : 3 * c + 3] = -(np.eye(3) - np.outer(normal, normal))
        blocks.append(cone)
        right.append(np.zeros(4))
        cones.append(clarabel.SecondOrderConeT(4))
        blocks.append(-np.concatenate([np.zeros(3 * c), normal, np.zeros(3 * (m - c - 1) + 1)])[None])
        right.append(np.zeros(1))
        cones.append(clarabel.NonnegativeConeT(1))
    cost = np.zeros(3 * m + 1)
    cost[-1] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix((3 * m + 1, 3 * m + 1)),
        cost,
        sparse.csc_matrix(np.vstack(blocks)),
        np.concatenate(right),
        cones,
        settings,
    )
    return float(solver.solve().x[-1])
