"""Checks of freezing and unfreezing: a freeze is exact, and does not change the later motion."""

from __future__ import annotations

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
    place_on,
    plank,
    pose,
    require,
    require_between,
    velocity,
)


def _require_still(simulation: Simulation, body: int, before: np.typing.NDArray[np.float64], when: str) -> None:
    drift = np.abs(pose(simulation, body) - before).max()
    require(drift == 0.0, f"a frozen brick moved by {drift:.3g} {when}, must not move by a bit")


def stays_frozen(rig: Rig) -> None:
    """Check that frozen bricks do not move by a bit in 5 s: in the air, under an impact, under a push.

    Their velocities must be 0.
    """
    simulation = rig.open()
    hanging, seated = simulation.spawn(plank(0.0, 0.1)), place_on(simulation, 0, x=0.3)
    advance(simulation, 0.05)
    simulation.port.sleep([hanging, seated])
    before = {body: pose(simulation, body) for body in (hanging, seated)}
    simulation.spawn(plank(0.03, 0.1 + 0.03))
    simulation.spawn(plank(0.33, 0.03))
    simulation.push(seated, (MASS, 0.0, 0.0))
    advance(simulation, 5.0)
    for body in (hanging, seated):
        _require_still(simulation, body, before[body], "in 5 s under an impact and a push")
        require(
            not velocity(simulation, body).any(),
            f"a frozen brick has the velocity {velocity(simulation, body)}, must be 0",
        )


def freezes_in_flight(rig: Rig) -> None:
    """Check that a brick frozen in flight stops at once, and falls from rest after the port unfreezes the brick."""
    simulation = rig.open()
    body = simulation.spawn(plank(z=1.0))
    simulation.push(body, (MASS, 0.0, 0.0))
    advance(simulation, 0.2)
    simulation.port.sleep([body])
    before = pose(simulation, body)
    advance(simulation, 0.5)
    _require_still(simulation, body, before, "after it was frozen in flight")
    simulation.port.wake([body])
    advance(simulation, 0.2)
    seconds = frames(simulation, 0.2) * simulation.info.frame_s
    error = np.abs(velocity(simulation, body)[:3] - (0.0, 0.0, -GRAVITY * seconds)).max()
    require_between(
        0.0, error, 0.01 * GRAVITY * seconds, "error of the speed [m/s] of an unfrozen brick that falls from rest"
    )


def freezes_before_its_first_step(rig: Rig) -> None:
    """Check that bricks frozen before the first step do not move, and fall alike after the port unfreezes them."""
    simulation = rig.open()
    bodies = [simulation.spawn(plank(0.2 * column, 0.5)) for column in range(20)]
    simulation.port.sleep(bodies)
    before = {body: pose(simulation, body) for body in bodies}
    advance(simulation, 0.5)
    for body in bodies:
        _require_still(simulation, body, before[body], "after it was frozen before its first step")
    simulation.port.wake(bodies)
    advance(simulation, 0.2)
    seconds = frames(simulation, 0.2) * simulation.info.frame_s
    speeds = np.array([-velocity(simulation, body)[2] for body in bodies]) / (GRAVITY * seconds)
    require_between(0.99, speeds.min(), 1.01, "least speed of fall over g t of 20 unfrozen bricks")
    require_between(0.99, speeds.max(), 1.01, "greatest speed of fall over g t of 20 unfrozen bricks")


def carries_a_live_brick(rig: Rig) -> None:
    """Check that a frozen brick in the air bears a live brick. The live brick may sink by at most 0.5 mm."""
    simulation = rig.open()
    shelf = simulation.spawn(plank(z=0.3))
    simulation.port.sleep([shelf])
    body = simulation.spawn(plank(z=0.3 + THICKNESS + 0.5e-3))
    advance(simulation, 1.0)
    sunk = 0.3 + THICKNESS - pose(simulation, body)[2]
    require_between(-0.1e-3, sunk, 0.5e-3, "depth [m] to which a brick sank into a frozen brick")


def _struck(rig: Rig, freeze: bool) -> np.typing.NDArray[np.float64]:
    """Return the velocities (12,) of two weightless planks after the second plank struck the end of the first.

    The numbers of each plank are linear [m/s], then angular [rad/s]. With ``freeze`` the function freezes and unfreezes
    the struck plank before the impact.
    """
    simulation = rig.open(gravity=WEIGHTLESS)
    target, striker = simulation.spawn(plank(z=0.5)), simulation.spawn(plank(0.4 * LENGTH, 0.5 + THICKNESS + 0.02))
    if freeze:
        simulation.port.sleep([target])
    advance(simulation, 0.2)
    if freeze:
        simulation.port.wake([target])
    simulation.push(striker, (0.0, 0.0, -0.3 * MASS))
    advance(simulation, 0.2)
    return np.concatenate((velocity(simulation, target), velocity(simulation, striker)))


def tumbles_as_if_never_frozen(rig: Rig) -> None:
    """Check that a blow at one end moves an unfrozen brick like a brick that the port has not frozen.

    Equal motion shows that the unfrozen brick has its mass and inertia.
    """
    never, woken = _struck(rig, freeze=False), _struck(rig, freeze=True)
    require_between(0.05, abs(never[2]), 0.3, "speed [m/s] of a brick struck at its end by a brick of 0.3 m/s")
    for name, part in (("linear [m/s]", slice(0, 3)), ("angular [rad/s]", slice(3, 6))):
        error = np.abs(woken[part] - never[part]).max()
        most = 0.01 * np.abs(never[part]).max()
        require_between(0.0, error, most, f"difference of {name} velocity between bricks unfrozen and never frozen")


def wakes_to_live_again(rig: Rig) -> None:
    """Check that an unfrozen brick has its mass and contacts in the port, supports a brick, and slides when pushed."""
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 1.0)
    simulation.port.sleep([body])
    advance(simulation, 0.2)
    simulation.port.wake([support, body])
    advance(simulation, 1.0)
    masses, contacts = simulation.port.masses(), simulation.port.contacts()
    weights = dict(zip(masses.body.tolist(), masses.mass.tolist(), strict=True))
    require(weights == {support: MASS, body: MASS}, f"masses of two unfrozen bricks are {weights} kg, must be {MASS}")
    touched = set(contacts.body_a.tolist()) | set(contacts.body_b.tolist())
    require({support, body} <= touched, f"contacts touch {touched}, must also touch the unfrozen {support, body}")
    before = pose(simulation, body)
    # With soft contacts, as shipped, two bricks sink by 1.1 mm; a brick without contacts is half a thickness deep.
    require_between(1.3 * THICKNESS, before[2], 1.55 * THICKNESS, "height [m] of the upper of two unfrozen bricks")
    simulation.push(body, (0.5 * MASS, 0.0, 0.0))
    advance(simulation, 0.2)
    # With the deceleration mu g = 4.4 m/s2 the brick slides 28 mm.
    slid = pose(simulation, body)[0] - before[0]
    require_between(0.02, slid, 0.04, "distance [m] that an unfrozen brick slides after a push to 0.5 m/s")


def moves_a_frozen_brick(rig: Rig) -> None:
    """Check that a frozen brick that the host moves stays frozen, and supports bricks at its new pose only."""
    simulation = rig.open()
    shelf = simulation.spawn(plank(z=0.1))
    simulation.port.sleep([shelf])
    advance(simulation, 0.1)
    simulation.move(shelf, (0.5, 0.0, 0.2), (1.0, 0.0, 0.0, 0.0))
    before = pose(simulation, shelf)
    error = abs(before[0] - 0.5) + abs(before[2] - 0.2)
    require_between(0.0, error, 1e-7, "error [m] of the pose that was set (tolerance: rounding in single precision)")
    carried, dropped = (
        simulation.spawn(plank(0.5, 0.2 + THICKNESS + 0.5e-3)),
        simulation.spawn(plank(0.0, 0.1 + THICKNESS)),
    )
    advance(simulation, 0.5)
    _require_still(simulation, shelf, before, "after the host had moved it")
    require_between(
        0.2, pose(simulation, carried)[2], 0.2 + 1.2 * THICKNESS, "height [m] of a brick on the moved brick"
    )
    require_between(0.0, pose(simulation, dropped)[2], 0.05, "height [m] of a brick where the moved brick was")


def removes_a_frozen_brick(rig: Rig) -> None:
    """Check that a removed frozen brick stops no brick, and that its frozen neighbour does not move."""
    simulation = rig.open()
    removed, kept = simulation.spawn(plank(0.0, 0.1)), simulation.spawn(plank(0.2, 0.1))
    simulation.port.sleep([removed, kept])
    advance(simulation, 0.1)
    before = pose(simulation, kept)
    simulation.remove(removed)
    falling = simulation.spawn(plank(0.0, 0.1 + THICKNESS))
    require(falling not in (removed, kept), f"the id {falling} was used before, must be new")
    advance(simulation, 0.5)
    require_between(
        0.0, pose(simulation, falling)[2], 0.05, "height [m] of a brick that falls through the place of a removed brick"
    )
    _require_still(simulation, kept, before, "when its neighbour was removed")
