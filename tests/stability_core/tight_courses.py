"""Ten thousand tight courses: bricks laid side by side, their faces touching, on a pedestal they reach beyond.

    uv run python -m tests.stability_core.tight_courses [CASES]

writes ``docs/results/truth/tight_courses.md``; it goes on from where an earlier run was stopped. Each case is asked of
``solve_equilibrium`` and of the judge (``scenarios.statics.truth``), with the ideal contacts of the plan, and played
alone in three engines, tuned by experts, from the planned pose at rest: no drop, no placement noise. Where contact at
exactly zero gap decides, one engine is no truth; three that agree are.

A case has 1 to 3 courses of 2 to 4 bricks each, in the x-z plane. Each course begins at a random place and its bricks
touch at their ends, so that bricks which lie more than half beyond what carries them have a neighbour's side to rub on.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

from adapters import open_engine
from scenarios.model import Brick, World
from scenarios.statics.contact_patch import GROUND, contact_patches
from scenarios.statics.truth import equilibrium
from stability_core import Contacts, Masses, solve_equilibrium

SEED = 20261127
"""Named before the first run, and never changed."""
CASES = 10_000
ENGINES = ("mujoco", "bullet", "physx")
FRICTIONS = (0.3, 0.45, 0.6, 0.8)
TOGETHER = 20
"""Cases that are played in one world, side by side: they share its friction."""
PITCH = 0.6
"""Distance [m] between the cases of a world: more than any of their bricks falls."""
PLAYED_S = 0.75
"""From rest a brick 0.05 mm beyond its balance turns by 15 deg in this time [s]."""
FRAME_S = 1 / 60
FALLEN, STOOD = 3e-3, 0.5e-3
"""A case has fallen if a brick moved by more [m], stands if none moved by as much as the lesser; else it is unclear."""
HIGH, DEEP, DENSITY = 0.02, 0.03, 600.0
"""Height and depth [m] of a brick, and its density [kg/m3]."""
LEAST_REST = 3e-3
"""Least length [m] by which a brick overlaps what carries it."""
KEPT = Path("results/tight_courses/engines.jsonl")
"""What the engines did: the engines are asked once, core and judge whenever they have changed."""
PAGE = Path(__file__).parents[2] / "docs" / "results" / "truth" / "tight_courses.md"


class Outcome(NamedTuple):
    """What is said of a case, and what becomes of it."""

    core: str
    judge: str
    engines: tuple[str, ...]
    """In the order of ``ENGINES``: stands, falls or unclear."""


def courses(random: np.random.Generator) -> list[Brick]:
    """One case: the pedestal, and its courses from below."""
    half = random.uniform(0.04, 0.09)
    pedestal = (2 * half, DEEP, 0.1)
    bricks = [Brick(pedestal, 20 * DENSITY * float(np.prod(pedestal)), (0.0, 0.0, 0.05))]
    low, high = -half, half
    for course in range(random.integers(1, 4)):
        lengths = random.uniform(0.04, 0.08, random.integers(2, 5))
        first, last = low - 0.7 * lengths[0], high - lengths.sum() + 0.7 * lengths[-1]
        start = random.uniform(min(first, last), max(first, last))
        ends = start + np.concatenate([[0.0], np.cumsum(lengths)])
        carried = [
            (a, b)
            for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)
            if min(b, high) - max(a, low) > LEAST_REST
        ]
        for a, b in carried:
            mass = DENSITY * (b - a) * DEEP * HIGH * random.uniform(0.5, 3.0)
            at = ((a + b) / 2, 0.0, 0.1 + (course + 0.5) * HIGH)
            bricks.append(Brick((b - a, DEEP, HIGH), mass, at, level=course + 2))
        if not carried:
            break
        low, high = carried[0][0], carried[-1][1]
    return bricks


def cases(count: int) -> Iterator[tuple[float, list[list[Brick]]]]:
    """Worlds of ``TOGETHER`` cases that share a friction, ``count`` cases in all."""
    for world in range(-(-count // TOGETHER)):
        random = np.random.default_rng([SEED, world])
        friction = float(random.choice(FRICTIONS))
        size = min(TOGETHER, count - world * TOGETHER)
        yield friction, [courses(random) for _ in range(size)]


def ask_core(bricks: Sequence[Brick], friction: float) -> str:
    """The verdict of ``solve_equilibrium`` on the ideal contacts."""
    rows = [
        (patch.first, patch.second, point, patch.normal) for patch in contact_patches(bricks) for point in patch.points
    ]
    first, second, point, normal = zip(*rows, strict=True)
    n = len(rows)
    contacts = Contacts(
        np.array(first),
        np.array(second),
        np.array(point),
        np.array(normal),
        np.zeros(n),
        np.zeros((n, 3)),
        np.full(n, friction),
    )
    assert GROUND == -1
    position = np.array([brick.position for brick in bricks])
    masses = Masses(np.arange(len(bricks)), np.array([brick.mass for brick in bricks]), position)
    return solve_equilibrium(contacts, masses).verdict


def play(engine: str, friction: float, group: Sequence[Sequence[Brick]]) -> list[str]:
    """What becomes of each case of a world: stands, falls or unclear."""
    placed = [
        [replace(brick, position=(brick.position[0] + PITCH * at, *brick.position[1:])) for brick in bricks]
        for at, bricks in enumerate(group)
    ]
    every = [brick for bricks in placed for brick in bricks]
    simulation = open_engine(engine, "tuned", world=World(friction=friction), expected=every)
    try:
        for brick in every:
            simulation.spawn(brick)
        for _ in range(round(PLAYED_S / FRAME_S)):
            simulation.step(FRAME_S)
        _, position, _ = simulation.poses()
    finally:
        simulation.close()
    moved = np.linalg.norm(position - np.array([brick.position for brick in every]), axis=1)
    found, at = [], 0
    for bricks in placed:
        farthest = moved[at : at + len(bricks)].max()
        at += len(bricks)
        found.append("falls" if not farthest <= FALLEN else "stands" if farthest < STOOD else "unclear")
    return found


def play_world(at: int, friction: float, group: Sequence[Sequence[Brick]]) -> str:
    """What becomes of the cases of world ``at`` in each engine, as a line of JSON."""
    ends = {engine: play(engine, friction, group) for engine in ENGINES}
    return json.dumps({"world": at, **ends})


def play_all(count: int, file: Path) -> list[list[tuple[str, ...]]]:
    """What becomes of each case, world by world; kept in ``file``, line by line, from which a later run goes on."""
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    played = {row["world"]: row for row in map(json.loads, lines)}
    with file.open("a", encoding="utf-8") as out, ProcessPoolExecutor(1, get_context("spawn")) as pool:
        waiting = [pool.submit(play_world, at, *world) for at, world in enumerate(cases(count)) if at not in played]
        for future in as_completed(waiting):
            out.write(future.result() + "\n")
            out.flush()
            row = json.loads(future.result())
            played[row["world"]] = row
    return [list(zip(*(played[at][engine] for engine in ENGINES), strict=True)) for at in range(len(played))]


def ask_world(friction: float, group: Sequence[Sequence[Brick]]) -> list[tuple[str, str]]:
    """What core and judge say of the cases of one world."""
    world = World(friction=friction)
    return [(ask_core(bricks, friction), equilibrium(bricks, world).verdict) for bricks in group]


def decide_all(count: int, file: Path) -> Counter[Outcome]:
    """How often each outcome occurs."""
    counts: Counter[Outcome] = Counter()
    for world, ends in zip(cases(count), play_all(count, file), strict=True):
        counts.update(Outcome(*said, end) for said, end in zip(ask_world(*world), ends, strict=True))
    return counts


def engines_say(outcome: Outcome) -> str:
    """In which class a case falls by what the engines did."""
    falls, stands = outcome.engines.count("falls"), outcome.engines.count("stands")
    if falls == len(ENGINES):
        return "falls in all three"
    if falls == len(ENGINES) - 1:
        return "falls in two"
    if stands == len(ENGINES):
        return "stands in all three"
    return "else"


CLASSES = ("falls in all three", "falls in two", "stands in all three", "else")
VERDICTS = ("stable", "doubt", "unstable")


def table(counts: Counter[Outcome]) -> str:
    """The results as a page."""
    lines = [
        f"# {counts.total():,} tight courses",
        "",
        "Made by `uv run python -m tests.stability_core.tight_courses`, whose docstring says how each was drawn and",
        f"played (seed {SEED}, {', '.join(ENGINES)}, profile `tuned`, friction {', '.join(map(str, FRICTIONS))}).",
        "",
    ]
    for who, name in (("core", "`solve_equilibrium`"), ("judge", "the judge, `scenarios.statics.truth`")):
        lines += [
            f"Verdicts of {name}:",
            "",
            "| engines | cases | stable | doubt | unstable |",
            "|---|---|---|---|---|",
        ]
        for kind in CLASSES:
            found = Counter[str]()
            for outcome, n in counts.items():
                if engines_say(outcome) == kind:
                    found[getattr(outcome, who)] += n
            cells = " | ".join(
                f"{found[verdict]} ({found[verdict] / max(1, found.total()):.2%})" for verdict in VERDICTS
            )
            lines.append(f"| {kind} | {found.total()} | {cells} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    found = decide_all(int(sys.argv[1]) if sys.argv[1:] else CASES, KEPT)
    print(table(found))  # noqa: T201 - the result
    if found.total() == CASES:
        PAGE.write_text(table(found), encoding="utf-8")
