"""Driven bodies, which the host moves: their velocities in each frame, and the planned poses of carried bricks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from adapters.base import Simulation
from adapters.shared.driven_pose import advanced
from adapters.shared.vectors import rotate
from bench.trial.measure import FloatArray
from scenarios.model import Brick, Drive


@dataclass(slots=True)
class _Driving:
    """A driven body with its initial and present velocity."""

    action: Drive
    """Action with the target velocity."""
    start: FloatArray
    """Velocity [m/s] and angular velocity [rad/s] at the start of the action, shape (6,), world frame."""
    now: FloatArray
    """Velocity [m/s] and angular velocity [rad/s] in the present frame, shape (6,), world frame."""


class Drives:
    """The driven bodies of one simulation."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._driven: dict[int, _Driving] = {}

    def is_changing(self, time: float) -> bool:
        """Return whether any driven body has not yet reached its target velocity at ``time`` [s]."""
        return any(time < driving.action.until for driving in self._driven.values())

    def begin(self, body: int, action: Drive) -> None:
        """Start to accelerate a body to the target velocity of ``action``."""
        before = self._driven.get(body)
        start = np.zeros(6) if before is None else before.now
        self._driven[body] = _Driving(action, start, start)

    def forget(self, body: int) -> None:
        """Remove a body that has left the world."""
        self._driven.pop(body, None)

    def go_on(self, time: float, planned: Mapping[int, Brick]) -> dict[int, Brick]:
        """Set the velocities of the driven bodies for one frame; return the bricks with a new planned pose, by body.

        Use the velocity at the middle of the frame, so that a uniform acceleration covers the exact distance.

        Args:
            time: start of the frame [s].
            planned: bricks in the world at their planned poses, by body.
        """
        frame_s = self._simulation.info.frame_s
        changed: dict[int, Brick] = {}
        for body, driving in self._driven.items():
            action = driving.action
            part = (time + frame_s / 2 - action.time) / action.seconds if action.seconds else 1.0
            target = np.array((*action.velocity, *action.spin))
            driving.now = driving.start + min(max(part, 0.0), 1.0) * (target - driving.start)
            linear, angular = driving.now[:3], driving.now[3:]
            (u, v, w), (i, j, k) = linear.tolist(), angular.tolist()
            self._simulation.drive(body, (u, v, w), (i, j, k))
            if driving.now.any():
                carried = [other for other, brick in planned.items() if brick.level > planned[body].level]
                changed |= _moved([body, *(carried if action.carries else [])], planned, linear, angular, frame_s)
        return changed


def _moved(
    bodies: list[int], planned: Mapping[int, Brick], linear: FloatArray, angular: FloatArray, seconds: float
) -> dict[int, Brick]:
    """Return a driven platform and the bricks that it carries at their new planned poses, by body.

    Args:
        bodies: bodies of the platform and of the bricks that it carries; the platform comes first.
        planned: bricks at their present planned poses, by body.
        linear: velocity of the platform [m/s], shape (3,), world frame.
        angular: angular velocity of the platform [rad/s], shape (3,), world frame.
        seconds: duration of the motion [s].
    """
    center = np.array(planned[bodies[0]].position)
    turn = advanced(center, np.array((1.0, 0.0, 0.0, 0.0)), linear, angular, seconds)[1]
    moved = {}
    for body in bodies:
        brick = planned[body]
        _, quaternion = advanced(center, np.array(brick.quaternion), linear, angular, seconds)
        arm = rotate(turn[None], (np.array(brick.position) - center)[None])[0]
        x, y, z = (center + linear * seconds + arm).tolist()
        w, i, j, k = quaternion.tolist()
        moved[body] = Brick(brick.size, brick.mass, (x, y, z), (w, i, j, k), brick.level, brick.moved)
    return moved
