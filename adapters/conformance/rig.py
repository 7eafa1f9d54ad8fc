"""Tools for all checks: worlds, the standard plank, and errors that state the measured and the required value."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from adapters.base import Simulation
from adapters.profile import Capabilities
from adapters.shared.live_pairs import contact_pairs
from scenarios.model import CLEARANCE, Brick, Vector, World
from stability_core.port import Contacts, FloatArray

LENGTH, WIDTH, THICKNESS = PLANK = (0.117, 0.0234, 0.0078)
"""Edges [m] of the plank, along x, y and z when it lies flat."""
MASS = 0.0119
"""Mass of the plank [kg]."""
GRAVITY = 9.81
WEIGHTLESS: Vector = (0.0, 0.0, 0.0)


class ConformanceError(AssertionError):
    """Error for an adapter that breaks the contract; the message states the measured and the required value."""


def require(holds: bool, message: str) -> None:
    """Raise ``ConformanceError`` with ``message`` unless ``holds`` is true."""
    if not holds:
        raise ConformanceError(message)


def require_between(low: float, value: float, high: float, what: str) -> None:
    """Raise ``ConformanceError`` unless low <= value <= high, also for NaN; ``what`` is the quantity with its unit."""
    require(low <= value <= high, f"{what}: measured {value:.6g}, must lie within [{low:.6g}, {high:.6g}]")


def require_friction_angle(slide: Callable[[float], float], margin: float = 1.0) -> None:
    """Raise ``ConformanceError`` unless a body holds just below the friction angle and slides just above this angle.

    Args:
        slide: function of the slope [deg] that returns the distance [m] that a body moves in 0.5 s, from 0.3 s after
            its release.
        margin: difference [deg] of the two slopes from the friction angle atan(mu), with the coefficient mu = 0.45.
    """
    limit = math.degrees(math.atan(0.45))
    above = math.radians(limit + margin)
    pull = GRAVITY * (math.sin(above) - 0.45 * math.cos(above))
    freely = pull * 0.5 * 0.3 + pull * 0.5**2 / 2
    # A twentieth of a true slide counts as holding, because regularised friction creeps by millimetres per second.
    require_between(
        0.0, slide(limit - margin), freely / 20, f"distance [m] slid in 0.5 s {margin:g} deg below atan(mu), mu = 0.45"
    )
    # Half of a true slide is required: one degree is 4 % of mu, so that 2 % too much friction halves the slide.
    require_between(
        0.5 * freely, slide(limit + margin), 1.5 * freely, f"distance [m] slid in 0.5 s {margin:g} deg above atan(mu)"
    )


def plank(x: float = 0.0, z: float = THICKNESS / 2, lean: float = 0.0) -> Brick:
    """Return a plank centred on y = 0, by default flat on the ground.

    Args:
        x: x of the centre [m].
        z: height of the centre [m].
        lean: angle [rad] by which the long edge rises from +x towards +z.
    """
    return Brick(PLANK, MASS, (x, 0.0, z), (math.cos(lean / 2), 0.0, -math.sin(lean / 2), 0.0))


class Rig:
    """Source of worlds of one engine and profile; ``close`` closes all these worlds."""

    def __init__(self, open_world: Callable[[World], Simulation], capabilities: Capabilities) -> None:
        self.capabilities = capabilities
        self._open_world = open_world
        self._opened: list[Simulation] = []

    def open(
        self,
        friction: float = 0.45,
        gravity: Vector = (0.0, 0.0, -GRAVITY),
        fixed: tuple[Brick, ...] = (),
        restitution: float = 0.0,
        is_read: bool = True,
    ) -> Simulation:
        """Open and return an empty world.

        Args:
            friction: coefficient of friction of the world.
            gravity: gravity [m/s2].
            fixed: fixed boxes.
            restitution: coefficient of restitution.
            is_read: whether the method accesses the world's port, so that the engine records contact velocities.

        Raises:
            ConformanceError: if the masses of the new world list bodies.
        """
        simulation = self._open_world(World(friction, gravity, fixed, restitution))
        self._opened.append(simulation)
        if is_read:
            require(len(simulation.port.masses().body) == 0, "masses list bodies in a new world, must list none")
        return simulation

    def close(self) -> None:
        """Close every world that ``open`` has opened."""
        while self._opened:
            self._opened.pop().close()


def advance(simulation: Simulation, seconds: float) -> None:
    """Step a simulation by whole frames, for ``seconds`` or slightly more."""
    for _ in range(frames(simulation, seconds)):
        simulation.step(simulation.info.frame_s)


def frames(simulation: Simulation, seconds: float) -> int:
    """Return the number of whole frames that cover a time of ``seconds``."""
    return math.ceil(seconds / simulation.info.frame_s - 1e-9)


def pose(simulation: Simulation, body: int) -> FloatArray:
    """Return the position [m] and the quaternion (w, x, y, z) of a body, shape (7,)."""
    bodies, positions, quaternions = simulation.poses()
    row = bodies.tolist().index(body)
    return np.concatenate((positions[row], quaternions[row]))


def velocity(simulation: Simulation, body: int) -> FloatArray:
    """Return the linear [m/s] and the angular [rad/s] velocity of a body, shape (6,)."""
    linear, angular = simulation.velocities()
    row = simulation.poses()[0].tolist().index(body)
    return np.concatenate((linear[row], angular[row]))


def touching(contacts: Contacts, body: int) -> Contacts:
    """Return the contacts of a body."""
    rows = (contacts.body_a == body) | (contacts.body_b == body)
    return contacts.chosen(rows)


def pairs(contacts: Contacts) -> set[tuple[int, int]]:
    """Return the pairs of ids that have contacts, the smaller id first."""
    return set(contact_pairs(contacts))


def approach_speed(contacts: Contacts) -> float:
    """Return the greatest approach speed [m/s] along the normals; -inf without contacts."""
    return max(-np.einsum("ij,ij->i", contacts.relative_velocity, contacts.normal), default=-math.inf)


def penetration(contacts: Contacts) -> float:
    """Return the greatest overlap [m]; 0 without an overlap."""
    return max(0.0, -min(contacts.separation, default=0.0))


def frozen_column(simulation: Simulation, levels: int, xs: Iterable[float] = (0.0,)) -> list[int]:
    """Spawn a column of flat planks at each x [m], frozen before any step; return the ids of the top level."""
    top: list[int] = []
    for level in range(levels):
        top = [simulation.spawn(plank(x, (level + 0.5) * THICKNESS)) for x in xs]
        simulation.port.sleep(top)
    return top


def place_on(simulation: Simulation, levels: int, x: float = 0.0) -> int:
    """Spawn a flat plank at a gap of ``CLEARANCE`` above a column of ``levels`` planks; return the plank's id."""
    return simulation.spawn(plank(x, (levels + 0.5) * THICKNESS + CLEARANCE))
