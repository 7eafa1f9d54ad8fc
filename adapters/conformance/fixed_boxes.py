"""Checks of a world's fixed boxes: the boxes support, hold and stop bricks, and contacts name them as the ground."""

from __future__ import annotations

import math

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import (
    GRAVITY,
    LENGTH,
    MASS,
    THICKNESS,
    WEIGHTLESS,
    WIDTH,
    Rig,
    advance,
    frames,
    pairs,
    plank,
    pose,
    require,
    require_between,
    require_friction_angle,
    touching,
    velocity,
)
from scenarios.model import CLEARANCE, Brick, Vector
from stability_core.port import GROUND, FloatArray

TABLE = 0.1
"""Height [m] of the fixed table."""
DEPTH = 2 * WIDTH
"""Depth along y [m] of the fixed boxes."""


def _fixed(size: Vector, position: Vector, lean: float = 0.0) -> Brick:
    """Return a box with edges ``size`` [m]. Its edge along x rises by ``lean`` [rad] from +x towards +z."""
    return Brick(size, 1.0, position, (math.cos(lean / 2), 0.0, -math.sin(lean / 2), 0.0))


def _table(length: float) -> Brick:
    return _fixed((length, DEPTH, TABLE), (0.0, 0.0, TABLE / 2))


def _normals_from_ground(simulation: Simulation, body: int) -> FloatArray:
    """Return the normals (n, 3) of all contacts of a body, from the ground to the body.

    Raises:
        ConformanceError: if the body has no contact, or has a contact with another body than the ground.
    """
    contacts = touching(simulation.port.contacts(), body)
    require(pairs(contacts) == {(GROUND, body)}, f"pairs are {pairs(contacts)}, must be {(GROUND, body)} only")
    normals: FloatArray = np.where((contacts.body_b == body)[:, None], contacts.normal, -contacts.normal)
    return normals


def rests_on_a_fixed_box(rig: Rig) -> None:
    """Check that a brick rests on a fixed box, at most 0.5 mm deep, and that the contact area ends at the box's edges.

    The brick is longer than the box on both sides. The contacts name the ground, and their normals point up.
    """
    length = 0.6 * LENGTH
    simulation = rig.open(fixed=(_table(length),))
    body = simulation.spawn(plank(z=TABLE + THICKNESS / 2 + CLEARANCE))
    advance(simulation, 1.0)
    sunk = TABLE + THICKNESS / 2 - pose(simulation, body)[2]
    require_between(-0.1e-3, sunk, 0.5e-3, "depth [m] to which a brick sank into a fixed box")
    points = []
    for _ in range(6):
        simulation.step(simulation.info.frame_s)
        upward = _normals_from_ground(simulation, body)[:, 2]
        require_between(
            0.99, upward.min(), 1.0 + 1e-6, "upward component of the normals from a fixed box to the brick on it"
        )
        points.append(touching(simulation.port.contacts(), body).point)
    x = np.concatenate(points)[:, 0]
    for name, reach in (("least", -x.min()), ("greatest", x.max())):
        require_between(0.45 * length, reach, 0.5 * length + 0.2e-3, f"{name} |x| [m] of the points on a fixed box")


def slides_on_a_fixed_slope_above_the_friction_angle(rig: Rig) -> None:
    """Check that a brick on a fixed slope slides above the friction angle and holds below this angle."""

    def slide(degrees: float) -> float:
        angle, thick, half = math.radians(degrees), 0.05, 1.0
        along = np.array((math.cos(angle), 0.0, math.sin(angle)))
        across = np.array((-math.sin(angle), 0.0, math.cos(angle)))
        middle = (half + 0.1) * along - thick / 2 * across + (0.0, 0.0, thick)
        x, _, z = (middle + (thick + THICKNESS) / 2 * across).tolist()
        slope = _fixed((2 * half, DEPTH, thick), (float(middle[0]), 0.0, float(middle[2])), angle)
        simulation = rig.open(fixed=(slope,))
        body = simulation.spawn(plank(x, z, angle))
        advance(simulation, 0.3)
        start = pose(simulation, body)[:3]
        advance(simulation, 0.5)
        return float(np.linalg.norm(pose(simulation, body)[:3] - start))

    require_friction_angle(slide)


def leans_on_a_fixed_wall(rig: Rig) -> None:
    """Check that a fixed wall holds a brick, and that the port reports contacts with the wall and with the ground.

    Gravity leans by 40 degrees, so that friction alone does not hold the brick. All contacts name the ground. Their
    normals point to the brick: away from the wall, or up.
    """
    lean, wall = math.radians(40), _fixed((0.05, DEPTH, 0.1), (LENGTH / 2 + 0.025, 0.0, 0.05))
    gravity = (GRAVITY * math.sin(lean), 0.0, -GRAVITY * math.cos(lean))
    simulation = rig.open(gravity=gravity, fixed=(wall,))
    body = simulation.spawn(plank())
    advance(simulation, 1.0)
    # With soft contacts, as shipped, the brick sinks into the wall by some tenths of a millimetre.
    require_between(-0.1e-3, pose(simulation, body)[0], 1e-3, "distance [m] that a brick moves against a fixed wall")
    expected = {(-1, 0, 0), (0, 0, 1)}
    normals = {tuple(row) for row in np.rint(_normals_from_ground(simulation, body)).astype(int).tolist()}
    require(normals == expected, f"normals from the ground at a fixed wall are {normals}, must be {expected}")


def stops_at_a_fixed_ceiling(rig: Rig) -> None:
    """Check that a fixed ceiling stops a brick that rises at 0.3 m/s.

    The normals of the contacts must point down, and the brick must return at 0.1 m/s at most.
    """
    bottom = 0.1
    ceiling = _fixed((2 * LENGTH, DEPTH, 0.05), (0.0, 0.0, bottom + 0.025))
    simulation = rig.open(gravity=WEIGHTLESS, fixed=(ceiling,))
    body = simulation.spawn(plank(z=bottom - 0.02 - THICKNESS / 2))
    simulation.push(body, (0.0, 0.0, 0.3 * MASS))
    down = 0
    for _ in range(frames(simulation, 0.5)):
        simulation.step(simulation.info.frame_s)
        contacts = touching(simulation.port.contacts(), body)
        if len(contacts):
            down += 1
            facing = _normals_from_ground(simulation, body)[:, 2].max()
            require_between(-1.0 - 1e-6, facing, -0.99, "upward component of the normals from a fixed ceiling")
    require(down > 0, "a brick that hit a fixed ceiling has no contact with it in any frame, must have one")
    top = pose(simulation, body)[2] + THICKNESS / 2
    # The brick may be as deep as its path in a step, and only the engine's recovery pushes it back.
    deepest = bottom + 0.3 * simulation.info.frame_s
    require_between(0.0, top, deepest, "height [m] of the top of a brick that hit a fixed ceiling")
    # Without gravity the soft contacts of a larger world return a fifth of the speed.
    back = -velocity(simulation, body)[2]
    require_between(-1e-3, back, 0.1, "speed [m/s] of a brick away from a fixed ceiling that it hit at 0.3 m/s")


def freezes_on_a_fixed_box(rig: Rig) -> None:
    """Check that a brick frozen on a fixed box does not move by a bit, and supports a brick.

    The frozen brick must have no contacts with the fixed box.
    """
    simulation = rig.open(fixed=(_table(2 * LENGTH),))
    lower = simulation.spawn(plank(z=TABLE + THICKNESS / 2 + CLEARANCE))
    advance(simulation, 0.5)
    simulation.port.sleep([lower])
    before = pose(simulation, lower)
    upper = simulation.spawn(plank(z=TABLE + 1.5 * THICKNESS + CLEARANCE))
    advance(simulation, 0.5)
    drift = np.abs(pose(simulation, lower) - before).max()
    require(drift == 0.0, f"a brick frozen on a fixed box moved by {drift:.3g}, must not move by a bit")
    found = pairs(simulation.port.contacts())
    require(found == {(lower, upper)}, f"a live brick on a frozen brick has pairs {found}, must be {(lower, upper)}")
