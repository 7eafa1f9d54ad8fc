"""What a frame of the core costs, against its targets.

    uv run python -m tests.benchmarks.core_speed

writes ``docs/results/speed/README.md``. Each plank is watched from its first frame to the one in which it joins, so
that the dearest of them shows, wherever a policy does its work.
"""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from bench.machine.calibration import calibrate
from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from stability_core import StabilityExtension, solve_equilibrium
from tests.benchmarks.leaning_worlds import MASS, house_of, overload, pile_up, refuse_smooth_v
from tests.benchmarks.peers import PEERS, four_stack, pyramid
from tests.benchmarks.worlds import (
    DT,
    CarpetPort,
    GrowingStack,
    coming_to_rest,
    plank_of_four_stack,
    plank_of_wall,
    quiet,
)
from tests.stability_core.dwell import REST_FRAMES

Times: TypeAlias = Any
"""A list or an array of times."""
PAGE = Path(__file__).parents[2] / "docs" / "results" / "speed" / "README.md"
POLICIES = ("equilibrium", "paper")
STACKS = {"4-stack": plank_of_four_stack, "wall": plank_of_wall}
FROZEN = (12, 100, 1000)
QUIET = (10, 100, 1000, 10_000)
ROUNDS = 200
PASSES = 5
SAMPLED_S, PATIENCE_S, STILL_QUIET = 5.0, 3.0, 1.1
"""How long the fixed calculation is sampled; how long a pass waits for a quiet moment; what still counts as one."""
SOLVED = (12, 100, 300)
"""Planks of the 4-stacks that the solvers of others solve too."""
SOLVES = 5
REFUSALS = 40
PILES = range(1, 7)
"""Seeds of the random piles; another one warms up."""
FIRST = 10
"""Rounds that are not counted: the first ones read the kernels from the disk and fill the caches."""
HEAD = f"""# What a frame of the core costs

Written by `uv run python -m tests.benchmarks.core_speed`: microseconds of processor time of the core's thread, the
scripted port included, {ROUNDS} times each, Python's garbage collector off. The processor was shared with other work,
which slows it down by turns of a second or less: each row is that one of {PASSES} passes which has the least median,
and a pass begins when a fixed calculation takes as little as it ever does here.
Each target is a median for `equilibrium` unless it says otherwise; ✓ met, ✗ missed; `paper` stands beside it.
"""


def timed(act: Callable[[], object], clock: Callable[[], int] = time.thread_time_ns) -> float:
    """Processor time [us] of one act."""
    start = clock()
    act()
    return (clock() - start) / 1e3


@cache
def undisturbed() -> float:
    """Time [ms] of a fixed calculation while nothing else slows the processor down: the least in some seconds."""
    deadline = time.perf_counter() + SAMPLED_S
    least = math.inf
    while time.perf_counter() < deadline:
        least = min(least, *calibrate())
    return least


def after_a_quiet_moment(measure: Callable[[], Times]) -> Times:
    """What is measured from a quiet moment on, or after some seconds of waiting for one in vain."""
    deadline = time.perf_counter() + PATIENCE_S
    while min(calibrate()) > STILL_QUIET * undisturbed() and time.perf_counter() < deadline:
        pass
    return measure()


def least_disturbed(measure: Callable[[], Times], output: Callable[[Times], float] = np.median) -> Times:
    """The times of the pass with the least figure: other work slows a processor down, nothing speeds it up."""
    return min((after_a_quiet_moment(measure) for _ in range(PASSES)), key=output)


def one_plank_more(plank, n: int, policy: str) -> np.ndarray:
    """Times [us] of each frame from a plank's first to the one in which it joins, shape (rounds, frames)."""
    stack = GrowingStack(plank, n, policy)
    times = []
    for _ in range(FIRST + ROUNDS):
        stack.place_one_more()
        times.append([timed(stack.frame) for _ in range(REST_FRAMES + 1)])
    stack.check()
    return np.array(times[FIRST:])


def repeated(extension: StabilityExtension) -> np.ndarray:
    """Times [us] of one frame after the other, shape (rounds,)."""
    return np.array([timed(lambda: extension.update(DT)) for _ in range(FIRST + ROUNDS)])[FIRST:]


def each_first(policy: str) -> np.ndarray:
    """Times [us] of the frame in which a hundred bricks freeze, each in a world of its own, shape (rounds,)."""
    worlds = (coming_to_rest(100, policy) for _ in range(FIRST + ROUNDS))
    return np.array([timed(lambda world=world: world.update(DT)) for world in worlds])[FIRST:]


def refusals() -> list[float]:
    """The dearest frame [s] of each V that must slip, in the place of a house's topmost one."""
    watch = house_of(8, -1)
    watch.longest.clear()
    for round_ in range(REFUSALS):
        refuse_smooth_v(watch, 200 + 2 * round_)
    return watch.longest


def overloads() -> list[float]:
    """The dearest frame [s] in which a heavy brick off the centre wakes the top of the house: a house each."""
    longest = []
    for _ in range(5):
        watch = house_of(8)
        watch.world.mass[200] = 20 * MASS
        watch.grow(overload(200))
        longest.append(watch.longest[-1])
    return longest


def solved(solve: Callable[[], bool]) -> list[float]:
    """Processor times [us] of the whole process for some solves: solvers of others may use threads."""
    return [timed(solve, time.process_time_ns) for _ in range(SOLVES)]


def piles() -> list[float]:
    """The dearest frame [s] of each plank of the random piles."""
    return [time for seed in PILES for time in pile_up(seed, 100).longest]


def against(value: float, target: float) -> str:
    """The target, and whether it is met."""
    return f"{target:g} {'✓' if value <= target else '✗'}"


def growth_table() -> list[str]:
    """One plank more, and how the cost grows with the stack."""
    lines = [
        "## One plank more",
        "",
        "The frame in which a plank joins a frozen stack of N to 1.25 N planks; and the dearest frame of each plank,",
        "which for `paper` is the one that carries its weight down to the ground.",
        "",
        "| policy | stack | N | median | target | p99 | target | dearest frame, median |",
        "|---|---|---|---|---|---|---|---|",
    ]
    ratios = []
    for policy in POLICIES:
        is_judged = policy == "equilibrium"
        for stack, plank in STACKS.items():
            medians = []
            for n in FROZEN:
                frames = least_disturbed(
                    partial(one_plank_more, plank, n, policy), lambda frames: np.median(frames[:, -1])
                )
                median, p99 = np.percentile(frames[:, -1], [50, 99])
                medians.append(median)
                lines.append(
                    f"| `{policy}` | {stack} | {n} | {median:.1f} | {against(median, 20) if is_judged else ''} "
                    f"| {p99:.0f} | {against(p99, 200) if is_judged and n <= 100 else ''} "
                    f"| {np.median(frames.max(axis=1)):.1f} |"
                )
            if is_judged:
                growth = medians[-1] / medians[0]
                ratios.append(f"{growth:.2f} on a {stack} (at most {against(growth, 2)})")
    return [*lines, "", f"`equilibrium` at N = {FROZEN[-1]} against N = {FROZEN[0]}: {', '.join(ratios)}.", ""]


def live_table() -> list[str]:
    """Frames in which nothing freezes, and the one in which a hundred bricks do."""
    lines = [
        "## Other frames",
        "",
        "| frame | policy | median | target | p99 |",
        "|---|---|---|---|---|",
    ]
    for policy in POLICIES:
        moving = StabilityExtension(CarpetPort(100, is_moving=True), policy)
        rows = [(f"quiet, one live brick, {n} frozen", partial(repeated, quiet(n, policy)), 30) for n in QUIET]
        rows.append((f"nothing live, {QUIET[-1]} frozen", partial(repeated, quiet(QUIET[-1], policy, live=0)), 30))
        rows.append(("100 live bricks, moving", partial(repeated, moving), 400))
        rows.append(("100 live bricks come to rest at once", partial(each_first, policy), 400))
        for frame, measure, target in rows:
            median, p99 = np.percentile(least_disturbed(measure), [50, 99])
            lines.append(f"| {frame} | `{policy}` | {median:.1f} | {against(median, target)} | {p99:.0f} |")
    return [*lines, ""]


def solved_table() -> list[str]:
    """Planks that no safe region decides."""
    house_of(8)
    pile_up(0, 100)
    rows = [
        ("card house of 8 storeys, a V or roof more", lambda: house_of(8).longest, 7),
        ("card house of 8 storeys, a V refused that slips", refusals, 20),
        ("card house of 8 storeys, an overload that wakes the topmost V", overloads, 20),
        ("random piles, 100 planks let go", piles, 5),
    ]
    lines = [
        "## Where statics is solved",
        "",
        "The dearest frame of each plank in milliseconds, refusals included, by `equilibrium`. What does not freeze is",
        "taken away before the next plank comes.",
        "",
        "| case | planks or groups | median | p99 | target of p99 |",
        "|---|---|---|---|---|",
    ]
    for case, measure, target in rows:
        times = least_disturbed(measure)
        median, p99 = 1e3 * np.percentile(times, [50, 99])
        lines.append(f"| {case} | {len(times)} | {median:.2f} | {p99:.2f} | {against(p99, target)} |")
    return [*lines, ""]


def peers_table() -> list[str]:
    """The same statics by solvers of others."""
    lines = [
        "## Peers",
        "",
        "A 4-stack of N planks, solved as a whole, in milliseconds (median). HiGHS and PIQP are given a pyramid in",
        "place of the cone of friction, and their matrices ready made; an update makes the topmost plank a tenth",
        "heavier. Threads of theirs count. The policy solves nothing here: see the first table for a plank more.",
        "",
        "| solver | " + " | ".join(f"N = {n}" for n in SOLVED) + " |",
        "|---|" + "---|" * len(SOLVED),
    ]
    solvers = {"`solve_equilibrium` from scratch": lambda world: lambda: solve_equilibrium(*world).stable}
    solvers |= {name: lambda world, peer=peer: peer(*pyramid(*world)) for name, peer in PEERS.items()}
    for name, solver in solvers.items():
        medians = []
        for n in SOLVED:
            solve = solver(four_stack(n))
            assert solve(), "a 4-stack stands"
            medians.append(np.median(least_disturbed(partial(solved, solve))) / 1e3)
        lines.append(f"| {name} | " + " | ".join(f"{median:.2f}" for median in medians) + " |")
    return [*lines, ""]


if __name__ == "__main__":
    core = present_core()
    gc.disable()
    write_page(PAGE, "\n".join([HEAD, *growth_table(), *live_table(), *solved_table(), *peers_table()]), core)
