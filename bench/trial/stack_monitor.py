"""Monitor a stack through a trial: how high it stood, when and how it collapsed, how far it sank and crept."""

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
"""A level counts once its last brick was let go so long ago [s]: just before the next brick comes, a second
after it, so that a level that falls when its last brick lands never counts as reached. Times the scene's pace."""
AFTERMATH_S = 1.0
"""How long [s] a trial of standard planks goes on after a collapse is first seen: time enough to tell a topple from a
slide. Larger bricks fall as slowly as the root of their size."""


@dataclass(frozen=True, slots=True)
class Standing:
    """A stack as it was last seen intact, before the next level was begun."""

    level: int
    height_m: float
    sink_m: float
    drift_m: float


@dataclass(slots=True)
class Collapse:
    """A collapse as it was first seen, and how it went on."""

    time: float
    """When it was first seen [s]."""
    level: int
    """Levels placed at that time."""
    kind: CollapseKind
    aftermath_s: float
    """How long it must be watched [s]."""


class StackMonitor:
    """Takes in the poses after every frame. Everything here is simulated time."""

    def __init__(self, creep_from_s: float, pace: float = 1.0) -> None:
        """Creep is measured from ``creep_from_s`` [s] on: the last half of the watch.

        ``pace`` is that of the scene: levels land so much more slowly.
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
        """How fast its bricks creep; None if the stack fell, or if it was not watched so long."""
        return None if self.collapse else self._creep.measure(self._thickness)

    def see(
        self, time: float, plan: Plan, position: FloatArray, quaternion: FloatArray, placed: Mapping[int, float]
    ) -> None:
        """Take in one frame.

        A level is measured until the next one is begun: later it may already be on its way down.

        Args:
            time: simulated time at the end of the frame [s].
            plan: of the bricks now in the world.
            position: their centres [m], shape (n, 3).
            quaternion: their orientations, shape (n, 4).
            placed: the levels that are complete, and when [s] the last brick of each was let go.
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
        """Find what is out of place. While nothing moves all stays as it was judged, and the measured level too.

        A stack at rest is watched in next to no time: the engine, timed next, finds its memory still at hand.
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
