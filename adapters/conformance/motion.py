"""Checks of the motion of live bricks: gravity, impulses, friction, impacts, rest."""

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
    Rig,
    advance,
    frames,
    frozen_column,
    pairs,
    penetration,
    place_on,
    plank,
    pose,
    require,
    require_between,
    require_friction_angle,
    touching,
    velocity,
)
from scenarios.model import CLEARANCE, Vector

SEATED_SPEED, SEATED_PENETRATION = 3e-3, 0.2e-3
"""Greatest speed [m/s] and penetration [m] of a flat brick at rest, because a deeper brick tilts the next level."""
LEANING_SPEED, LEANING_PENETRATION = 50e-3, 4e-3
"""Greatest speed [m/s] and penetration [m] of a leaning brick at rest, because with lower limits the brick would slip
before a policy freezes it."""


def falls_freely(rig: Rig) -> None:
    """Check that the speed of a falling brick is g t, and its path g t^2 / 2, without damping or a second gravity."""
    simulation = rig.open()
    body = simulation.spawn(plank(z=5.0))
    advance(simulation, 0.5)
    seconds = frames(simulation, 0.5) * simulation.info.frame_s
    fallen = 5.0 - pose(simulation, body)[2]
    # 0.1 %: every integrator gains g dt per step; the shipped damping of some engines (4 % per second) exceeds it.
    require_between(0.999, -velocity(simulation, body)[2] / (GRAVITY * seconds), 1.001, "speed of fall over g t")
    # A first-order integrator leads or lags by half a step: 3.4 % of 30 frames.
    require_between(0.96, fallen / (0.5 * GRAVITY * seconds**2), 1.04, "distance of fall over g t^2 / 2")


def moves_by_impulse_over_mass(rig: Rig) -> None:
    """Check that an impulse J gives a brick of mass m the lasting velocity J / m and no spin."""
    simulation = rig.open(gravity=WEIGHTLESS)
    body = simulation.spawn(plank(z=0.5))
    advance(simulation, 0.1)
    simulation.push(body, (0.4 * MASS, 0.0, 0.3 * MASS))
    advance(simulation, 0.5)
    error = np.abs(velocity(simulation, body) - (0.4, 0.0, 0.3, 0.0, 0.0, 0.0)).max()
    require_between(0.0, error, 5e-4, "error of the speed [m/s] after an impulse for 0.5 m/s, without gravity")


def accelerates_by_force_over_mass(rig: Rig) -> None:
    """Check that a steady force F gives a live brick of mass m the velocity F t / m, and no spin.

    A force of zero must end the steady force. A frozen brick must not move under a steady force until the port
    unfreezes the brick.
    """
    simulation = rig.open(gravity=WEIGHTLESS)
    free, frozen = simulation.spawn(plank(z=0.5)), simulation.spawn(plank(x=0.5, z=0.5))
    advance(simulation, 0.1)
    simulation.port.sleep([frozen])
    before = pose(simulation, frozen)
    for body in (free, frozen):
        simulation.apply_force(body, (0.4 * MASS, 0.0, 0.3 * MASS))
    advance(simulation, 0.5)
    seconds = frames(simulation, 0.5) * simulation.info.frame_s
    for what in ("at the end of a steady force", "after it"):
        error = np.abs(velocity(simulation, free) - np.array((0.4, 0.0, 0.3, 0.0, 0.0, 0.0)) * seconds).max()
        # 1 %: the shipped damping of some engines is 5 % per second.
        require_between(0.0, error / seconds, 0.005, f"error of the acceleration [m/s2] {what} of 0.5 m/s2")
        simulation.apply_force(free, (0.0, 0.0, 0.0))
        advance(simulation, 0.1)
    require(
        bool((pose(simulation, frozen) == before).all()), "a frozen brick moved under a steady force, must not move"
    )
    simulation.port.wake([frozen])
    advance(simulation, 0.1)
    gained = velocity(simulation, frozen)[0] / (frames(simulation, 0.1) * simulation.info.frame_s)
    require_between(0.38, gained, 0.42, "acceleration [m/s2] of an unfrozen brick by a steady force for 0.4 m/s2")


def falls_along_gravity_that_changes(rig: Rig) -> None:
    """Check that a change of gravity acts on live bricks, on later unfrozen bricks, and on new bricks."""
    simulation = rig.open()
    live, frozen = simulation.spawn(plank(z=5.0)), simulation.spawn(plank(x=1.0, z=5.0))
    simulation.port.sleep([frozen])
    advance(simulation, 0.1)
    before = velocity(simulation, live)[:3]
    simulation.set_gravity((6.0, 0.0, 3.0))
    simulation.port.wake([frozen])
    new = simulation.spawn(plank(x=-1.0, z=5.0))
    advance(simulation, 0.2)
    seconds = frames(simulation, 0.2) * simulation.info.frame_s
    for body, start in ((live, before), (frozen, np.zeros(3)), (new, np.zeros(3))):
        error = np.abs((velocity(simulation, body)[:3] - start) / seconds - (6.0, 0.0, 3.0)).max()
        # 1 % of 6.7 m/s2, for the shipped damping of some engines.
        require_between(0.0, error, 0.07, "error of the acceleration [m/s2] after gravity became (6, 0, 3) m/s2")


def _slide(rig: Rig, degrees: float, heading: Vector, levels: int) -> float:
    """Return the distance [m] that a plank on a slope moves from 0.3 s to 0.8 s after its release.

    Args:
        rig: source of the world.
        degrees: angle of the slope [deg].
        heading: unit vector of the downhill direction in the plane of the slope.
        levels: number of frozen planks below the plank.
    """
    angle = math.radians(degrees)
    down = GRAVITY * math.sin(angle)
    simulation = rig.open(gravity=(down * heading[0], down * heading[1], -GRAVITY * math.cos(angle)))
    frozen_column(simulation, levels)
    body = simulation.spawn(plank(z=(levels + 0.5) * THICKNESS))
    advance(simulation, 0.3)
    start = pose(simulation, body)[:3]
    advance(simulation, 0.5)
    return float(np.linalg.norm(pose(simulation, body)[:3] - start))


def slides_on_the_ground_above_the_friction_angle(rig: Rig) -> None:
    """Check that a brick on the ground slides above the friction angle and holds below this angle."""
    require_friction_angle(lambda degrees: _slide(rig, degrees, (1.0, 0.0, 0.0), 0))


def slides_on_a_frozen_brick_above_the_friction_angle(rig: Rig) -> None:
    """Check that a brick on a frozen brick slides above the friction angle and holds below this angle."""
    require_friction_angle(lambda degrees: _slide(rig, degrees, (1.0, 0.0, 0.0), 1))


def slides_sideways_above_the_friction_angle(rig: Rig) -> None:
    """Check that a brick has the same friction angle across its length as along it."""
    require_friction_angle(lambda degrees: _slide(rig, degrees, (0.0, 1.0, 0.0), 0))


def is_braked_by_friction_between_live_bricks(rig: Rig) -> None:
    """Check that a pushed brick slides over a live brick with the deceleration mu g (mu: coefficient of friction)."""
    simulation = rig.open()
    simulation.spawn(plank())
    upper = place_on(simulation, 1)
    advance(simulation, 1.0)
    start = velocity(simulation, upper)[0]
    simulation.push(upper, (0.6 * MASS, 0.0, 0.0))
    advance(simulation, 0.1)
    seconds = frames(simulation, 0.1) * simulation.info.frame_s
    braking = (0.6 + start - velocity(simulation, upper)[0]) / seconds
    # 15 %: the plank rocks while its load shifts forward. With one step per frame the load of a single step is one
    # third to five thirds of the weight, so that the mean over six steps is known to one ninth.
    require_between(0.85 * 0.45, braking / GRAVITY, 1.15 * 0.45, "deceleration over g between live bricks, mu = 0.45")


def does_not_bounce(rig: Rig) -> None:
    """Check that the restitution is about 0: a brick that falls 5 mm rises by at most 0.25 mm."""
    simulation = rig.open()
    body = simulation.spawn(plank(z=THICKNESS / 2 + 5e-3))
    rose, lowest = 0.0, math.inf
    for _ in range(frames(simulation, 1.0)):
        simulation.step(simulation.info.frame_s)
        height = float(pose(simulation, body)[2])
        lowest = min(lowest, height)
        rose = max(rose, height - max(lowest, THICKNESS / 2))
    # 5 % of the drop, which corresponds to a restitution of 0.22, allows for the recovery from penetration.
    require_between(0.0, rose, 0.25e-3, "rise [m] of a brick above its height at rest, after a fall of 5 mm")


def _require_seated(simulation: Simulation, body: int, where: str) -> None:
    seated_since = None
    before = pose(simulation, body)[:3]
    limit = frames(simulation, 0.7)
    for frame in range(2 * limit):
        simulation.step(simulation.info.frame_s)
        now = pose(simulation, body)[:3]
        speed = np.linalg.norm(now - before) / simulation.info.frame_s
        before = now
        contacts = touching(simulation.port.contacts(), body)
        deep = penetration(contacts)
        if speed < SEATED_SPEED and deep < SEATED_PENETRATION and len(contacts):
            seated_since = frame if seated_since is None else seated_since
        else:
            seated_since = None
    state = f"in the last frame {speed * 1e3:.3g} mm/s, {deep * 1e3:.3g} mm deep, {len(contacts)} points"
    require(seated_since is not None, f"a brick placed {where} is not at rest after 1.4 s, must be: {state}")
    require(
        seated_since is not None and seated_since <= limit,
        f"a brick placed {where} is at rest from frame {seated_since}, must be from frame {limit} (0.7 s) or earlier",
    )


def seats_on_the_ground(rig: Rig) -> None:
    """Check that a brick released 0.5 mm above the ground is at rest, at most 0.2 mm deep, within 0.7 s."""
    simulation = rig.open()
    _require_seated(simulation, place_on(simulation, 0), "on the ground")


def seats_on_frozen_bricks(rig: Rig) -> None:
    """Check that bricks on a frozen column of 25 levels and across two frozen bricks are at rest within 0.7 s."""
    simulation = rig.open()
    frozen_column(simulation, 25)
    _require_seated(simulation, place_on(simulation, 25), "on 25 frozen levels")
    simulation = rig.open()
    frozen_column(simulation, 2, xs=(-LENGTH / 2 - 1e-3, LENGTH / 2 + 1e-3))
    _require_seated(simulation, place_on(simulation, 2), "across two frozen bricks")


def holds_an_inverted_v(rig: Rig) -> None:
    """Check that two planks that lean on each other at 72 deg are slow in two successive frames within 0.2 s.

    A policy needs two slow frames to freeze the planks. In the 0.2 s the planks must not slip.
    """
    simulation = rig.open()
    lean = math.radians(72)
    half_height = (LENGTH * math.sin(lean) + THICKNESS * math.cos(lean)) / 2
    aside = (LENGTH * math.cos(lean) + THICKNESS * math.sin(lean)) / 2 + 0.1e-3
    left = simulation.spawn(plank(-aside, half_height + CLEARANCE, lean))
    right = simulation.spawn(plank(aside, half_height + CLEARANCE, math.pi - lean))
    before, quiet, longest = simulation.poses()[1], 0, 0
    for _ in range(frames(simulation, 0.2)):
        simulation.step(simulation.info.frame_s)
        now = simulation.poses()[1]
        speed = np.linalg.norm(now - before, axis=1).max() / simulation.info.frame_s
        before = now
        contacts = simulation.port.contacts()
        leans = {(-1, left), (-1, right), (left, right)} <= pairs(contacts)
        calm = speed <= LEANING_SPEED and penetration(contacts) <= LEANING_PENETRATION
        quiet = quiet + 1 if leans and calm else 0
        longest = max(longest, quiet)
    require(longest >= 2, f"an inverted V at 72 deg was slow for {longest} frames in a row in 0.2 s, must be 2 or more")
    sunk = half_height - before[:, 2].min()
    # The drop onto the support and the penetration lower the V by up to 2.5 mm; a slipping V sinks by more.
    require_between(-1e-3, sunk, 2.5e-3, "depth [m] to which an inverted V at 72 deg sank in 0.2 s")


def falls_when_its_support_is_removed(rig: Rig) -> None:
    """Check that a brick at rest for 3 s falls without its frozen support, because the engine's own sleeping is off."""
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 3.0)
    simulation.remove(support)
    advance(simulation, 0.5)
    # On the ground the brick's centre is half a thickness high; the other half is a margin.
    require_between(0.0, pose(simulation, body)[2], THICKNESS, "height [m] of a brick whose support was removed")
