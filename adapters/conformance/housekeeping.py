"""Checks of properties on which the harness relies: ids, errors, poses, settings, and runs that repeat bit for bit."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import LENGTH, MASS, THICKNESS, Rig, advance, plank, pose, require, require_between
from stability_core.port import FloatArray


def _require_error(kind: type[Exception], action: Callable[[], object], what: str) -> None:
    try:
        action()
    except kind:
        return
    require(False, f"{what} raises no error, must raise {kind.__name__}")


def refuses_bad_input(rig: Rig) -> None:
    """Check that unknown ids raise ``KeyError``, and that bad numbers raise ``ValueError`` and add no body.

    Bad numbers are NaN, a negative edge and a mass of 0.
    """
    simulation = rig.open()
    body = simulation.spawn(plank())
    nowhere = (math.nan, 0.0, 0.1)
    for action in (
        lambda: simulation.remove(99),
        lambda: simulation.push(99, (0.0, 0.0, 0.0)),
        lambda: simulation.apply_force(99, (0.0, 0.0, 0.0)),
        lambda: simulation.move(99, (0.0, 0.0, 0.1), (1.0, 0.0, 0.0, 0.0)),
        lambda: simulation.port.sleep([99]),
        lambda: simulation.port.wake([99]),
    ):
        _require_error(KeyError, action, "an unknown body")
    _require_error(ValueError, lambda: simulation.spawn(replace(plank(), position=nowhere)), "a brick at NaN")
    _require_error(ValueError, lambda: simulation.spawn(replace(plank(), mass=0.0)), "a brick without mass")
    _require_error(ValueError, lambda: simulation.spawn(replace(plank(), size=(0.1, -0.1, 0.1))), "a negative edge")
    _require_error(ValueError, lambda: simulation.move(body, nowhere, (1.0, 0.0, 0.0, 0.0)), "a move to NaN")
    _require_error(ValueError, lambda: simulation.push(body, nowhere), "an impulse of NaN")
    _require_error(ValueError, lambda: simulation.apply_force(body, nowhere), "a force of NaN")
    _require_error(ValueError, lambda: simulation.set_gravity(nowhere), "gravity of NaN")
    bodies = simulation.poses()[0].tolist()
    require(bodies == [body], f"after rejected input the world has the bodies {bodies}, must be [{body}]")


def refuses_what_leaves_its_plane(rig: Rig) -> None:
    """Check that a planar engine raises ``ValueError`` for input that leaves its plane.

    The input is a brick, a move, an impulse, a force, a velocity or gravity.
    """
    simulation = rig.open()
    body = simulation.spawn(plank())
    lift = simulation.spawn(replace(plank(x=1.0), moved=True))
    aside, turned = (0.0, 0.1, 0.0), (math.cos(0.1), math.sin(0.1), 0.0, 0.0)
    for what, action in {
        "a brick outside the plane": lambda: simulation.spawn(replace(plank(x=0.5), position=(0.5, 0.1, 0.1))),
        "a brick turned out of the plane": lambda: simulation.spawn(replace(plank(x=0.5), quaternion=turned)),
        "a move out of the plane": lambda: simulation.move(body, aside, (1.0, 0.0, 0.0, 0.0)),
        "an impulse out of the plane": lambda: simulation.push(body, aside),
        "a force out of the plane": lambda: simulation.apply_force(body, aside),
        "a velocity out of the plane": lambda: simulation.drive(lift, aside),
        "gravity out of the plane": lambda: simulation.set_gravity(aside),
    }.items():
        _require_error(ValueError, action, what)


def keeps_poses_and_ids(rig: Rig) -> None:
    """Check that the world returns the spawned poses, by rising id, and does not reuse an id."""
    simulation = rig.open()
    planned = [plank(0.3 * i, 0.3, lean) for i, lean in enumerate((0.0, 0.4, -1.2, 2.0))]
    bodies = [simulation.spawn(brick) for brick in planned]
    for body, brick in zip(bodies, planned, strict=True):
        given, got = np.array(brick.position + brick.quaternion), pose(simulation, body)
        got[3:] *= math.copysign(1.0, got[3:] @ given[3:])  # q and -q are the same rotation
        # 1e-6: an engine may store poses in single precision.
        require_between(
            0.0, np.abs(got - given).max(), 1e-6, f"error of the pose of a brick spawned at {brick.position}"
        )
    simulation.remove(bodies[-1])
    bodies[-1] = simulation.spawn(plank(1.5))
    simulation.remove(bodies[0])
    bodies.append(simulation.spawn(plank(1.8)))
    require(len(set(bodies)) == 5, f"the ids of five spawned bricks are {bodies}, must all differ")
    listed = simulation.poses()[0].tolist()
    require(listed == sorted(bodies[1:]), f"poses list the bodies {listed}, must be {sorted(bodies[1:])}")


def moves_a_live_brick(rig: Rig) -> None:
    """Check that a live brick that the host moves has its new pose, and falls from rest there."""
    simulation = rig.open()
    body = simulation.spawn(plank(z=1.0))
    advance(simulation, 0.2)
    simulation.move(body, (0.1, 0.0, 0.5), (math.cos(0.25), 0.0, math.sin(0.25), 0.0))
    given = np.array((0.1, 0.0, 0.5, math.cos(0.25), 0.0, math.sin(0.25), 0.0))
    require_between(0.0, np.abs(pose(simulation, body) - given).max(), 1e-6, "error of the pose that was set")
    simulation.step(simulation.info.frame_s)
    fallen = 0.5 - pose(simulation, body)[2]
    require_between(
        0.0, fallen, 1.01 * 9.81 * simulation.info.frame_s**2, "fall [m] of a brick in the first frame after a move"
    )


def tumble(simulation: Simulation) -> bytes:
    """Return the bytes of all poses of five falling bricks in 60 frames.

    Bricks of the pile freeze, unfreeze, get a push and leave.
    """
    recorded = []
    bodies = [simulation.spawn(plank(0.3 * LENGTH * (i % 2), (1.5 * i + 0.5) * THICKNESS, 0.1 * i)) for i in range(5)]
    for frame in range(60):
        if frame == 15:
            simulation.port.sleep(bodies[:2])
        if frame == 25:
            simulation.push(bodies[3], (0.2 * MASS, 0.0, 0.0))
        if frame == 35:
            simulation.port.wake(bodies[:1])
            simulation.remove(bodies[1])
        simulation.step(simulation.info.frame_s)
        _, positions, quaternions = simulation.poses()
        recorded.append(positions.tobytes() + quaternions.tobytes())
    return b"".join(recorded)


def repeats_bit_for_bit(rig: Rig) -> None:
    """Check that the same sequence of calls in two worlds gives the same poses, bit for bit."""
    first, second = tumble(rig.open()), tumble(rig.open())
    require(first == second, "the same sequence of calls gave different poses, must give equal bits")


def _slide(simulation: Simulation) -> FloatArray:
    """Return the positions [m] of a sliding plank and a plank that falls onto it, in 30 frames."""
    recorded = []
    below = simulation.spawn(plank())
    simulation.spawn(plank(0.3 * LENGTH, 1.6 * THICKNESS, 0.02))
    simulation.push(below, (0.2 * MASS, 0.0, 0.0))
    for _ in range(30):
        simulation.step(simulation.info.frame_s)
        recorded.append(simulation.poses()[1])
    return np.array(recorded)


def moves_alike_unread_and_read(rig: Rig) -> None:
    """Check that the engine moves bricks alike, bit for bit, whether the port reads it or not.

    The suite reads contacts of the engine with the extension only. If reading changed the engine, then a comparison of
    both would not measure the extension.
    """
    unread, read = _slide(rig.open(is_read=False)), _slide(rig.open())
    difference = float(np.abs(unread - read).max())
    require_between(0.0, difference, 0.0, "distance [m] between the positions without and with reading of contacts")


def has_the_settings_of_its_profile(rig: Rig) -> None:
    """Check that every knob that the engine reports has the profile's value, within single precision."""
    simulation = rig.open()
    simulation.spawn(plank())
    wanted = simulation.info.profile.values
    for name, value in simulation.read_knobs().items():
        same = value == wanted[name] or (
            isinstance(value, (int, float)) and math.isclose(value, float(wanted[name]), rel_tol=1e-6, abs_tol=1e-12)
        )
        require(same, f"the engine has {name} = {value!r}, must be the profile's {wanted[name]!r}")
