"""The cost of two frames of the core in instructions, which other work on the machine does not change.

    uv run python -m tests.benchmarks.core_instructions                     prints the figures
    uv run python -m tests.benchmarks.core_instructions --save base.json    and keeps them
    uv run python -m tests.benchmarks.core_instructions --against base.json exit status 1 if a frame costs 2 % more

The counter is that of the processor where the system permits it; else Callgrind, where Valgrind is installed (a minute,
after kernels are compiled once); else there are no counts, and the figures are processor time, which finds a quarter.
"""

from __future__ import annotations

import argparse
import gc
import json
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from bench.machine import callgrind
from bench.machine.instructions import COUNTED, InstructionCounter, availability
from bench.machine.kernel_cache import keep_kernels_apart

keep_kernels_apart()  # before Numba is imported

from tests.benchmarks.worlds import DT, GrowingStack, plank_of_four_stack, quiet  # noqa: E402

POLICY = "equilibrium"
FROZEN, PLANKS = 100, 12
"""Frozen planks of the quiet frame; planks of the 4-stack on which one more joins."""
FRAMES, BLOCKS, FIRST = 50, 20, 4
"""Quiet frames of a block; blocks, of which the median is the figure; blocks before, in which Python specialises its
bytecode."""
LARGER = {"instructions": 0.02, "microseconds": 0.25}
"""Least growth that is an alarm, by unit: ten times the spread of counts, and the spread of processor times of one code
on a shared machine (``bench.compare.benchmarks``)."""

Count = Callable[[Callable[[], object]], float]
"""Type of a function that returns the cost of an act."""


def quiet_blocks(count: Count) -> list[float]:
    """Cost of a quiet frame with one live brick, in each block."""
    extension = quiet(FROZEN, POLICY)

    def block() -> None:
        for _ in range(FRAMES):
            extension.update(DT)

    return [count(block) / FRAMES for _ in range(FIRST + BLOCKS)][FIRST:]


def joining_frames(count: Count) -> list[float]:
    """Cost of each frame in which a plank joins a 4-stack."""
    stack = GrowingStack(plank_of_four_stack, PLANKS, POLICY)
    costs = []
    for _ in range(FIRST + BLOCKS):
        stack.until_it_joins()
        costs.append(count(stack.frame))
    stack.check()
    return costs[FIRST:]


def costs(count: Count) -> dict[str, list[float]]:
    """Costs of both frames, by name."""
    gc.disable()
    return {"quiet frame": quiet_blocks(count), "one plank more": joining_frames(count)}


def of_processor() -> Count:
    """A counter by the processor."""
    counter = InstructionCounter()

    def count(act: Callable[[], object]) -> float:
        begin = counter()
        act()
        return counter() - begin

    return count


def thread_time(act: Callable[[], object]) -> float:
    """Processor time of an act [us]."""
    begin = time.thread_time_ns()
    act()
    return (time.thread_time_ns() - begin) / 1e3


def under_callgrind(*imports: str) -> dict[str, list[float]]:
    """Costs of both frames in a process under Callgrind, which imports some modules first."""
    script = f"import {', '.join([*imports, 'tests.benchmarks.core_instructions as m'])}; m.print_counts()"
    with tempfile.TemporaryDirectory() as folder:
        command, environment = callgrind.command_under_callgrind([sys.executable, "-c", script], Path(folder, "counts"))
        warm_up = "from tests.benchmarks.worlds import quiet; quiet(1, 'equilibrium')"  # compiles without Valgrind
        subprocess.run([sys.executable, "-c", warm_up], env=environment, check=True)
        done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def print_counts() -> None:
    """Print the costs of both frames as JSON: the program that runs under Callgrind."""
    print(json.dumps(costs(callgrind.CallgrindCounter().count)))  # noqa: T201 - for the process that started it


def measured() -> dict[str, object]:
    """Figures with their unit, and all on which they depend."""
    counts, obstacle = availability(), callgrind.obstacle()
    if counts == COUNTED:
        counter, unit, found = f"processor: {platform.processor()}", "instructions", costs(of_processor())
    elif obstacle is None:
        counter, unit, found = "Callgrind", "instructions", under_callgrind()
    else:
        print(f"no instructions are counted: {counts}; {obstacle}. Processor time instead:")  # noqa: T201
        counter, unit, found = f"time: {platform.node()}", "microseconds", costs(thread_time)
    return {
        "unit": unit,
        "conditions": {"counter": counter, "python": platform.python_version(), "machine": platform.machine()}
        | {name: version(name) for name in ("numpy", "numba", "llvmlite")},
        "figures": {name: statistics.median(values) for name, values in found.items()},
    }


def growths(base: dict, head: dict) -> dict[str, float]:
    """Growth of each figure from base to head, as a share of base.

    Raises:
        ValueError: if both were not measured in the same way.
    """
    was, now = base["conditions"] | {"unit": base["unit"]}, head["conditions"] | {"unit": head["unit"]}
    if was != now:
        different = ", ".join(f"{name}: {now[name]}, was {was.get(name)}" for name in now if now[name] != was.get(name))
        raise ValueError(f"cannot be compared ({different}): measure the base again in the same way, with --save")
    return {name: head["figures"][name] / value - 1 for name, value in base["figures"].items()}


def main() -> int:
    """Measure, print, keep and compare; the exit status."""
    parser = argparse.ArgumentParser(description="The core's cost in instructions.")
    parser.add_argument("--save", type=Path, metavar="FILE")
    parser.add_argument("--against", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    head = measured()
    growth = {}
    if arguments.against is not None:
        try:
            growth = growths(json.loads(arguments.against.read_text(encoding="utf-8")), head)
        except ValueError as error:
            print(f"{arguments.against}: {error}", file=sys.stderr)  # noqa: T201
            return 2
    for name, value in head["figures"].items():
        beside = f"  {growth[name]:+.2%}" if name in growth else ""
        print(f"{name:16} {value:12,.0f} {head['unit']}{beside}")  # noqa: T201
    if arguments.save is not None:
        arguments.save.write_text(json.dumps(head, indent=1) + "\n", encoding="utf-8")
    return int(any(value > LARGER[head["unit"]] for value in growth.values()))


if __name__ == "__main__":
    sys.exit(main())
