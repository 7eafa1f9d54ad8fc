"""The toy plank of the scenes, flat or leaning, and boxes of the same wood.

A KAPLA plank is nominally 117.0 x 23.4 x 7.8 mm (15 : 3 : 1) and weighs 11.9 g on average (557 kg/m3, pine). A plank's
own x axis runs along its length, y along its width and z along its thickness.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Literal

from scenarios.model import Brick, Place, Quaternion, Vector

LENGTH = 117.0e-3
"""Nominal length [m]."""
WIDTH = 23.4e-3
"""Nominal width [m]."""
THICKNESS = 7.8e-3
"""Nominal thickness [m]."""
MASS = 11.9e-3
"""Mean mass [kg]."""
MU = 0.45
"""Coulomb coefficient of every pair. The value is the upper end of the reported values for pine on pine, 0.12 to
0.45, because only near the upper end does a card house stand with any normal that an engine reports at its ridge (see
``card_house``)."""
GRAVITY = 9.81
"""Magnitude [m/s2] of the default gravity of ``World``."""
DENSITY = MASS / (LENGTH * WIDTH * THICKNESS)
"""Mean density [kg/m3]."""
GAP = 2.0e-3
"""Gap [m] between neighbours of a level, because placement noise would push planks 0.5 mm apart into each other."""


def lay(
    x: float,
    y: float = 0.0,
    *,
    level: int,
    yaw: float = 0.0,
    bottom: float | None = None,
    length: float = LENGTH,
    thickness: float = THICKNESS,
) -> Brick:
    """Return a plank that lies flat, turned about z by ``yaw`` [rad].

    Args:
        x: centre along x [m].
        y: centre along y [m].
        level: level of the brick, from 1.
        yaw: angle [rad] from the x axis to the plank's length.
        bottom: height of the lower face [m]; by default the height in a stack of flat planks.
        length: length [m]; the mass is in proportion.
        thickness: thickness [m]; the mass is in proportion.
    """
    under = (level - 1) * thickness if bottom is None else bottom
    turn: Quaternion = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    mass = MASS * length / LENGTH * (thickness / THICKNESS)
    return Brick((length, WIDTH, thickness), mass, (x, y, under + thickness / 2), turn, level)


def lean(
    foot: float,
    *,
    theta: float,
    toward: Literal[1, -1],
    level: int,
    bottom: float = 0.0,
    thickness: float = THICKNESS,
) -> Brick:
    """Return a plank that stands on its lower short edge and leans in the x-z plane.

    Args:
        foot: position along x [m] of the lower short edge.
        theta: angle [rad] between the plank and the ground.
        toward: 1 if the plank leans toward +x, -1 if it leans toward -x.
        level: level of the brick, from 1.
        bottom: height [m] of the lower short edge.
        thickness: thickness [m]; the mass is in proportion.
    """
    along, across = (math.cos(theta), math.sin(theta)), (-math.sin(theta), math.cos(theta))
    x = foot + toward * (LENGTH * along[0] + thickness * across[0]) / 2
    z = bottom + (LENGTH * along[1] + thickness * across[1]) / 2
    tilt: Quaternion = (math.cos(theta / 2), 0.0, -toward * math.sin(theta / 2), 0.0)
    return Brick((LENGTH, WIDTH, thickness), MASS * (thickness / THICKNESS), (x, 0.0, z), tilt, level)


def plank_of(scale: float) -> tuple[float, float, float, float]:
    """Return length, width and thickness [m] and mass [kg] of a plank ``scale`` times as large, of the same wood.

    A scene whose stack must not tip needs large planks. The energy [J] of a landing brick grows with the brick's mass
    only, because the harness releases each brick ``CLEARANCE`` above its support. The energy that tips the stack grows
    with the mass and with the size.
    """
    return scale * LENGTH, scale * WIDTH, scale * THICKNESS, scale**3 * MASS


def box(
    size: Vector,
    x: float,
    y: float = 0.0,
    *,
    level: int,
    bottom: float = 0.0,
    yaw: float = 0.0,
    mass: float | None = None,
) -> Brick:
    """Return a box that stands upright.

    Args:
        size: edge lengths [m] along the box's own x, y and z.
        x: centre along x [m].
        y: centre along y [m].
        level: level of the brick, from 1.
        bottom: height [m] of the lower face.
        yaw: turn about z [rad].
        mass: mass [kg]; by default the mass of a box of the planks' wood.
    """
    turn: Quaternion = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    return Brick(size, math.prod(size) * DENSITY if mass is None else mass, (x, y, bottom + size[2] / 2), turn, level)


def one_a_second(groups: Iterable[Sequence[Brick]]) -> tuple[Place, ...]:
    """Return actions that place one group of bricks each second from time 0, like the paper's scenes."""
    return tuple(Place(float(second), tuple(group)) for second, group in enumerate(groups))
