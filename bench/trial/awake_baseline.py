"""Time the same standing stack without the extension: the baseline, all awake.

Comparing two runs would compare two stacks, because the stack without the extension has often fallen by then. So the
stack that the extension built is loaded, at its actual poses, into a fresh world in which every brick is awake.
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
"""Warm-up frames: the first builds the engine's caches, the second starts from the contacts of the first."""
TIMED_FRAMES = 60
"""Frames to be timed: a second of the stack."""
LEAST_FRAMES = 10
"""Fewest frames that count as a measurement."""
MOST_WORLDS = 20
"""Most worlds to open: a tall stack falls within some frames of waking, so it is loaded again to time more frames."""
MOST_WALL_S = 20.0
"""Wall time [s] after which no further frame starts, so that a slow engine does not spend its trial's limit here."""
HIGHEST_LEVEL = 25
"""The paper's height: the ratio of a taller stack is taken at this level."""


@dataclass(frozen=True, slots=True)
class BaselineTime:
    """Frame time of an all-awake stack, or why there is none."""

    frame_ms: float | None
    message: str = ""


def time_baseline(engine: str, profile: str, world: World, stack: Snapshot) -> BaselineTime:
    """Return mean frame time [ms] of the stack while it stands in fresh worlds of the engine alone."""
    times_ms: list[float] = []
    deadline = perf_counter() + MOST_WALL_S
    for _ in range(MOST_WORLDS):
        times_ms += _time_while_it_stands(engine, profile, world, stack, TIMED_FRAMES - len(times_ms), deadline)
        if len(times_ms) == TIMED_FRAMES or perf_counter() > deadline:
            break
    if len(times_ms) < LEAST_FRAMES:
        why = "is too slow" if perf_counter() > deadline else "fell at once in each fresh world"
        return BaselineTime(None, f"the awake stack {why}: too few frames to time")
    return BaselineTime(statistics.fmean(times_ms))


def open_awake(engine: str, profile: str, world: World, stack: Snapshot) -> Simulation:
    """Open a world of the engine alone that holds the stack at its actual poses, every brick awake."""
    unit = stack.quaternion / np.linalg.norm(stack.quaternion, axis=1, keepdims=True)
    bricks = [at_pose(*row) for row in zip(stack.bricks, stack.position, unit, strict=True)]
    simulation = open_engine(engine, profile, world=world, expected=bricks)
    for brick in bricks:
        simulation.spawn(brick)
    return simulation


def _time_while_it_stands(
    engine: str, profile: str, world: World, stack: Snapshot, wanted: int, deadline: float
) -> list[float]:
    """Return the times [ms] of up to ``wanted`` frames after the warm-up, as long as every brick is in place."""
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
