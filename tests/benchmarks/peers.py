"""Solvers of others on the same statics: HiGHS and PIQP, from scratch and started from what they know.

Making their matrices is not counted. An update makes the topmost plank a tenth heavier, then as it was, and so on.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

import highspy
import numpy as np
import piqp
from scipy import optimize, sparse

from stability_core import GROUND, Contacts, Masses
from stability_core.port import FloatArray
from tests.benchmarks.worlds import LENGTH, MASS, MU, contacts_of, plank_of_four_stack

Solve: TypeAlias = Callable[[], bool]
"""Solves once; True if the planks were found to stand."""


def four_stack(n: int) -> tuple[Contacts, Masses]:
    planks = [plank_of_four_stack(body) for body in range(n)]
    rows = [row for _, contacts in planks for row in contacts]
    return contacts_of(rows), Masses(np.arange(n), np.full(n, MASS), np.array([center for center, _ in planks]))


def pyramid(contacts: Contacts, masses: Masses, gravity: float = 9.81) -> tuple[Any, FloatArray]:
    """The 4-stack for solvers of linear and quadratic programmes: A x = w, x >= 0.

    x are the weights of the four edges of a friction pyramid inscribed in each contact's cone, w what gravity asks
    of each plank (force and moment).
    """
    across = MU / np.sqrt(2.0)
    edges = np.array([(i * across, j * across, 1.0) for i in (-1, 1) for j in (-1, 1)])
    rows, columns, values = [], [], []
    for bodies, sign in ((contacts.body_a, -1.0), (contacts.body_b, 1.0)):
        on = np.flatnonzero(bodies != GROUND)
        lever = (contacts.point[on] - masses.center_of_mass[bodies[on]]) / LENGTH
        for e, edge in enumerate(edges):
            wrench = sign * np.hstack([np.tile(edge, (len(on), 1)), np.cross(lever, edge)])
            rows.append((6 * bodies[on, None] + np.arange(6)).ravel())
            columns.append(np.repeat(4 * on + e, 6))
            values.append(wrench.ravel())
    shape = (6 * len(masses.body), 4 * len(contacts))
    load = np.zeros((len(masses.body), 6))
    load[:, 2] = masses.mass * gravity
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return sparse.csc_matrix(entries, shape), load.ravel()


def _by_turns(load: FloatArray) -> Iterator[FloatArray]:
    heavier = load.copy()
    heavier[-4] *= 1.1
    return itertools.cycle([heavier, load])


def highs_from_scratch(matrix: Any, load: FloatArray) -> Solve:
    """HiGHS: any x >= 0 with A x = w (see ``pyramid``)."""
    return lambda: optimize.linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=load, method="highs").status == 0


def highs_updated(matrix: Any, load: FloatArray) -> Solve:
    """HiGHS started from its latest basis."""
    model = highspy.HighsLp()
    model.num_row_, model.num_col_ = matrix.shape
    model.col_cost_, model.col_lower_ = np.zeros(matrix.shape[1]), np.zeros(matrix.shape[1])
    model.col_upper_ = np.full(matrix.shape[1], highspy.kHighsInf)
    model.row_lower_ = model.row_upper_ = load
    model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    model.a_matrix_.start_, model.a_matrix_.index_ = matrix.indptr, matrix.indices
    model.a_matrix_.value_ = matrix.data
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.passModel(model)
    solver.run()
    rows, loads = np.arange(len(load), dtype=np.int32), _by_turns(load)

    def solve() -> bool:
        now = next(loads)
        solver.changeRowsBounds(len(rows), rows, now, now)
        solver.run()
        return bool(solver.getModelStatus() == highspy.HighsModelStatus.kOptimal)

    return solve


def _piqp(matrix: Any, load: FloatArray) -> piqp.SparseSolver:
    """PIQP set up for the least |x|, which makes the forces unique as in ``solve_equilibrium``."""
    m = matrix.shape[1]
    solver = piqp.SparseSolver()
    solver.setup(P=sparse.identity(m, format="csc"), c=np.zeros(m), A=matrix, b=load, x_l=np.zeros(m))
    return solver


def piqp_from_scratch(matrix: Any, load: FloatArray) -> Solve:
    """PIQP: the shortest x >= 0 with A x = w."""
    return lambda: bool(_piqp(matrix, load).solve() == piqp.PIQP_SOLVED)


def piqp_updated(matrix: Any, load: FloatArray) -> Solve:
    """PIQP with the factorisation's structure kept."""
    solver = _piqp(matrix, load)
    solver.solve()
    loads = _by_turns(load)

    def solve() -> bool:
        solver.update(b=next(loads))
        return bool(solver.solve() == piqp.PIQP_SOLVED)

    return solve


PEERS: Mapping[str, Callable[[Any, FloatArray], Solve]] = {
    "HiGHS from scratch": highs_from_scratch,
    "HiGHS updated": highs_updated,
    "PIQP from scratch": piqp_from_scratch,
    "PIQP updated": piqp_updated,
}
