"""Monitor a stack during a trial: its height, when and how it collapsed, its sink and creep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.trial import measure
from bench.trial.creep import Creep, CreepMeter
from bench.trial.measure import BoolArray, FloatArray, Plan
from reports.records.trial import CollapseKind
from scenarios.planks import THICKNESS

LANDING_S = 0.9
"""Time [s] after the release of its last brick at which a level counts: just before the next brick, a second later, so
that a level that falls when its last brick lands never counts as reached. Times the scene's pace."""
AFTERMATH_S = 1.0
"""Time [s] for which a trial of standard planks continues after a collapse is first seen: enough to distinguish a
topple from a slide. Larger bricks fall more slowly, by the square root of their size."""


@dataclass(frozen=True, slots=True)
class Standing:
    """A stack as last seen intact, before the next level started."""

    level: int
    height_m: float
    sink_m: float
    drift_m: float


@dataclass(slots=True)
class Collapse:
    """A collapse as first seen, and its course."""

    time: float
    """Time at which it was first seen [s]."""
    level: int
    """Levels placed at that time."""
    kind: CollapseKind
    aftermath_s: float
    """Time for which it must be watched [s]."""


class StackMonitor:
    """Takes the poses after every frame. All times are simulated."""

    def __init__(self, creep_from_s: float, pace: float = 1.0) -> None:
        """Start to measure creep at ``creep_from_s`` [s]: the last half of the watch.

        ``pace`` is the scene's factor on times, which applies to landing.
        """
        self._landing_s = LANDING_S * pace
        self._creep = CreepMeter(creep_from_s)
        self._latest_s = 0.0
        self._thickness: FloatArray = np.empty(0)
        self._judged: tuple[Plan, FloatArray, FloatArray] | None = None
        self._kind: CollapseKind | None = None
        self._out_of_place: BoolArray = np.empty(0, np.bool_)
        self._measured = 0
        self.standing: Standing | None = None
        self.collapse: Collapse | None = None

    @property
    def is_over(self) -> bool:
        """True when the aftermath of a collapse has been watched."""
        return self.collapse is not None and self._latest_s - self.collapse.time >= self.collapse.aftermath_s

    @property
    def creep(self) -> Creep | None:
        """Creep of its bricks; None if the stack fell, or was not watched long enough."""
        return None if self.collapse else self._creep.measure(self._thickness)

    def see(
        self, time: float, plan: Plan, position: FloatArray, quaternion: FloatArray, placed: Mapping[int, float]
    ) -> None:
        """Take one frame.

        A level is measured until the next one starts, because later it may already be falling.

        Args:
            time: simulated time at the end of the frame [s].
            plan: plan of the bricks in the world.
            position: their centres [m], shape (n, 3).
            quaternion: their orientations, shape (n, 4).
            placed: the complete levels, each with the time [s] at which its last brick was released.
        """
        self._latest_s, self._thickness = time, plan.thickness
        self._creep.see(time, position - plan.position)
        self._judge(plan, position, quaternion)
        if self._kind is None and self.collapse is None:
            landed = [level for level, released in placed.items() if time - released >= self._landing_s]
            level = measure.levels_standing(plan, self._out_of_place, landed)
            is_highest = self.standing is None or level > self.standing.level or level == plan.level.max()
            if level and is_highest and level != self._measured:
                self._measured = level
                self.standing = Standing(
                    level,
                    measure.top(plan, position, quaternion, level),
                    measure.sink(plan, position, level),
                    float(measure.sideways(plan, position).max()),
                )
        elif self._kind is not None:
            self._see_collapse(time, self._kind, len(placed), float(plan.thickness.min()))

    def _judge(self, plan: Plan, position: FloatArray, quaternion: FloatArray) -> None:
        """Judge the poses. While nothing moves, the last judgement and the measured level stay valid.

        A stack at rest costs almost nothing, so that the engine, which is timed next, finds its memory in the caches.
        """
        if self._judged is not None:
            judged_plan, judged_position, judged_quaternion = self._judged
            if (
                plan is judged_plan
                and np.array_equal(position, judged_position)
                and np.array_equal(quaternion, judged_quaternion)
            ):
                return
        self._judged = plan, position, quaternion
        faults = measure.faults(plan, position, quaternion)
        self._kind, self._out_of_place, self._measured = faults.kind, faults.any, 0

    def _see_collapse(self, time: float, kind: CollapseKind, level: int, thickness: float) -> None:
        if self.collapse is None:
            slower = math.sqrt(max(1.0, thickness / THICKNESS))
            self.collapse = Collapse(time, level, kind, AFTERMATH_S * slower)
        elif kind == "topple" or self.collapse.kind == "sink":
            self.collapse.kind = kind
