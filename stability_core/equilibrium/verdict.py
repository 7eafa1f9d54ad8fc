"""Decide the verdict stable, unstable or doubt: which of the two proofs exists, and whether the forces would arise.

- unstable: no contact forces in the Coulomb cones hold the bodies. A mechanism is the proof.
- stable: contact forces in the cones hold the bodies. Either vertical forces on load-bearing contacts suffice, or
  loading from zero prestress comes to rest (see ``loading``).
- doubt: contact forces in the cones hold the bodies, but would not arise by themselves, or the search finds no proof.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from stability_core.equilibrium.correction import correct
from stability_core.equilibrium.layers import loose_in_layers
from stability_core.equilibrium.loading import ALL_ROUNDS, FEW_ROUNDS, STIFFNESSES, needs_prestress
from stability_core.equilibrium.newton import FALLING, HELD, STRONGEST, UNDECIDED, solve
from stability_core.equilibrium.passing_down import pass_down
from stability_core.equilibrium.problem import (
    BALANCED,
    Problem,
    greatest_imbalance,
    held_by_the_rest,
    imbalance,
    islands,
    weakest_equilibrium,
    with_neighbours,
)
from stability_core.port import BoolArray, FloatArray

Verdict: TypeAlias = Literal["stable", "unstable", "doubt"]
Answer: TypeAlias = tuple[Verdict, FloatArray | None, FloatArray, float]

ALL_ROWS = np.arange(6)
VERTICAL_ROWS = np.array([2, 3, 4])
"""Components of a vertical force: F_z, M_x, M_y."""
OTHER_ROWS = np.array([0, 1, 5])
MOMENT_ROWS = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
"""Factor that selects the moments."""
SLACK_STEPS = 8
"""Greatest number of solves for rolling bodies, because a pile of spheres takes one or two solves."""
FIRST_STEPS, MORE_STEPS = 3, 9
"""Numbers of correction steps before and after the test whether changed bodies fall with their neighbours. On a card
house of 100 planks, one more plank takes 1 to 5 steps. An off-centre load of 20 planks' weight takes 12 steps."""
LESS_FRICTION = 0.9
"""Ratio of the reduced friction to the true friction. If forces exist with the reduced friction, forces must also arise
with this friction. Reason: with the true friction mu = 0.8, loading held two kinds of courses of touching bricks, which
fell in two of three engines."""
FEW = 0.25
"""Greatest fraction of the bodies in a cheap test for a fall. A larger test costs as much as the steps of the
correction, and far more than passing down."""
MOVES = 1e-2
"""Ratio of a body's unbalanced force to the largest unbalanced force, up to which the body takes no part in a
mechanism."""


class Effort(NamedTuple):
    """A limit on the cost of a decision."""

    rounds: int
    """Greatest number of rounds of loading (see ``loading.needs_prestress``)."""
    bodies: float
    """Greatest number of bodies for which the decision includes the search from zero and loading at once. In a pile of
    bricks these steps take 20 to 300 ms for more than 16 bodies, and rarely decide."""


THOROUGH, BRIEF, QUICK = Effort(ALL_ROUNDS, np.inf), Effort(FEW_ROUNDS, np.inf), Effort(FEW_ROUNDS, 16)
"""No limit; a limit for each frame; and a limit for the pile that moves from frame to frame."""


def takes_part(rest: FloatArray) -> BoolArray:
    """Return the mask (n,) of the moving or unbalanced bodies in the ``rest`` (n, 6) of a search."""
    unbalanced = np.abs(rest).max(axis=1, initial=0.0)
    moves: BoolArray = unbalanced > MOVES * unbalanced.max(initial=0.0)
    return moves


def decide(
    problem: Problem,
    level: BoolArray,
    start: FloatArray | None = None,
    changed: BoolArray | None = None,
    displacement: FloatArray | None = None,
    effort: Effort = THOROUGH,
) -> Answer:
    """Decide whether the bodies stand, fall or are in doubt, by the cheapest proof that succeeds.

    The function tries these steps in order, until a step decides:

    1. test whether the changed bodies fall by themselves;
    2. pass vertical forces from the top down (see ``passing_down``), before step 1 if many bodies are new;
    3. take the first steps of the correction of the kept forces;
    4. test whether the changed bodies fall with their neighbours;
    5. take the remaining steps of the correction;
    6. test whether the bodies that are still unbalanced fall;
    7. search for forces from zero.

    If forces hold the bodies, ``loading`` decides whether these forces arise by themselves. For standing stacks, the
    correction usually takes one to four steps. See ``correction`` and ``newton`` for the cost of a step.

    Args:
        problem: n bodies and m contacts, z up.
        level: mask of the load-bearing contacts, shape (m,).
        start: forces that nearly hold the bodies [N], shape (m, 3), or None.
        changed: mask (n,) of the bodies that are new, moved or lost a neighbour since the last proof, or None for all
            bodies.
        displacement: start of loading, shape (3, n, 6), or None for zero. Loading overwrites the start (see
            ``loading.needs_prestress``).
        effort: limit on the cost. Bodies that only steps beyond the limit decide are in doubt.

    Returns:
        Four values:

        - the verdict;
        - the forces that hold the bodies, or nearly hold "unstable" bodies, shape (m, 3), or None without forces;
        - the motion of "unstable" bodies, a mask of bodies that loading does not hold, or else the unbalanced rest,
          shape (n, 6);
        - the greatest imbalance of a body relative to the largest force on it.
    """
    if start is None:
        start = np.zeros_like(problem.normal)
    if changed is None:
        changed = np.ones(len(problem.load), np.bool_)
    if displacement is None:
        displacement = np.zeros((len(STIFFNESSES), *problem.load.shape))
    proof = _cheap_proof(problem, level, changed)
    if proof is not None:
        return proof
    are_vertical = level.all() and _is_vertical(problem.load)
    aim, rows = (_along(problem, level, _verticals(problem)), VERTICAL_ROWS) if are_vertical else (problem, ALL_ROWS)
    y = np.zeros_like(problem.load)
    held, force, rest, residual = correct(aim, rows, start, y, FIRST_STEPS)
    if not held:
        falls = _falls_with_neighbours(problem, changed)
        if falls is not None:
            return falls
        held, force, rest, residual = correct(aim, rows, start, y, MORE_STEPS)
    if held:
        if are_vertical or (_is_vertical(problem.load) and _held_by_verticals(problem, level)[0]):
            return "stable", force, rest, residual
        return _arising(problem, force, residual, displacement, effort)
    falls = _falls_by_itself(problem, takes_part(rest))
    if falls is not None:
        return falls
    return _decide_from_scratch(problem, level, displacement, effort)


def _cheap_proof(problem: Problem, level: BoolArray, changed: BoolArray) -> Answer | None:
    """Return the proof that the ``changed`` bodies fall by themselves, or that passing down holds all, or None."""
    if np.count_nonzero(changed) > FEW * len(changed):
        return _passed_down(problem, level) or _falls_by_itself(problem, changed)
    return _falls_by_itself(problem, changed) or _passed_down(problem, level)


def _passed_down(problem: Problem, level: BoolArray) -> Answer | None:
    """Return the proof that vertical forces on load-bearing contacts hold all bodies, or None if the sweep fails.

    Vertical forces arise by themselves, because each body presses on its supports.
    """
    if not _is_vertical(problem.load):
        return None
    held, along, rest, residual = pass_down(_along(problem, level, _verticals(problem)))
    if not held:
        return None
    force = np.zeros_like(problem.normal)
    force[level] = along
    return "stable", force, rest, residual


def _falls_with_neighbours(problem: Problem, changed: BoolArray) -> Answer | None:
    """Return the proof that the ``changed`` bodies, a mask (n,), fall with nearby bodies, or None without a proof."""
    moves = changed
    while True:
        more = with_neighbours(problem, moves)
        if more.mean() > FEW or (more == moves).all():
            return None
        moves = more
        falls = _falls_by_itself(problem, moves)
        if falls is not None:
            return falls


def _falls_by_itself(problem: Problem, moves: BoolArray) -> Answer | None:
    """Return the proof that bodies of the mask ``moves`` (n,) fall between fixed bodies, or None without a proof."""
    if moves.all() or not moves.any():
        return None
    part, theirs = held_by_the_rest(problem, moves)
    weaker = np.abs(problem.load).sum() / np.abs(part.load).sum()
    verdict, near, ray, residual = solve(part, ALL_ROWS, STRONGEST * weaker)
    if verdict != FALLING:
        return None
    motion, force = np.zeros_like(problem.load), np.zeros_like(problem.normal)
    motion[moves], force[theirs] = ray, near
    work = np.empty_like(force)
    if weakest_equilibrium(problem, motion, work, np.empty_like(work)) < STRONGEST:
        return None
    return "unstable", force, motion, residual


def _is_vertical(load: FloatArray) -> bool:
    """Return True if each ``load`` (n, 6) has no components other than those of vertical forces: F_z, M_x, M_y."""
    return not load[:, OTHER_ROWS].any()


def _decide_from_scratch(problem: Problem, level: BoolArray, displacement: FloatArray, effort: Effort) -> Answer:
    """Search from zero: vertical forces on load-bearing contacts first, then all forces in the cones.

    The first search costs about an eighth of the second search, because its matrix has half as many rows.
    """
    held, force, rest, residual = _held_by_verticals(problem, level)
    if held:
        return "stable", force, rest, residual
    if len(rest) > effort.bodies:
        return "doubt", None, rest, residual
    verdict, force, ray, residual = solve(problem, ALL_ROWS, STRONGEST)
    if verdict == UNDECIDED and problem.slack.any():
        verdict, force, residual = _held_within_slack(problem, force, ray, residual)
    if verdict == FALLING:
        return "unstable", force, ray, residual
    if verdict == HELD:
        return _arising(problem, force, residual, displacement, effort)
    return "doubt", None, rest, residual


def _held_within_slack(
    problem: Problem, force: FloatArray, rest: FloatArray, residual: float
) -> tuple[int, FloatArray, float]:
    """Solve again without the unbalanced moments of rolling bodies, up to the slack of these bodies.

    Args:
        problem: a problem with rolling bodies.
        force: forces (m, 3) that nearly hold the bodies.
        rest: the unbalanced rest, shape (n, 6).
        residual: the greatest imbalance.

    Returns:
        Three values:

        - HELD or UNDECIDED;
        - the forces, shape (m, 3);
        - the greatest imbalance beyond the slack.
    """
    borne = np.zeros_like(problem.load)
    for _ in range(SLACK_STEPS):
        moment = np.where(problem.slack[:, None] > 0.0, rest, 0.0) * MOMENT_ROWS
        if not moment.any():
            break
        borne += moment * ((rest**2).sum() / (moment**2).sum())
        borne = np.clip(borne, -problem.slack[:, None], problem.slack[:, None])
        eased = problem._replace(load=problem.load - borne, slack=np.zeros_like(problem.slack))
        verdict, force, rest, residual = solve(eased, ALL_ROWS, STRONGEST)
        if verdict == HELD:
            left = np.empty_like(rest)
            imbalance(problem, force, left)
            residual = greatest_imbalance(problem, force, left)
            return HELD if residual <= BALANCED else UNDECIDED, force, residual
    return UNDECIDED, force, residual


def _held_by_verticals(problem: Problem, level: BoolArray) -> tuple[bool, FloatArray, FloatArray, float]:
    """Search for vertical forces on load-bearing contacts that hold the bodies.

    Vertical forces arise by themselves, because each body presses on its supports.

    Returns:
        Four values:

        - True if vertical forces hold the bodies;
        - the forces, shape (m, 3);
        - the unbalanced rest, shape (n, 6);
        - the greatest imbalance.
    """
    verdict, force, rest, residual = solve(_along(problem, level, _verticals(problem)), VERTICAL_ROWS, STRONGEST)
    forces = np.zeros((len(level), 3))
    forces[level] = force
    return verdict == HELD and _is_vertical(problem.load), forces, rest, residual


def _arising(problem: Problem, force: FloatArray, residual: float, displacement: FloatArray, effort: Effort) -> Answer:
    """Return the answer for bodies that ``force`` (m, 3) holds: "stable" if loading holds all bodies, else "doubt".

    The function loads each island separately.
    """
    loose = np.zeros(len(problem.load), np.bool_)
    island_of = islands(problem)
    for label in np.unique(island_of):
        members = island_of == label
        found = np.ascontiguousarray(displacement[:, members])
        island, theirs = held_by_the_rest(problem, members)
        loose[members] = _loose(island, force[theirs], found, effort)
        displacement[:, members] = found
    verdict: Verdict = "doubt" if loose.any() else "stable"
    return verdict, force, np.zeros_like(problem.load) + loose[:, None], residual


def _loose(island: Problem, force: FloatArray, displacement: FloatArray, effort: Effort) -> BoolArray:
    """Return the mask of the bodies that loading does not hold, shape (n,).

    Loading must hold all bodies with ``LESS_FRICTION`` of the friction. If no equilibrium exists with this friction,
    for example for an inverted V near its limit, the full friction decides. Loading layer by layer comes first, because
    its cost is small. If this loading does not hold all bodies, the function loads all bodies at once, and returns the
    mask with fewer bodies.
    """
    less = island._replace(friction=LESS_FRICTION * island.friction)
    loose: BoolArray = loose_in_layers(less, force)
    if not loose.any() or len(loose) > effort.bodies:
        return loose
    if solve(less, ALL_ROWS, STRONGEST)[0] == FALLING:
        loose = loose_in_layers(island, force)
        if not loose.any():
            return loose
        at_once = needs_prestress(island, displacement, effort.rounds)
    else:
        at_once = needs_prestress(less, displacement, effort.rounds)
        if not at_once.any():
            at_once = needs_prestress(island, displacement, effort.rounds)  # starts from the result above
    return loose if loose.sum() < at_once.sum() else at_once


def _along(problem: Problem, kept: BoolArray, direction: FloatArray) -> Problem:
    """Return the problem with only the ``kept`` contacts, a mask (m,), and only forces along ``direction`` (m, 3)."""
    return Problem(
        problem.body_a[kept],
        problem.body_b[kept],
        problem.lever_a[kept],
        problem.lever_b[kept],
        direction[kept],
        np.zeros(np.count_nonzero(kept)),
        problem.load,
        problem.slack,
    )


def _verticals(problem: Problem) -> FloatArray:
    """Return a vertical unit vector for each contact, with the sign of its normal, shape (m, 3)."""
    vertical = np.zeros_like(problem.normal)
    vertical[:, 2] = np.where(problem.normal[:, 2] >= 0.0, 1.0, -1.0)
    return vertical
