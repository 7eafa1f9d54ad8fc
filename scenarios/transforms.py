"""Changes of a whole scene that no statics may depend on: its size, its mass and its direction."""

from __future__ import annotations

import math
from dataclasses import replace

from scenarios.hand import turned
from scenarios.model import Brick


def transformed(brick: Brick, size: float, mass: float, yaw: float) -> Brick:
    """Return a brick with lengths times ``size`` and mass times ``mass``, turned about the z axis by ``yaw`` [deg]."""
    length, width, height = brick.size
    x, y, z = brick.position
    turn = math.radians(yaw)
    cos, sin = math.cos(turn), math.sin(turn)
    return replace(
        brick,
        size=(length * size, width * size, height * size),
        mass=brick.mass * mass,
        position=((cos * x - sin * y) * size, (sin * x + cos * y) * size, z * size),
        quaternion=turned(brick.quaternion, turn),
    )
