"""Audit sleeping: measure the time for which a brick keeps its pose although theory demands a motion of the brick."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.trial.measure import EARLY_S, FloatArray
from scenarios.model import MustMove


@dataclass(slots=True)
class _Watched:
    """State of a brick that must move."""

    due: MustMove
    """Brick, start and distance of the required motion."""
    start: FloatArray | None = None
    """Centre of the brick when its motion had to start [m], shape (3,), world frame; None before that time."""
    moved_after_s: float | None = None
    """Time from the required start until the brick had covered the required distance [s]; None until then."""


class SleepAudit:
    """Audit that receives the poses of the bricks after every frame."""

    def __init__(self, must_move: Sequence[MustMove]) -> None:
        """Start to audit the bricks that must move."""
        self._watched = [_Watched(due) for due in must_move]
        self._before: dict[int, FloatArray] = {}
        self.asleep_s = 0.0
        """Total simulated time of the frames in which at least one brick kept its pose to the last bit [s] during its
        required motion."""

    @property
    def moved_after_s(self) -> float | None:
        """Longest time that a brick took to cover its required distance [s]; None if a brick covered less."""
        times = [one.moved_after_s for one in self._watched]
        return None if None in times else max(time for time in times if time is not None)

    def see(self, begin: float, end: float, poses: Mapping[int, FloatArray]) -> None:
        """Record one frame.

        Args:
            begin: start of the frame [s].
            end: end of the frame [s].
            poses: position [m] and quaternion (w, x, y, z) of each brick in the world, shape (7,), by index in the
                order of placement.
        """
        sleeps = False
        for one in self._watched:
            if one.moved_after_s is not None or one.due.brick not in poses or begin < one.due.from_s - EARLY_S:
                continue
            pose, before = poses[one.due.brick], self._before.get(one.due.brick)
            if one.start is None:
                one.start = (pose if before is None else before)[:3]
            sleeps |= before is not None and np.array_equal(pose, before)
            if math.dist(pose[:3], one.start) >= one.due.way_m:
                one.moved_after_s = end - one.due.from_s
        self.asleep_s += (end - begin) * sleeps
        self._before = dict(poses)

    def fields(self) -> dict[str, Any]:
        """Return the fields for the record."""
        return {"asleep_s": self.asleep_s, "moved_after_s": self.moved_after_s}
