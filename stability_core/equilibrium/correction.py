"""Correct the kept forces of a nearly balanced stack, for instance after one more plank.

See ``newton`` for the symbols. The cones K' are narrower than Coulomb's cones K by the factor ``NARROWED``. Of all
forces in K' with A f = w, the forces nearest to the kept forces f0 are

f = P_K'(f0 + A^T y),    y minimises |P_K'(f0 + A^T y)|^2 / 2 - w . y.

With the derivative D of the projection P_K', a step dy of Newton's method forecasts the forces f + D A^T dy. These
forces balance, but may leave K'. As soon as these forces lie in K, the forces prove equilibrium. Then the search ends
before the minimum. The search needs few steps, because most kept forces lie inside K', and K has room around K'.
If the search finds no forces of this kind, the search proves nothing.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.cone import add_derivative_along, project
from stability_core.equilibrium.linear import factorize_at, solve_for, step_length, workspace_for
from stability_core.equilibrium.problem import BALANCED, Problem, along_contacts, greatest_imbalance, imbalance
from stability_core.port import FloatArray, IntArray

NARROWED = 0.97
"""Ratio of the friction of the cones K' to the true friction. A smaller value leaves more room, but fails for stacks
that need more of their friction."""
RHO = 1e-9
"""Weight of the proximal term, which keeps the system regular where contacts leave a motion free."""


@compiled
def correct(
    problem: Problem, rows: IntArray, start: FloatArray, y: FloatArray, steps: int
) -> tuple[bool, FloatArray, FloatArray, float]:
    """Search near ``start`` for forces in the Coulomb cones that hold all bodies.

    A step costs O(m) and a factorisation (see ``envelope``).

    Args:
        problem: n bodies and m contacts.
        rows: as for ``newton.solve``.
        start: forces on the second bodies [N], shape (m, 3), with zero for an unknown force.
        y: multipliers of the search, shape (n, 6), zeros at first. The function updates the multipliers, so that a
            later call continues the search.
        steps: greatest number of steps.

    Returns:
        Four values:

        - True if the forces hold all bodies;
        - the forces, in their cones, shape (m, 3);
        - the unbalanced rest, shape (n, 6);
        - the greatest imbalance of a body relative to the largest force on it; infinite if the search fails.
    """
    n, m = len(problem.load), len(problem.normal)
    space = workspace_for(problem, rows)
    friction = NARROWED * problem.friction
    narrow = Problem(
        problem.body_a,
        problem.body_b,
        problem.lever_a,
        problem.lever_b,
        problem.normal,
        friction,
        problem.load,
        problem.slack,
    )
    center, rest, unbalanced = np.zeros((n, 6)), np.zeros((n, 6)), np.zeros((n, 6))
    force, forecast = np.zeros((m, 3)), np.zeros((m, 3))
    dy, dz = np.zeros((n, 6)), np.zeros((m, 3))
    for _ in range(steps):
        along_contacts(problem, y, space.z)
        space.z[:] += start
        project(space.z, problem.normal, friction, force)
        imbalance(problem, force, rest)
        factorize_at(narrow, space, RHO)
        solve_for(problem, space, rest - RHO * y)
        dy[:], dz[:] = space.dy, space.dz
        forecast[:] = force
        add_derivative_along(space.z, problem.normal, friction, dz, forecast)
        imbalance(problem, forecast, unbalanced)  # equals RHO (y + dy)
        solve_for(problem, space, unbalanced)
        add_derivative_along(space.z, problem.normal, friction, space.dz, forecast)
        project(forecast, problem.normal, problem.friction, force)
        imbalance(problem, force, unbalanced)
        worst = greatest_imbalance(problem, force, unbalanced)
        if worst <= BALANCED:
            return True, force, unbalanced, worst
        space.dy[:], space.dz[:] = dy, dz
        y += step_length(narrow, space, RHO, y, center, force) * dy
    return False, force, rest, np.inf
