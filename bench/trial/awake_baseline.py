"""Time a standing stack without the extension: the baseline (all awake).

A separate trial without the extension cannot be the baseline, because its stack has often fallen. Therefore this module
takes the stack built with the extension, and places it at its actual poses in a new world. In this world the engine
runs alone, and every brick is awake.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from adapters import open_engine
from adapters.base import Simulation
from bench.trial.builder import at_pose
from bench.trial.measure import Plan, intact
from bench.trial.playback import Snapshot
from bench.trial.stepping import PlainFrames
from scenarios.model import World

WARM_UP_FRAMES = 2
"""Number of untimed frames at the start of each new world. Two frames are necessary, because the engine builds its
caches in the first frame, and the second frame is the first that starts from earlier contacts."""
TIMED_FRAMES = 60
"""Greatest number of timed frames, one second at 60 Hz."""
LEAST_FRAMES = 10
"""Fewest timed frames that give a frame time."""
MOST_WORLDS = 20
"""Greatest number of worlds to open for one baseline. Several worlds are necessary, because a tall stack falls within a
few frames."""
MOST_WALL_S = 20.0
"""Wall time after which no further frame starts [s], so that a slow engine does not use up the limit of its trial."""
HIGHEST_LEVEL = 25
"""Greatest level at which the harness measures the ratio of the frame time with the extension to the baseline: the
height of the paper's stacks."""


@dataclass(frozen=True, slots=True)
class BaselineTime:
    """Frame time of a stack with every brick awake, or the reason why the frame time is missing."""

    frame_ms: float | None
    """Mean frame time [ms]; None with fewer than ``LEAST_FRAMES`` timed frames."""
    message: str = ""
    """Reason for a missing frame time."""
    one_live_ms: float | None = None
    """Mean time [ms] of the engine's step with the last brick live and all other bricks frozen; None without a frame
    time."""


def time_baseline(engine: str, profile: str, world: World, stack: Snapshot) -> BaselineTime:
    """Return the mean frame time of a stack while it stands in new worlds of the engine alone, or why there is none.

    Args:
        engine: name of the engine.
        profile: name of the profile.
        world: the world of the scene.
        stack: the stack at its actual poses.
    """
    times_ms: list[float] = []
    deadline = perf_counter() + MOST_WALL_S
    for _ in range(MOST_WORLDS):
        times_ms += _time_while_it_stands(engine, profile, world, stack, TIMED_FRAMES - len(times_ms), deadline)
        if len(times_ms) == TIMED_FRAMES or perf_counter() > deadline:
            break
    if len(times_ms) < LEAST_FRAMES:
        why = "is too slow" if perf_counter() > deadline else "fell at once in each new world"
        return BaselineTime(None, f"the awake stack {why}: fewer than {LEAST_FRAMES} frames have a time")
    return BaselineTime(statistics.fmean(times_ms), one_live_ms=_time_one_live(engine, profile, world, stack))


def open_awake(engine: str, profile: str, world: World, stack: Snapshot) -> Simulation:
    """Open a world without the extension; place the stack there at its actual poses, with every brick awake."""
    unit = stack.quaternion / np.linalg.norm(stack.quaternion, axis=1, keepdims=True)
    bricks = [at_pose(*row) for row in zip(stack.bricks, stack.position, unit, strict=True)]
    simulation = open_engine(engine, profile, world=world, expected=bricks)
    for brick in bricks:
        simulation.spawn(brick)
    return simulation


def _time_while_it_stands(
    engine: str, profile: str, world: World, stack: Snapshot, wanted: int, deadline: float
) -> list[float]:
    """Return the frame times [ms] of up to ``wanted`` frames of a new world.

    The list omits the first ``WARM_UP_FRAMES`` frames. The list ends when a brick is out of place, or when the clock
    passes ``deadline`` [s].
    """
    plan = Plan.of(stack.bricks)
    simulation = open_awake(engine, profile, world, stack)
    try:
        frames = PlainFrames(simulation)
        times_ms = []
        for _ in range(WARM_UP_FRAMES + wanted):
            times, _ = frames.play()
            _, position, quaternion = simulation.poses()
            if not intact(plan, position, quaternion) or perf_counter() > deadline:
                break
            times_ms.append(times.total * 1e3)
        return times_ms[WARM_UP_FRAMES:]
    finally:
        simulation.close()


def _time_one_live(engine: str, profile: str, world: World, stack: Snapshot) -> float:
    """Return the mean time [ms] of the engine's step with the last brick live and all other bricks frozen.

    The engine records its contacts, as an extension needs them.
    """
    simulation = open_awake(engine, profile, world, stack)
    try:
        *frozen, _ = simulation.bricks
        simulation.port.sleep(frozen)
        frames = PlainFrames(simulation)
        times = [frames.play()[0].engine for _ in range(WARM_UP_FRAMES + TIMED_FRAMES)]
        return statistics.fmean(times[WARM_UP_FRAMES:]) * 1e3
    finally:
        simulation.close()
