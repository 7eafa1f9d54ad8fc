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
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from adapters import open_engine
from bench.machine.core_digest import digest_of, present_core
from bench.publishing.page_marks import write_page
from scenarios import statics
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
KEPT = Path("results/tight_courses")
"""What engines and judge said: each is asked once, the core anew in each run."""
RENEWED = 100
"""Count of tasks after which the process that answers is renewed."""
REFINED = {"mujoco": "tuned@substeps=64", "bullet": "tuned@substeps=32", "staggered": "default"}
"""Engines that are asked where verdict and engines differ: MuJoCo and Bullet again, with an eighth of the step, because
what a step does to a contact that only just holds shrinks with the step, what statics does to it stays; and the
reference engine ``staggered``, whose contacts do not give. PhysX is not asked: its side contacts may stick at a small
step, so that cases which only prestress could hold stand."""
CONTROLS = 100
"""Cases in doubt that fall in all three engines, drawn to be asked again as well: these must go on falling."""
PAGE = Path(__file__).parents[2] / "docs" / "results" / "truth" / "tight_courses.md"


class Outcome(NamedTuple):
    """What is said of a case, and what becomes of it."""

    core: str
    judge: str
    engines: tuple[str, ...]
    """In the order of ``ENGINES``: stands, falls or unclear."""


class Case(NamedTuple):
    """One case, where it is found again, and what was said of it."""

    at: int
    """Its number, counted over all worlds."""
    friction: float
    bricks: list[Brick]
    outcome: Outcome


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


def world(at: int, size: int = TOGETHER) -> tuple[float, list[list[Brick]]]:
    """World ``at``: its friction, and the first ``size`` of its cases."""
    random = np.random.default_rng([SEED, at])
    friction = float(random.choice(FRICTIONS))
    return friction, [courses(random) for _ in range(size)]


def cases(count: int) -> Iterator[tuple[float, list[list[Brick]]]]:
    """Worlds of ``TOGETHER`` cases that share a friction, ``count`` cases in all."""
    for at in range(-(-count // TOGETHER)):
        yield world(at, min(TOGETHER, count - at * TOGETHER))


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


def play(engine: str, profile: str, friction: float, group: Sequence[Sequence[Brick]]) -> list[str]:
    """What becomes of each case of a world: stands, falls or unclear."""
    placed = [
        [replace(brick, position=(brick.position[0] + PITCH * at, *brick.position[1:])) for brick in bricks]
        for at, bricks in enumerate(group)
    ]
    every = [brick for bricks in placed for brick in bricks]
    simulation = open_engine(engine, profile, world=World(friction=friction), expected=every)
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


def play_world(friction: float, group: Sequence[Sequence[Brick]]) -> list[list[str]]:
    """What becomes of the cases of a world, a list for each of ``ENGINES``."""
    return [play(engine, "tuned", friction, group) for engine in ENGINES]


def judge_world(friction: float, group: Sequence[Sequence[Brick]]) -> list[str]:
    """What the judge says of the cases of a world."""
    return [equilibrium(bricks, World(friction=friction)).verdict for bricks in group]


def refine(friction: float, bricks: Sequence[Brick]) -> list[str]:
    """What becomes of one case in each engine of ``REFINED``."""
    return [play(engine, profile, friction, [bricks])[0] for engine, profile in REFINED.items()]


def kept(file: Path, ask: Callable[..., Any], tasks: Mapping[int, tuple[Any, ...]]) -> dict[int, Any]:
    """Ask for each task by its number, in another process; answers are appended to ``file``, where a run goes on.

    Engines keep some memory of each world: the process is renewed after ``RENEWED`` tasks. The pool is renewed with it,
    because a pool of Python 3.11 that renews its only process by itself (``max_tasks_per_child``) stops for ever.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    known = {row["at"]: row["said"] for row in map(json.loads, lines)}
    waiting = [at for at in tasks if at not in known]
    with file.open("a", encoding="utf-8") as out:
        for begin in range(0, len(waiting), RENEWED):
            some = waiting[begin : begin + RENEWED]
            with ProcessPoolExecutor(1, get_context("spawn")) as pool:
                for at, future in [(at, pool.submit(ask, *tasks[at])) for at in some]:
                    known[at] = future.result()
                    out.write(json.dumps({"at": at, "said": known[at]}) + "\n")
                    out.flush()
    return {at: known[at] for at in tasks}


def digest_of_the_judge() -> str:
    """Which judge it was."""
    folder = Path(statics.__file__).parent
    return digest_of({path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.py")})


def decide_all(count: int) -> list[Case]:
    """All cases, with what core, judge and engines say."""
    worlds = dict(enumerate(cases(count)))
    played = kept(KEPT / "engines.jsonl", play_world, worlds)
    judged = kept(KEPT / f"judge-{digest_of_the_judge()}.jsonl", judge_world, worlds)
    found = []
    for at, (friction, group) in worlds.items():
        for place, bricks in enumerate(group):
            ends = tuple(of_engine[place] for of_engine in played[at])
            outcome = Outcome(ask_core(bricks, friction), judged[at][place], ends)
            found.append(Case(at * TOGETHER + place, friction, bricks, outcome))
    return found


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


def is_denied(outcome: Outcome) -> bool:
    """Whether two engines or more deny what core or judge says."""
    stable = {outcome.core == "stable", outcome.judge == "stable"}
    return (True in stable and engines_say(outcome) in CLASSES[:2]) or (
        False in stable and engines_say(outcome) == CLASSES[2]
    )


def drawn_controls(found: Sequence[Case]) -> list[Case]:
    """Cases in doubt by core and judge that fall in all three engines, up to ``CONTROLS`` of them."""
    doubted = [
        case
        for case in found
        if case.outcome.core == case.outcome.judge == "doubt" and engines_say(case.outcome) == CLASSES[0]
    ]
    order = np.random.default_rng([SEED, len(doubted)]).permutation(len(doubted))
    return [doubted[k] for k in order[:CONTROLS].tolist()]


def verdict_table(found: Sequence[Case]) -> list[str]:
    """What core and judge say, by what the engines did."""
    lines = []
    for who, name in (("core", "`solve_equilibrium`"), ("judge", "the judge, `scenarios.statics.truth`")):
        lines += [
            f"Verdicts of {name}:",
            "",
            "| engines | cases | stable | doubt | unstable |",
            "|---|---|---|---|---|",
        ]
        for kind in CLASSES:
            said = Counter(getattr(case.outcome, who) for case in found if engines_say(case.outcome) == kind)
            cells = " | ".join(f"{said[verdict]} ({said[verdict] / max(1, said.total()):.2%})" for verdict in VERDICTS)
            lines.append(f"| {kind} | {said.total()} | {cells} |")
        lines.append("")
    return lines


def refined_table(found: Sequence[Case]) -> list[str]:
    """What becomes in the engines of ``REFINED`` of the cases in which engines deny a verdict, and of the controls."""
    denied, controls = [case for case in found if is_denied(case.outcome)], drawn_controls(found)
    tasks = {case.at: (case.friction, case.bricks) for case in (*denied, *controls)}
    said = kept(KEPT / "refined.jsonl", refine, tasks)
    rows = [
        (
            f"{verdict} by the {who}, {kind}",
            [case for case in denied if getattr(case.outcome, who) == verdict and engines_say(case.outcome) == kind],
        )
        for who in ("core", "judge")
        for verdict, kinds in (("stable", CLASSES[:2]), ("doubt", CLASSES[2:3]), ("unstable", CLASSES[2:3]))
        for kind in kinds
    ]
    rows.append(("doubt by both, falls in all three (drawn)", controls))
    asked = ", ".join(f"{engine} `{profile}`" for engine, profile in REFINED.items())
    lines = [
        f"Asked once more: {asked}.",
        "MuJoCo and Bullet have an eighth of their tuned step there; the contacts of the reference engine do not give.",
        "",
        "| verdict, engines at their tuned step | cases | "
        + " | ".join(f"{engine}: stands / falls / unclear" for engine in REFINED)
        + " |",
        "|---|---|" + "---|" * len(REFINED),
    ]
    for name, group in rows:
        cells = []
        for k in range(len(REFINED)):
            ends = Counter(said[case.at][k] for case in group)
            cells.append(f"{ends['stands']} / {ends['falls']} / {ends['unclear']}")
        lines.append(f"| {name} | {len(group)} | {' | '.join(cells)} |")
    return [*lines, ""]


def page(found: Sequence[Case]) -> str:
    """The results as a page."""
    head = [
        f"# {len(found):,} tight courses",
        "",
        "Made by `uv run python -m tests.stability_core.tight_courses`, whose docstring says how each was drawn and",
        f"played (seed {SEED}, {', '.join(ENGINES)}, profile `tuned`, friction {', '.join(map(str, FRICTIONS))}).",
        "",
    ]
    return "\n".join([*head, *verdict_table(found), *refined_table(found)])


if __name__ == "__main__":
    cases_found = decide_all(int(sys.argv[1]) if sys.argv[1:] else CASES)
    text = page(cases_found)
    print(text)  # noqa: T201 - the result
    if len(cases_found) == CASES:
        write_page(PAGE, text, present_core())
