"""Checks of bodies that the host moves: their prescribed velocity, their friction, and their listing by the port."""

from __future__ import annotations

import math

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import (
    GRAVITY,
    LENGTH,
    THICKNESS,
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
from scenarios.model import Brick, Vector

TOP = 0.1
"""Height [m] of a platform's upper face."""
STILL: Vector = (0.0, 0.0, 0.0)


def _platform(simulation: Simulation) -> int:
    """Spawn a platform, three planks long, at height ``TOP``; return its id."""
    size = (3 * LENGTH, 3 * WIDTH, 0.02)
    return simulation.spawn(Brick(size, 1.0, (0.0, 0.0, TOP - 0.01), moved=True))


def goes_where_it_is_driven(rig: Rig) -> None:
    """Check that a platform with a brick on it follows its prescribed velocity and spin, and stops when both are 0."""
    simulation = rig.open()
    platform = _platform(simulation)
    simulation.spawn(plank(z=TOP + THICKNESS / 2))
    advance(simulation, 0.2)
    seconds = frames(simulation, 0.4) * simulation.info.frame_s
    simulation.drive(platform, (0.05, 0.0, 0.1), (0.0, 0.3, 0.0))
    advance(simulation, 0.4)
    simulation.drive(platform, STILL)
    advance(simulation, 0.2)
    half = 0.15 * seconds
    planned = np.array((0.05 * seconds, 0.0, TOP - 0.01 + 0.1 * seconds, math.cos(half), 0.0, math.sin(half), 0.0))
    # 10 um and 0.6 mrad: single precision over a hundred steps, and an engine's approximation for small rotations.
    require_between(
        0.0, np.abs(pose(simulation, platform) - planned).max(), 3e-4, "error [m, quaternion] of a platform's pose"
    )
    require_between(0.0, np.abs(velocity(simulation, platform)).max(), 1e-5, "speed [m/s, rad/s] of a stopped platform")


def carries_what_lies_on_it(rig: Rig) -> None:
    """Check that friction moves a brick sideways with a platform, and that the brick rises with the platform."""
    simulation = rig.open()
    platform = _platform(simulation)
    body = simulation.spawn(plank(z=TOP + THICKNESS / 2))
    advance(simulation, 0.5)
    start = pose(simulation, body)
    simulation.drive(platform, (0.1, 0.0, 0.05))
    advance(simulation, 0.5)
    seconds = frames(simulation, 0.5) * simulation.info.frame_s
    came = pose(simulation, body)[:3] - start[:3]
    slip = 0.1**2 / (2 * 0.45 * GRAVITY)
    # 1.5 mm: friction acts in whole steps, and a rise of 50 mm/s unloads the brick for one step.
    require_between(
        0.1 * seconds - slip - 1.5e-3, came[0], 0.1 * seconds + 1e-4, "distance [m] of a brick on a platform along x"
    )
    require_between(0.05 * seconds - 1e-3, came[2], 0.05 * seconds + 1.5e-3, "rise [m] of a brick on a rising platform")
    require_between(0.095, velocity(simulation, body)[0], 0.105, "speed [m/s] of a brick on a platform at 0.1 m/s")


def shows_what_it_moves_below_frozen_bricks(rig: Rig) -> None:
    """Check that a platform that turns below a frozen brick has contacts with the brick.

    The relative velocity of the contacts must be the velocity of the platform's surface. The platform must also rise
    into the frozen brick as planned, and the brick must move at 0.2 m/s at most after its unfreeze.
    """
    simulation = rig.open()
    platform = _platform(simulation)
    body = simulation.spawn(plank(z=TOP + THICKNESS / 2))
    advance(simulation, 0.5)
    simulation.port.sleep([body])
    simulation.drive(platform, STILL, (0.0, 0.1, 0.0))
    simulation.step(simulation.info.frame_s)
    contacts = simulation.port.contacts()
    require(
        pairs(contacts) == {(platform, body)},
        f"a platform that turns below a frozen brick has the pairs {pairs(contacts)}, must be {(platform, body)}",
    )
    speed = np.abs(contacts.relative_velocity[:, 2])
    require_between(
        0.95,
        speed.max() / (0.1 * LENGTH / 2),
        1.05,
        "speed of a turning platform below a brick's ends, over the planned speed",
    )
    start = pose(simulation, platform)[2]
    simulation.drive(platform, (0.0, 0.0, 5e-3))
    seconds = frames(simulation, 0.05) * simulation.info.frame_s
    advance(simulation, 0.05)
    rise = pose(simulation, platform)[2] - start
    require_between(0.9, rise / (5e-3 * seconds), 1.1, "rise of a platform below a frozen brick, over the planned rise")
    simulation.port.wake([body])
    simulation.drive(platform, STILL)
    simulation.step(simulation.info.frame_s)
    # 0.2 m/s: some engines resolve an overlap of 0.3 mm within one substep.
    require_between(
        0.0, np.abs(velocity(simulation, body)[:3]).max(), 0.2, "speed [m/s] of a brick unfrozen on a platform"
    )


def _slide(rig: Rig, degrees: float) -> float:
    """Return the distance [m] that a plank moves in 0.5 s on a tilted platform, from 0.3 s after the tilt."""
    simulation = rig.open()
    platform = _platform(simulation)
    body = simulation.spawn(plank(z=TOP + THICKNESS / 2))
    advance(simulation, 0.3)
    seconds = frames(simulation, 1.0) * simulation.info.frame_s
    simulation.drive(platform, STILL, (0.0, math.radians(degrees) / seconds, 0.0))
    advance(simulation, 1.0)
    simulation.drive(platform, STILL)
    advance(simulation, 0.3)
    start = pose(simulation, body)[:3]
    advance(simulation, 0.5)
    return float(np.linalg.norm(pose(simulation, body)[:3] - start))


def slides_on_a_tilted_platform_above_the_friction_angle(rig: Rig) -> None:
    """Check that a brick on a tilted platform holds below the friction angle and slides above this angle."""
    # 2 deg: in MuJoCo with one step per frame the brick slides a fifth of the true distance at 1 deg above.
    require_friction_angle(lambda degrees: _slide(rig, degrees), margin=2.0)


def reports_moved_bodies(rig: Rig) -> None:
    """Check that ``port.masses`` lists a moved body with infinite mass, even without live bodies, and its removal.

    The relative velocities of the moved body's contacts must include the body's velocity. A frozen brick on the body
    must not move, and must have no contacts with the body at rest.
    """
    simulation = rig.open()
    platform = _platform(simulation)
    body = simulation.spawn(plank(z=TOP + THICKNESS / 2))
    advance(simulation, 0.5)
    masses = simulation.port.masses()
    require(masses.body.tolist() == [platform, body], f"masses list {masses.body}, must list {[platform, body]}")
    require(bool(np.isinf(masses.mass[0])), f"masses list a moved body with {masses.mass[0]} kg, must list inf")
    contacts = simulation.port.contacts()
    require(pairs(contacts) == {(platform, body)}, f"the pairs are {pairs(contacts)}, must be {platform, body}")
    simulation.drive(platform, (0.05, 0.0, 0.0))
    simulation.step(simulation.info.frame_s)
    mine = touching(simulation.port.contacts(), body)
    turn = np.where(mine.body_b == platform, 1.0, -1.0)
    speed = (turn * mine.relative_velocity[:, 0]).max(initial=-np.inf)
    # The platform slips below the brick until both have the same speed; the slip is greatest in the first substep.
    require_between(0.02, speed, 0.051, "speed [m/s] at which a platform at 50 mm/s moves below a brick at rest")
    simulation.port.sleep([body])
    before = pose(simulation, body)
    advance(simulation, 0.2)
    require(
        bool((pose(simulation, body) == before).all()), "a frozen brick moved with the platform below it, must not move"
    )
    listed = simulation.port.masses().body.tolist()
    require(listed == [platform], f"with all bricks frozen masses list {listed}, must list the platform {[platform]}")
    simulation.drive(platform, STILL)
    simulation.step(simulation.info.frame_s)
    require(not len(simulation.port.contacts()), "a platform at rest has contacts with frozen bricks, must have none")
    simulation.remove(platform)
    removed = list(simulation.port.masses().removed)
    require(removed == [platform], f"masses list {removed} as removed after a removal, must be {[platform]}")
