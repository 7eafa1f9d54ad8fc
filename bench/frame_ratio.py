"""What the same standing stack costs without the extension.

Comparing two runs would compare two stacks: the one without the extension has often fallen by then. So the stack that
the extension built is put, at its actual poses, into a fresh world in which every brick is awake.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass

import numpy as np

from adapters import open_engine
from bench.builder import at_pose
from bench.measure import Plan, intact
from bench.play import Snapshot
from bench.timed_frames import PlainFrames
from scenarios.model import World

WARM_UP_FRAMES = 10
"""The engine's caches and contact impulses build up in the first frames."""
TIMED_FRAMES = 60
LEAST_FRAMES = 10
"""Fewer frames than this are no measurement."""
HIGHEST_LEVEL = 25
"""The paper's height: all ratios of taller stacks are taken at it."""


@dataclass(frozen=True, slots=True)
class AwakeTime:
    """Frame time of an all-awake stack, or why there is none."""

    frame_ms: float | None
    message: str = ""


def time_awake(engine: str, profile: str, world: World, stack: Snapshot) -> AwakeTime:
    """Mean frame time [ms] of the stack while it stands in a fresh world of the engine alone."""
    unit = stack.quaternion / np.linalg.norm(stack.quaternion, axis=1, keepdims=True)
    bricks = [at_pose(*row) for row in zip(stack.bricks, stack.position, unit, strict=True)]
    plan = Plan.of(stack.bricks)
    simulation = open_engine(engine, profile, world=world, expected=bricks)
    try:
        for brick in bricks:
            simulation.spawn(brick)
        frames = PlainFrames(simulation)
        times_ms: list[float] = []
        for frame in range(WARM_UP_FRAMES + TIMED_FRAMES):
            times, _ = frames.play()
            _, position, quaternion = simulation.poses()
            if not intact(plan, position, quaternion):
                break
            if frame >= WARM_UP_FRAMES:
                times_ms.append(times.total * 1e3)
    finally:
        simulation.close()
    if len(times_ms) < LEAST_FRAMES:
        return AwakeTime(None, f"the awake stack stood for {frame} frames only: too few to be timed")
    return AwakeTime(statistics.fmean(times_ms))
