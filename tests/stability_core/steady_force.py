"""Steady forces on frozen stacks: they must move if, and only if, statics cannot hold them.

    uv run python -m tests.stability_core.steady_force [--cases N] [--engine E] [--profile P] [--arm A]

writes ``docs/results/loads/steady_force.md`` if no engine or profile is left out, nor an arm that is compared, and at
least ``FEWEST`` cases are played; it goes on from where an earlier run was stopped.

A case is a stack (tower, wall or leaning tower), a live body through which a force presses on it, and the force: 0.5,
0.9, 1.1, 2 or 10 times the limit of exact statics. There are two kinds of live body:

- a cube that stands on the ground and touches the stack's side, pressed horizontally against it;
- the topmost plank, pressed downwards or along the stack, at any slope between.

A user holds the live body: the extension has been notified (``disturb``). The force grows from zero within ``GROWTH_S``
and lasts until ``PRESSED_S``. The stack moves if any body, also the live one, is then more than ``MOVED`` off its
place.

The limit is the force up to which forces in the Coulomb cones balance all bodies (``scenarios.statics.force_balance``),
found by bisection. A draw counts only if the judge (``scenarios.statics.truth``) calls the pile stable at 0.5 and at
0.9 times the limit, so that it stands also when it is loaded from zero, and only if the limit is at most ``MOST``
weights of the stack. Each draw is played with all five factors.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import islice, product
from typing import Any, NamedTuple

import numpy as np

from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from scenarios.geometry import Boxes
from scenarios.model import Brick, Vector
from scenarios.planks import LENGTH, MU, WIDTH
from scenarios.scenes.brick_wall import brick_wall
from scenarios.scenes.leaning_tower import leaning_tower
from scenarios.scenes.plank_tower import plank_tower
from scenarios.statics.contact_patch import contact_patches
from scenarios.statics.force_balance import solve_balance
from scenarios.statics.truth import judge
from tests.stability_core.loaded_stacks import (
    ARMS,
    NEEDED,
    PAGES,
    FloatArray,
    Standing,
    kept_runs,
    left_out,
    standing,
    table,
)

SEED = 20261128
"""Named before the first run, and never changed."""
CASES, FEWEST = 200, 100
FACTORS = (0.5, 0.9, 1.1, 2.0, 10.0)
ENGINES = ("bullet", "mujoco")
PROFILES = ("game", "tuned")
GRAVITY = (0.0, 0.0, -9.81)
"""[m/s2]"""
MOST = 5.0
"""Greatest limit, in weights of the stack: ten times of it still is no blow."""
HELD_S, GROWTH_S, PRESSED_S = 0.2, 0.5, 2.0
"""How long a user holds the live body before the force begins, how long the force grows, and when it ends [s]."""
GAP = 0.05e-3
"""Between stack and cube when that is put down [m]: MuJoCo (``game``) throws a cube that touches 1 mm back."""
MOVED, GONE = 1e-3, 10e-3
"""How far a body must be off its place in the end, and from how far on the end is not awaited [m]: a cube in MuJoCo
(``game``) trembles by more than the lesser when it closes its gap, and comes back."""
PRECISION = 1e-3
"""To which the limit is searched, over itself."""
RIGHT = 0.95
"""Share of cases that must be right."""
NAME = "steady_force"


class Draw(NamedTuple):
    """A stack, what presses on it, and the limit."""

    kind: str
    through: str
    """``cube`` or ``top``."""
    bricks: tuple[Brick, ...]
    """The stack, and the live body last."""
    direction: Vector
    """Of the force, a unit vector."""
    limit: float
    """Force [N] up to which statics holds."""


def stack_of(kind: str, random: np.random.Generator) -> tuple[Brick, ...]:
    """Draw a stack."""
    if kind == "tower":
        return plank_tower(levels=int(random.integers(3, 11))).bricks
    if kind == "wall":
        return brick_wall(courses=int(random.integers(3, 9)), width=int(random.integers(2, 4))).bricks
    ratio = float(random.uniform(6, 12))
    return leaning_tower(ratio=ratio, levels=int(random.integers(3, int(0.85 * ratio) + 1))).bricks


def cube_at(stack: Sequence[Brick], random: np.random.Generator) -> tuple[Brick, Vector]:
    """Draw a cube that touches a stack's side, and the direction from it to the stack."""
    edge, mass = float(random.uniform(0.02, 0.04)), float(random.uniform(0.05, 0.3))
    lowest = [brick for brick in stack if brick.position[2] - brick.size[2] / 2 < edge]
    if random.random() < 0.5:  # against the ends of planks
        end = min(brick.position[0] - brick.size[0] / 2 for brick in lowest)
        return Brick((edge,) * 3, mass, (end - edge / 2, 0.0, edge / 2)), (1.0, 0.0, 0.0)
    reach = 0.4 * LENGTH if len({brick.position[0] for brick in stack if brick.level == 1}) == 1 else 0.8 * LENGTH
    x = float(random.uniform(-reach, reach))
    return Brick((edge,) * 3, mass, (x, -(WIDTH + edge) / 2, edge / 2)), (0.0, 1.0, 0.0)


def draw_of(number: int) -> Draw:
    """Return a draw; numbers whose case statics cannot decide are drawn again."""
    for attempt in range(1000):
        random = np.random.default_rng([SEED, number, attempt])
        kind = ("tower", "wall", "leaning tower")[number % 3]
        through = ("cube", "top")[number // 3 % 2]
        stack = stack_of(kind, random)
        if through == "cube":
            cube, direction = cube_at(stack, random)
            bricks = (*stack, cube)
        else:
            bricks, slope = stack, float(random.uniform(0, math.pi / 2))
            x, y = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0))[int(random.integers(3))]
            direction = x * math.cos(slope), y * math.cos(slope), -math.sin(slope)
        limit = limit_of(bricks, direction, MOST * sum(brick.mass for brick in stack) * -GRAVITY[2])
        if math.isfinite(limit) and all(_stands(bricks, direction, factor * limit) for factor in FACTORS[:2]):
            return Draw(kind, through, bricks, direction, limit)
    raise ArithmeticError(f"draw {number} found no case that statics decides")


def limit_of(bricks: Sequence[Brick], direction: Vector, most: float) -> float:
    """Return the force [N] up to which forces in the Coulomb cones balance; infinite above ``most``, NaN if none."""

    def holds(force: float) -> bool:
        return bool(solve_balance(*_problem(bricks, direction, force)).balanced)

    if holds(most):
        return math.inf
    low, high = 0.0, most
    while high - low > PRECISION * high:
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
        if high < 1e-3 * most:
            return math.nan
    return (low + high) / 2


def _problem(
    bricks: Sequence[Brick], direction: Vector, force: float
) -> tuple[FloatArray, FloatArray, list[Any], float, float]:
    """Return what the judge asks for; the force [N] counts as weight of the last body."""
    centers = np.array([brick.position for brick in bricks])
    weights = np.outer([brick.mass for brick in bricks], GRAVITY)
    weights[-1] += force * np.array(direction)
    return centers, weights, contact_patches(bricks), MU, LENGTH


def _stands(bricks: Sequence[Brick], direction: Vector, force: float) -> bool:
    return judge(*_problem(bricks, direction, force), gyration=Boxes.of(bricks).gyration).stable


@cache
def _draw(number: int) -> Draw:
    return draw_of(number)


def play(engine: str, profile: str, arm: str, number: int, factor: float) -> dict[str, Any]:
    """Play one case and return its figures."""
    draw = _draw(number)
    cube = _apart(draw.bricks[-1], draw.direction) if draw.through == "cube" else None
    stack = draw.bricks[:-1] if cube else draw.bricks
    with standing(engine, profile, ARMS[arm], stack, later=[cube] if cube else []) as stands:
        figures = _pressed(stands, cube, draw.direction, factor * draw.limit)
        return {"kind": draw.kind, "through": draw.through, "frozen": stands.is_frozen, **figures}


def _apart(cube: Brick, direction: Vector) -> Brick:
    """Return the cube, ``GAP`` before the stack towards which ``direction`` points."""
    x, y, z = (np.array(cube.position) - GAP * np.array(direction)).tolist()
    return replace(cube, position=(x, y, z))


def _pressed(stands: Standing, cube: Brick | None, direction: Vector, force: float) -> dict[str, Any]:
    simulation = stands.simulation
    frame_s = simulation.info.frame_s
    body = stands.bodies[-1] if cube is None else simulation.spawn(cube)
    stands.play(frame_s)
    stands.frames.disturb([body])
    stands.play(HELD_S)
    before = stands.positions()
    woken, moved = 0, 0.0
    for frame in range(round(PRESSED_S / frame_s)):
        share = min(1.0, (frame + 1) * frame_s / GROWTH_S)
        x, y, z = (share * force * np.array(direction)).tolist()
        simulation.apply_force(body, (x, y, z))
        woken += stands.play(frame_s)
        moved = float(np.linalg.norm(stands.positions() - before, axis=1).max())
        if not moved <= GONE:  # true for NaN too
            break
    return {"moved": not moved <= MOVED, "farthest": moved, "woken": woken}


def is_right(row: dict[str, Any]) -> bool:
    """Whether a stack moved if, and only if, its force exceeds the limit."""
    factor: float = row["key"][4]
    return bool(row["moved"] == (factor > 1.0))


def page(rows: Sequence[dict[str, Any]]) -> str:
    """Return the results as a page."""
    lines = [
        "# Steady forces on frozen stacks",
        "",
        f"Made by `uv run python -m tests.stability_core.{NAME}`, whose docstring says how each case is made and what",
        f"moves (seed {SEED}). A case is right if it moves and the force exceeds the limit of exact statics, or if it",
        f"does neither. At least {RIGHT:.0%} of {CASES} must be right; fewer are marked **no**.",
        "",
        *left_out(row["key"][2] for row in rows),
    ]
    groups: dict[tuple[str, ...], list[dict[str, Any]]] = {}
    for row in rows:
        groups.setdefault(tuple(row["key"][:3]), []).append(row)
    head = ["engine", "profile", "with", "cases", "right", *(f"{factor:g}" for factor in FACTORS)]
    cells = [[*key, *_cells(group)] for key, group in groups.items()]
    lines += ["## By factor", "", *table(head, cells), ""]
    kinds = list(product(("tower", "wall", "leaning tower"), ("cube", "top")))
    head = ["engine", "profile", "with", *(f"{kind}, {through}" for kind, through in kinds)]
    cells = [
        [*key, *(_share([row for row in group if (row["kind"], row["through"]) == kind]) for kind in kinds)]
        for key, group in groups.items()
    ]
    return "\n".join([*lines, "## By stack and live body", "", *table(head, cells), ""])


def _cells(group: Sequence[dict[str, Any]]) -> list[str]:
    right = sum(map(is_right, group)) / len(group)
    cells = [f"{len(group)}", f"{right:.1%}" + ("" if right >= RIGHT else " **no**")]
    return cells + [_share([row for row in group if row["key"][4] == factor]) for factor in FACTORS]


def _share(rows: Sequence[dict[str, Any]]) -> str:
    return f"{sum(map(is_right, rows))} of {len(rows)}"


def cases(count: int) -> Iterator[tuple[int, float]]:
    """Return ``count`` cases: numbers of draws, each with every factor."""
    return islice(product(range(count), FACTORS), count)


def options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=CASES)
    parser.add_argument("--engine", choices=ENGINES, nargs="+", default=ENGINES)
    parser.add_argument("--profile", choices=PROFILES, nargs="+", default=PROFILES)
    parser.add_argument("--arm", choices=tuple(ARMS), nargs="+", default=tuple(ARMS))
    return parser.parse_args()


if __name__ == "__main__":
    asked, core = options(), present_core()
    groups = product(asked.engine, asked.profile, asked.arm)
    keys = [(*group, *case) for group in groups for case in cases(asked.cases)]
    found = page(kept_runs(NAME, core, keys, play))
    print(found)  # noqa: T201 - the result
    if {(*group, *case) for group in product(ENGINES, PROFILES, NEEDED) for case in cases(FEWEST)} <= set(keys):
        write_page(PAGES / f"{NAME}.md", found, core)
