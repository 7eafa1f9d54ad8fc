"""Monitor a stack during a trial: its height, its collapse, its sink and its creep."""

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
"""Time after the release of its last brick at which a level counts as reached [s], multiplied by the pace of the scene.
This time is slightly less than the second until the next brick. A level that falls when its last brick lands therefore
does not count as reached."""
AFTERMATH_S = 1.0
"""Time for which a trial of standard planks continues after the first frame of a collapse [s], so that the monitor can
distinguish a topple from a slide. For thicker bricks the time increases with the square root of their thickness,
because their falls take longer in this proportion."""


@dataclass(frozen=True, slots=True)
class Standing:
    """Measurements of an intact stack or of a pile.

    For a stack, the measurements are of the last frame before its collapse or before the start of the next level.
    """

    level: int
    """Highest level that stands intact with all levels below it."""
    height_m: float
    """Height of the top of that level [m]."""
    sink_m: float
    """Mean depth of the bricks of that level below their planned height [m]."""
    drift_m: float
    """Greatest horizontal distance of a brick from its release position [m]."""


@dataclass(slots=True)
class Collapse:
    """Collapse of a stack."""

    time: float
    """Simulated time at the end of the first frame of the collapse [s]."""
    level: int
    """Number of complete levels placed in the first frame of the collapse."""
    kind: CollapseKind
    """Kind of the collapse, which may change while the monitor watches the collapse."""
    aftermath_s: float
    """Time for which the monitor watches the collapse [s]."""


class StackMonitor:
    """Monitor that receives the poses of a stack after every frame. All times are simulated times."""

    def __init__(self, creep_from_s: float, pace: float = 1.0) -> None:
        """Prepare to monitor a stack.

        Args:
            creep_from_s: start of the measurement of creep [s], which ends with the watch.
            pace: factor of the scene on times, which applies to ``LANDING_S``.
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
        """True if the monitor has watched a collapse for its ``aftermath_s``."""
        return self.collapse is not None and self._latest_s - self.collapse.time >= self.collapse.aftermath_s

    @property
    def creep(self) -> Creep | None:
        """Creep of the bricks; None if the stack fell, the watch was too short, or there are no bricks."""
        return None if self.collapse else self._creep.measure(self._thickness)

    def see(
        self, time: float, plan: Plan, position: FloatArray, quaternion: FloatArray, placed: Mapping[int, float]
    ) -> None:
        """Record one frame.

        The measurement of a level ends when the next level starts, because later the stack may already be falling.

        Args:
            time: simulated time at the end of the frame [s].
            plan: plan of the n bricks in the world.
            position: centres of the bricks [m], shape (n, 3), world frame; the array must not change later.
            quaternion: orientations of the bricks (w, x, y, z), shape (n, 4), world frame; the array must not change
                later.
            placed: release time of the last brick of each complete level [s], by level.
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
        """Judge the poses; if plan and poses have not changed, keep the last judgement and the measured level.

        The work for a stack at rest is therefore small, so that the memory of the engine stays in the caches. The
        harness times the engine next.
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
