"""Piles that have come to rest in an engine: how many of their bodies does exact statics leave in doubt?

    uv run python -m tests.stability_core.piles_at_rest

writes ``docs/results/truth/piles_at_rest.md``. Bricks of poured_pile's sizes fall in a loose lattice, each turned at
random, into a pile in Bullet (profile ``tuned``), until none moves faster than a millimetre a second, or for twenty
seconds. Then ``solve_equilibrium`` is asked about what the engine shows: contacts that touch, to 20 micrometres.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from adapters import open_engine
from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from scenarios.model import Brick, World
from stability_core import Contacts, Masses, solve_equilibrium

SEED = 20261127
SIZES = (50, 100, 200, 400)
PILES = 3
"""Piles of each size."""
FRAME_S, LONGEST_S = 1 / 60, 20.0
AT_REST = 1e-3
"""Speed [m/s]."""
TOUCHING = 20e-6
"""Gap [m] up to which bodies touch: ``Settings.touch_gap`` of a brick of 6 cm."""
SPACING = 0.07
"""Of the lattice from which they fall [m]."""
PAGE = Path(__file__).parents[2] / "docs" / "results" / "truth" / "piles_at_rest.md"


class Found(NamedTuple):
    """What statics says of one pile."""

    bodies: int
    contacts: int
    verdict: str
    in_doubt: int
    seconds: float
    """For the solve."""


def bricks_of(count: int, random: np.random.Generator) -> list[Brick]:
    """Bricks of 2 to 6 cm in a lattice above the ground, turned at random."""
    side = int(np.ceil(np.sqrt(count / 3)))
    bricks = []
    for at in range(count):
        layer, place = divmod(at, side * side)
        x, y = place % side, place // side
        position = SPACING * np.array([x - side / 2, y - side / 2, layer + 1.0]) + random.normal(0, 0.003, 3)
        size = random.uniform(0.02, 0.06, 3)
        quaternion = random.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        bricks.append(
            Brick(
                tuple(size.tolist()), 600.0 * float(np.prod(size)), tuple(position.tolist()), tuple(quaternion.tolist())
            )
        )
    return bricks


def pile_at_rest(count: int, seed: int) -> tuple[Contacts, Masses]:
    """What Bullet shows of a pile that has come to rest."""
    random = np.random.default_rng([SEED, count, seed])
    bricks = bricks_of(count, random)
    simulation = open_engine("bullet", "tuned", world=World(friction=0.45), expected=bricks)
    try:
        port = simulation.port
        for brick in bricks:
            simulation.spawn(brick)
        for frame in range(round(LONGEST_S / FRAME_S)):
            simulation.step(FRAME_S)
            if frame > 120 and np.abs(simulation.velocities()[0]).max() < AT_REST:
                break
        contacts, masses = port.contacts(), port.masses()
    finally:
        simulation.close()
    touching = contacts.separation <= TOUCHING
    return contacts.chosen(touching), masses


def ask(count: int, seed: int) -> Found:
    """What statics says of one pile."""
    contacts, masses = pile_at_rest(count, seed)
    start = time.perf_counter()
    found = solve_equilibrium(contacts, masses)
    seconds = time.perf_counter() - start
    return Found(count, len(contacts), found.verdict, int(found.in_doubt.sum()), seconds)


def table(found: list[Found]) -> str:
    """The results as a page."""
    lines = [
        "# Piles at rest",
        "",
        "Made by `uv run python -m tests.stability_core.piles_at_rest`, whose docstring says how the piles were made",
        f"(seed {SEED}).",
        "",
        "| bodies | contacts | verdict | bodies in doubt | solve [s] |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.bodies} | {row.contacts} | {row.verdict} | {row.in_doubt} ({row.in_doubt / row.bodies:.1%}) "
        f"| {row.seconds:.2f} |"
        for row in found
    ]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    ask(SIZES[0], PILES)  # compiles the kernels
    results = []
    for bodies in SIZES:
        for pile in range(PILES):
            results.append(ask(bodies, pile))
            print(results[-1], flush=True)  # noqa: T201 - progress of some minutes
    write_page(PAGE, table(results), present_core())
