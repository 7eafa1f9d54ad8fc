"""The angle of repose that the user sets, and the angle of the poured pile; the cost of the pile at rest.

    uv run python -m tests.stability_core.pile_repose [--engine E] [--bricks N] [--draws D ...] [--reposes DEG ...]

prints a table; nothing is published. Piles of ``poured_pile`` with mu = 0.3 (atan(mu) = 16.7 deg), profile ``game``,
policy ``pile`` with ``Settings.repose``, and the engine alone as ``none``. The angle is ``slope_deg`` of the pile five
seconds after the last brick. The cost is the thread's processor time of a frame (engine, port and core), as the median
over the last three seconds.
"""

from __future__ import annotations

import argparse
import math
import time
from typing import NamedTuple

import numpy as np

from adapters import open_engine
from bench.trial.builder import Builder
from bench.trial.pile_monitor import slope_deg
from bench.trial.stepping import PlainFrames
from scenarios.scenes.poured_pile import poured_pile
from stability_core import Settings, StabilityExtension

MU = 0.3
WATCH_S, COST_S = 5.0, 3.0
"""Time after the last brick [s], and the part of it at its end in which frames are timed."""


class Poured(NamedTuple):
    """A pile five seconds after its last brick."""

    repose_deg: float
    frozen: int
    """Bricks that the policy had frozen; 0 for the engine alone."""
    frame_ms: float


def pour(engine: str, bricks: int, draw: int, repose: float | None) -> Poured:
    """Pour one pile with the policy ``pile`` and a repose angle [deg], or with the engine alone (None)."""
    scene = poured_pile(bricks=bricks, draw=draw, friction=MU)
    simulation = open_engine(engine, "game", world=scene.world, expected=scene.bricks)
    frozen: set[int] = set()
    try:
        builder = Builder(scene, simulation, PlainFrames(simulation))
        extension = None
        if repose is not None:
            extension = StabilityExtension(simulation.port, "pile", settings=Settings(repose=math.radians(repose)))
        frame_s, costs, now = simulation.info.frame_s, [], 0.0
        while now < scene.done_s + WATCH_S:
            builder.act(now)
            began = time.thread_time()
            simulation.step(frame_s)
            if extension is not None:
                change = extension.update(frame_s)
                frozen = (frozen | set(change.frozen)) - set(change.woken)
            costs.append(time.thread_time() - began)
            now += frame_s
        angle = slope_deg(simulation.poses()[1])
    finally:
        simulation.close()
    return Poured(angle or math.nan, len(frozen), 1e3 * float(np.median(costs[-round(COST_S / frame_s) :])))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--engine", default="bullet")
    parser.add_argument("--bricks", type=int, default=60)
    parser.add_argument("--draws", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--reposes", type=float, nargs="+", default=[16.7, 20.0, 30.0, 40.0, 50.0])
    arguments = parser.parse_args()
    print("| repose set | angle of the pile | frozen | frame ms |\n|---|---|---|---|")  # noqa: T201 - a command
    for repose in (None, *arguments.reposes):
        piles = [pour(arguments.engine, arguments.bricks, draw, repose) for draw in arguments.draws]
        angle, frozen, frame_ms = (float(np.mean([pile[at] for pile in piles])) for at in range(3))
        name = "none" if repose is None else f"{repose:g} deg"
        print(f"| {name} | {angle:.1f} deg | {frozen:.0f} of {arguments.bricks} | {frame_ms:.2f} |", flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
