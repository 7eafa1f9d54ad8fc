"""What exact statics costs: run with ``uv run pytest tests/benchmarks --benchmark-enable``.

The clock is the process' own, so that what else the machine does counts for nobody.
"""

from __future__ import annotations

import itertools
import time

import highspy
import numpy as np
import piqp
import pytest
from scipy import optimize, sparse

from stability_core import GROUND, Contacts, Masses, solve_equilibrium
from tests.benchmarks.worlds import ACROSS, LENGTH, MASS, MU, THICKNESS, UP, contacts_of, plank_of_four_stack

pytestmark = pytest.mark.benchmark(timer=time.process_time)


def four_stack(n: int) -> tuple[Contacts, Masses]:
    planks = [plank_of_four_stack(body) for body in range(n)]
    rows = [row for _, contacts in planks for row in contacts]
    return contacts_of(rows), Masses(np.arange(n), np.full(n, MASS), np.array([center for center, _ in planks]))


def row_of_vs(pairs: int) -> tuple[Contacts, Masses]:
    """Inverted Vs side by side under a roof over each two neighbours: friction holds all of it."""
    theta = np.radians(70.0)
    spread, edge = LENGTH * np.cos(theta), THICKNESS * np.sin(theta)
    top = LENGTH * np.sin(theta) + THICKNESS * np.cos(theta)
    pitch = LENGTH - 4 * edge
    rows, centers = [], []
    for pair in range(pairs):
        for side in (1.0, -1.0):
            foot = pair * pitch - side * spread
            rows += [(GROUND, len(centers), (foot, y, 0.0), UP) for y in ACROSS]
            centers.append((foot + side * (spread - edge) / 2, 0.0, top / 2))
        ridge = (pair * pitch, LENGTH * np.sin(theta))
        rows += [(2 * pair, 2 * pair + 1, (ridge[0], y, ridge[1]), (1.0, 0.0, 0.0)) for y in ACROSS]
    for roof in range(0, pairs - 1, 2):
        for body, x in enumerate((-edge, edge, pitch - edge, pitch + edge)):
            rows += [(2 * roof + body, len(centers), (roof * pitch + x, y, top), UP) for y in ACROSS]
        centers.append(((roof + 0.5) * pitch, 0.0, top + THICKNESS / 2))
    return contacts_of(rows), Masses(np.arange(len(centers)), np.full(len(centers), MASS), np.array(centers))


@pytest.mark.parametrize("n", [12, 100, 300])
def test_four_stack_from_scratch(benchmark, n):
    world = four_stack(n)
    assert benchmark(solve_equilibrium, *world).stable


@pytest.mark.parametrize("pairs", [2, 20, 40])
def test_roofed_vs_from_scratch(benchmark, pairs):
    world = row_of_vs(pairs)
    assert benchmark(solve_equilibrium, *world).stable


def pyramid(contacts: Contacts, masses: Masses, gravity: float = 9.81):
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


def weak_forces(matrix, load) -> piqp.SparseSolver:
    """PIQP set up for the least |x|, which makes the forces unique as in ``solve_equilibrium``."""
    m = matrix.shape[1]
    solver = piqp.SparseSolver()
    solver.setup(P=sparse.identity(m, format="csc"), c=np.zeros(m), A=matrix, b=load, x_l=np.zeros(m))
    return solver


@pytest.mark.parametrize("n", [12, 100, 300])
def test_peer_highs_from_scratch(benchmark, n):
    """HiGHS: any x >= 0 with A x = w (see ``pyramid``); making the matrices is not counted."""
    matrix, load = pyramid(*four_stack(n))
    found = benchmark(lambda: optimize.linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=load, method="highs"))
    assert found.status == 0


def topmost_plank_by_turns(load):
    """The load with the topmost plank a tenth heavier, then as it was, and so on."""
    heavier = load.copy()
    heavier[-4] *= 1.1
    return itertools.cycle([heavier, load])


@pytest.mark.parametrize("n", [12, 100, 300])
def test_peer_highs_updated(benchmark, n):
    """HiGHS started from its latest basis: the topmost plank becomes heavier or lighter by a tenth."""
    matrix, load = pyramid(*four_stack(n))
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
    rows, loads = np.arange(len(load), dtype=np.int32), topmost_plank_by_turns(load)

    def solve_again() -> highspy.HighsModelStatus:
        now = next(loads)
        solver.changeRowsBounds(len(rows), rows, now, now)
        solver.run()
        return solver.getModelStatus()

    assert benchmark(solve_again) == highspy.HighsModelStatus.kOptimal


@pytest.mark.parametrize("n", [12, 100, 300])
def test_peer_piqp_from_scratch(benchmark, n):
    """PIQP: the shortest x >= 0 with A x = w (see ``pyramid``); making the matrices is not counted."""
    matrix, load = pyramid(*four_stack(n))
    assert benchmark(lambda: weak_forces(matrix, load).solve()) == piqp.PIQP_SOLVED


@pytest.mark.parametrize("n", [12, 100, 300])
def test_peer_piqp_updated(benchmark, n):
    """PIQP with the factorisation's structure kept: the topmost plank becomes heavier or lighter by a tenth."""
    matrix, load = pyramid(*four_stack(n))
    solver = weak_forces(matrix, load)
    solver.solve()
    loads = topmost_plank_by_turns(load)

    def solve_again() -> piqp.Status:
        solver.update(b=next(loads))
        return solver.solve()

    assert benchmark(solve_again) == piqp.PIQP_SOLVED
