"""What a frame of the core costs while a pile is poured, and how much of the pile it freezes.

    uv run python -m tests.stability_core.pile_cost [--bricks N ...] [--engine E] [--draws D ...] [--forces 0 1]

writes ``docs/results/loads/pile_cost.md`` if no pile with forces is left out, and says which piles without forces are;
it goes on from where an earlier run was stopped.

Piles of ``poured_pile``, four bricks a second, engines' profile ``game``, policy ``equilibrium``; watched for ten
seconds after the last brick. Each update is timed by the processor time of its thread, less what the port took to read
and to steer the engine; the engine's step is timed alike. Python's garbage collector is off within a frame. A fixed
calculation is timed once a second: where its medians over ten seconds vary by more than 10 %, the machine was not
steady.
"""

from __future__ import annotations

import argparse
import gc
import time
from collections import Counter
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from adapters import open_engine
from adapters.base import Simulation
from bench.machine.calibration import calibrate
from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from bench.trial.builder import Builder
from bench.trial.timed_port import TimedPort
from scenarios.model import Scene
from scenarios.scenes.poured_pile import poured_pile
from stability_core import StabilityExtension, warm_up
from tests.stability_core.loaded_stacks import PAGES, Arm, kept_runs, table

ENGINES = ("bullet", "mujoco")
BRICKS = (300,)
DRAWS = (1, 2, 3)
FORCES = (1, 0)
"""Whether contacts have forces."""
POLICY = "equilibrium"
PROFILE = "game"
PERCENTILES = (50, 95, 99, 100)
MOST_MS = {50: 1.0, 99: 8.0}
"""Targets for 300 bricks, by percentile."""
LEAST_FROZEN, MOST_WAKES = 0.8, 0.1
"""Share of the pile that is frozen in the end, and wakes a freeze."""
STEADY = 0.1
"""Greatest spread of the fixed calculation."""
NAME = "pile_cost"


def play(engine: str, bricks: int, draw: int, forces: int) -> dict[str, Any]:
    """Pour one pile and return its figures."""
    scene = poured_pile(bricks=bricks, draw=draw)
    profile = Arm(POLICY, reads_forces=bool(forces)).profile(PROFILE)
    simulation = open_engine(engine, profile, world=scene.world, expected=scene.bricks)
    try:
        return _poured(scene, simulation)
    finally:
        simulation.close()


def _poured(scene: Scene, simulation: Simulation) -> dict[str, Any]:
    """Pour a pile into an empty world, frame by frame, and return its figures."""
    port = TimedPort(simulation.port, time.thread_time)
    extension = StabilityExtension(port, POLICY)
    builder = Builder(scene, simulation)
    frame_s = simulation.info.frame_s
    frames = round((scene.actions[-1].time + scene.watch_s) / frame_s)
    core, engine, reading = (np.zeros(frames) for _ in range(3))
    wakes, freezes, fixed = Counter[str](), 0, []
    for frame in range(frames):
        builder.act(frame * frame_s)
        port.reset()
        gc.disable()
        begin = time.thread_time()
        simulation.step(frame_s)
        stepped = time.thread_time()
        change = extension.update(frame_s)
        end = time.thread_time()
        gc.enable()
        reading[frame] = port.readback_s + port.steering_s
        engine[frame], core[frame] = stepped - begin, end - stepped - reading[frame]
        freezes += len(change.frozen)
        wakes.update(change.reasons[body] for body in change.woken)
        if frame % round(1 / frame_s) == 0:
            fixed.append(float(np.median(calibrate(time.thread_time))))
    times = {"core": core, "engine": engine, "reading": reading}
    return {
        "frozen": len(simulation.frozen) / len(simulation.bricks),
        "freezes": freezes,
        "wakes": dict(wakes.most_common()),
        "steady": spread(fixed),
        **{name: (1e3 * np.percentile(values, PERCENTILES)).tolist() for name, values in times.items()},
    }


def spread(fixed: Sequence[float]) -> float:
    """Return the range of the medians of ten times each, over their median."""
    medians = [float(np.median(fixed[start : start + 10])) for start in range(0, max(1, len(fixed) - 9), 10)]
    return (max(medians) - min(medians)) / float(np.median(medians))


def page(rows: Sequence[dict[str, Any]]) -> str:
    """Return the results as a page."""
    played = {tuple(row["key"]) for row in rows}
    left_out = [key for key in product(ENGINES, BRICKS, DRAWS, FORCES) if key not in played]
    missing = [f"{engine} draw {draw} with{'' if forces else 'out'} forces" for engine, _, draw, forces in left_out]
    lines = [
        "# What a poured pile costs",
        "",
        f"Made by `uv run python -m tests.stability_core.{NAME}`, whose docstring says how each pile is poured and",
        f"timed. Milliseconds a frame, {' / '.join('max' if p == 100 else f'p{p}' for p in PERCENTILES)}.",
        "",
        "- Engine: its step. Reading: what the port took to read and to steer it.",
        "- Frozen: share of the bricks ten seconds after the last one.",
        "- Steady: spread of the fixed calculation.",
        f"- **no**: misses a target for 300 bricks, core p50 {MOST_MS[50]:g} ms, p99 {MOST_MS[99]:g} ms,",
        f"  {LEAST_FROZEN:.0%} frozen, {MOST_WAKES:g} wakes a freeze; or the spread is above {STEADY:.0%}.",
        "",
        *([f"Not poured with this core: {'; '.join(missing)}.", ""] if missing else []),
    ]
    head = ["engine", "bricks", "draw", "forces", "core", "engine step", "reading", "frozen", "freezes", "wakes"]
    lines += [*table([*head, "wakes a freeze", "steady"], map(_cells, rows)), "", "Why bricks were woken:", ""]
    why = Counter[str]()
    for row in rows:
        why.update(row["wakes"])
    return "\n".join([*lines, *table(["reason", "wakes"], [(reason, f"{n}") for reason, n in why.most_common(8)]), ""])


def _cells(row: dict[str, Any]) -> list[str]:
    engine, bricks, draw, forces = row["key"]
    times = dict(zip(PERCENTILES, row["core"], strict=True))
    wakes = sum(row["wakes"].values())
    ratio = wakes / max(1, row["freezes"])
    is_fast = all(times[percentile] <= most for percentile, most in MOST_MS.items())
    core, step, reading = (" / ".join(f"{ms:.2f}" for ms in row[name]) for name in ("core", "engine", "reading"))
    return [
        *(engine, f"{bricks}", f"{draw}", "yes" if forces else "no"),
        *(core + _missed(is_fast), step, reading),
        *(f"{row['frozen']:.0%}" + _missed(row["frozen"] >= LEAST_FROZEN), f"{row['freezes']}", f"{wakes}"),
        *(f"{ratio:.2f}" + _missed(ratio <= MOST_WAKES), f"{row['steady']:.0%}" + _missed(row["steady"] <= STEADY)),
    ]


def _missed(is_met: bool) -> str:
    return "" if is_met else " **no**"


def options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--engine", choices=ENGINES, nargs="+", default=ENGINES)
    parser.add_argument("--bricks", type=int, nargs="+", default=BRICKS)
    parser.add_argument("--draws", type=int, nargs="+", default=DRAWS)
    parser.add_argument("--forces", type=int, choices=FORCES, nargs="+", default=FORCES)
    return parser.parse_args()


if __name__ == "__main__":
    asked, core = options(), present_core()
    warm_up(POLICY)
    keys = list(product(asked.engine, asked.bricks, asked.draws, asked.forces))
    found = page(kept_runs(NAME, core, keys, play))
    print(found)  # noqa: T201 - the result
    if set(product(ENGINES, BRICKS, DRAWS, (1,))) <= set(keys):
        write_page(PAGES / f"{NAME}.md", found, core)
