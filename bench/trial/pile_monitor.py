"""Monitor a poured pile: time to rest, height, angle of repose, sink and creep.

``PileMonitor`` replaces ``StackMonitor`` for bricks without planned poses, because a pile cannot collapse.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from bench.trial import measure
from bench.trial.creep import Creep, CreepMeter
from bench.trial.measure import FloatArray, Plan
from bench.trial.stack_monitor import Standing

MOVING_M_S = 10e-3
"""Speed of a brick's centre above which the brick is not at rest [m/s], because creep is slower and tumbling is
faster."""
HALF_BELOW = 1 - 0.5 ** (1 / 3)
"""Share of an upright cone's height, from its base, below which half of the cone's volume lies."""


def slope_deg(position: FloatArray) -> float | None:
    """Return the angle of repose of a pile of equal bricks [deg]; None if the median radius is zero.

    The angle is the slope of the cone with the same median height and median radius as the pile. The function uses
    medians, because single bricks that rolled away hardly change a median. Half of a cone's volume lies within half the
    radius of its base, and half lies below ``HALF_BELOW`` of its height.

    Args:
        position: centres of the bricks [m], shape (n, 3), world frame.
    """
    middle = np.median(position, axis=0)
    radius = 2.0 * float(np.median(np.hypot(*(position[:, :2] - middle[:2]).T)))
    return math.degrees(math.atan2(middle[2] / HALF_BELOW, radius)) if radius > 0.0 else None


class PileMonitor:
    """Monitor that receives the poses of a pile after every frame. All times are simulated times."""

    collapse = None
    """Collapse of the pile: always None, because no brick has a planned place."""
    is_over = False
    """True to end the trial before the end of the watch; always False for a pile."""

    def __init__(self, last_action_s: float, watch_from_s: float, creep_from_s: float) -> None:
        """Prepare to measure a pile.

        Args:
            last_action_s: time of the last poured brick [s].
            watch_from_s: start of the measurement of sink [s], after the last brick has had time to land.
            creep_from_s: start of the measurement of creep [s], which ends with the watch.
        """
        self._last_action_s = last_action_s
        self._watch_from_s = watch_from_s
        self._creep = CreepMeter(creep_from_s)
        self._first: tuple[float, FloatArray] | None = None
        self._latest: tuple[float, FloatArray] | None = None
        self._plan = Plan.of(())
        self._quaternion: FloatArray = np.empty((0, 4))
        self._poured = 0
        self._moved_s = 0.0

    @property
    def standing(self) -> Standing | None:
        """Measurements of the pile in the latest frame; None without poured bricks.

        The level is the number of poured bricks. The sink is the decrease of their mean height during the watch.
        """
        if self._latest is None or not len(self._latest[1]):
            return None
        position = self._latest[1]
        begin = position if self._first is None else self._first[1]
        boxes = self._plan.boxes_at(position, self._quaternion)
        return Standing(
            level=self._poured,
            height_m=float((position + boxes.reach)[:, 2].max()),
            sink_m=float((begin - position)[:, 2].mean()),
            drift_m=float(measure.sideways(self._plan, position).max()),
        )

    @property
    def repose_deg(self) -> float | None:
        """Angle of repose in the latest frame [deg]; None without poured bricks, or if ``slope_deg`` returns None."""
        return slope_deg(self._latest[1]) if self._latest is not None and len(self._latest[1]) else None

    @property
    def creep(self) -> Creep | None:
        """Creep of the bricks; None if the watch was too short, or there are no bricks."""
        return self._creep.measure(self._plan.thickness)

    @property
    def rest_s(self) -> float | None:
        """Time from the last action to the end of the last frame in which a brick moved [s], at least 0.

        The time is None before the first frame, and if a brick moved in the latest frame.
        """
        if self._latest is None or self._moved_s >= self._latest[0]:
            return None
        return max(0.0, self._moved_s - self._last_action_s)

    def see(
        self, time: float, plan: Plan, position: FloatArray, quaternion: FloatArray, placed: Mapping[int, float]
    ) -> None:
        """Record one frame, with the arguments of ``StackMonitor.see``; every brick counts as a level."""
        if self._latest is not None and len(self._latest[1]) == len(position):
            before, was = self._latest
            if measure.fastest(was, position, time - before) > MOVING_M_S:
                self._moved_s = time
        else:
            self._moved_s = time
        self._latest = time, position
        self._plan, self._quaternion, self._poured = plan, quaternion, len(placed)
        if self._first is None and time >= self._watch_from_s:
            self._first = time, position
        self._creep.see(time, position)
