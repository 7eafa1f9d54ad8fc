"""Checks that the port lists a pair of bodies before a collision, and omits a pair that will not collide."""

from __future__ import annotations

import numpy as np

from adapters.conformance.rig import (
    LENGTH,
    WEIGHTLESS,
    Rig,
    approach_speed,
    pairs,
    plank,
    pose,
    require,
    require_between,
    velocity,
)
from scenarios.model import Brick

EDGE = 0.04
"""Edge [m] of the flying cube."""
HEIGHT = 0.5
"""Height [m] of the target, a frozen plank."""
SLOW = 0.05
"""Speed [m/s] of a pushed cube, which moves 0.8 mm in a frame."""
PUSHES = 8
"""Number of pushes, one per frame."""


def _fly(rig: Rig, speed: float, above: float) -> list[tuple[float, float, float, bool]]:
    """Let a cube fly towards a frozen plank until the cube has passed the plank or has slowed down, at most 60 frames.

    Args:
        rig: source of the world.
        speed: initial speed of the cube [m/s].
        above: height of the cube above the centre of the plank [m].

    Returns:
        A row per frame, of four values:

        - the gap between cube and plank along x [m];
        - the listed separation [m], NaN if the port does not list the pair;
        - the listed closing speed [m/s], NaN if the port does not list the pair;
        - True if the cube has more than 90 % of its initial speed along x.
    """
    simulation = rig.open(gravity=WEIGHTLESS)
    target = simulation.spawn(plank(z=HEIGHT))
    simulation.port.sleep([target])
    cube = simulation.spawn(Brick((EDGE, 0.02, EDGE), 0.1, (-0.5, 0.0, HEIGHT + above)))
    simulation.push(cube, (0.1 * speed, 0.0, 0.0))
    seen: list[tuple[float, float, float, bool]] = []
    while pose(simulation, cube)[0] < LENGTH and len(seen) < 60:
        simulation.step(simulation.info.frame_s)
        contacts = simulation.port.contacts()
        gap = -(LENGTH + EDGE) / 2 - pose(simulation, cube)[0]
        separation = closing = np.nan
        if (target, cube) in pairs(contacts):
            separation = float(contacts.separation[0])
            closing = -float(contacts.relative_velocity[0] @ contacts.normal[0])
        is_flying = bool(velocity(simulation, cube)[0] > 0.9 * speed)
        seen.append((gap, separation, closing, is_flying))
        if not is_flying:
            break
    return seen


def lists_what_is_about_to_strike(rig: Rig) -> None:
    """Check that the port lists a cube that flies at 2 or 10 m/s in the last frame before it strikes a frozen plank.

    The listed separation is the gap between cube and plank, and the listed closing speed is the cube's speed.
    """
    for speed in (2.0, 10.0):
        seen = _fly(rig, speed, 0.0)
        before = [row for row in seen if row[0] > 0.0 and row[3]]
        require(
            len(before) > 0, f"no frame shows a cube at {speed} m/s before it struck a plank, at least one frame must"
        )
        gap, separation, closing, _ = before[-1]
        require(
            not np.isnan(separation),
            f"the port omits a cube at {speed} m/s, {gap * 1e3:.1f} mm before a plank, must list it",
        )
        # 0.1 mm: single precision, and the shipped damping of some engines, 5 % per second.
        require_between(gap - 1e-4, separation, gap + 1e-4, f"listed separation [m] of a cube at {speed} m/s")
        require_between(0.9 * speed, closing, 1.01 * speed, f"listed closing speed [m/s] of a cube at {speed} m/s")


def does_not_list_what_passes_by(rig: Rig) -> None:
    """Check that the port omits a cube that passes 5 mm above a frozen plank at 2 or 10 m/s, and keeps its speed."""
    for speed in (2.0, 10.0):
        seen = _fly(rig, speed, EDGE / 2 + 3.9e-3 + 5e-3)
        listed = [row for row in seen if not np.isnan(row[1])]
        require(
            not listed, f"the port lists a cube that passes at {speed} m/s in {len(listed)} frames, must not list it"
        )
        require(seen[-1][3], f"a cube that passes at {speed} m/s lost a tenth of its speed, must keep its speed")


def shows_pushes_against_a_frozen_brick(rig: Rig) -> None:
    """Check that the port lists the approach of a cube that an impulse pushes against a frozen plank in each frame.

    The cube is too slow for the sweep of pairs that will meet. After a later substep has stopped the cube, an engine
    may list no contact. A cube that an engine throws back approaches in some of the frames only.
    """
    simulation = rig.open(gravity=WEIGHTLESS)
    target = simulation.spawn(plank(z=HEIGHT))
    simulation.port.sleep([target])
    cube = simulation.spawn(Brick((EDGE, 0.02, EDGE), 0.1, (-(LENGTH + EDGE) / 2 - 1e-5, 0.0, HEIGHT)))
    closing = []
    for _ in range(PUSHES):
        simulation.push(cube, (0.1 * SLOW, 0.0, 0.0))
        simulation.step(simulation.info.frame_s)
        closing.append(approach_speed(simulation.port.contacts()))
    shown = sum(speed > SLOW / 2 for speed in closing)
    require_between(PUSHES / 2, shown, PUSHES, f"frames of {PUSHES} that show the approach of a pushed cube")
