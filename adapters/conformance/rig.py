"""Tools of every check: worlds, the standard plank, and errors that state the measurement."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from adapters.base import Simulation
from adapters.profile import Capabilities
from scenarios.model import CLEARANCE, Brick, Vector, World
from stability_core.port import Contacts, FloatArray

LENGTH, WIDTH, THICKNESS = PLANK = (0.117, 0.0234, 0.0078)
"""Edges [m] of the plank, along x, y and z when it lies flat."""
MASS = 0.0119
"""Mass of the plank [kg]."""
GRAVITY = 9.81
WEIGHTLESS: Vector = (0.0, 0.0, 0.0)


class ConformanceError(AssertionError):
    """An adapter broke the contract; the message says what was measured, and against what."""


def require(holds: bool, message: str) -> None:
    """Raise ``ConformanceError`` with the message unless the statement holds."""
    if not holds:
        raise ConformanceError(message)


def require_between(low: float, value: float, high: float, what: str) -> None:
    """Raise ``ConformanceError`` unless low <= value <= high; NaN is outside."""
    require(low <= value <= high, f"{what}: measured {value:.6g}, must lie within [{low:.6g}, {high:.6g}]")


def require_friction_angle(slide: Callable[[float], float], margin: float = 1.0) -> None:
    """Raise ``ConformanceError`` unless a plank holds a little below atan(mu), and slides freely a little above.

    Args:
        margin: how far [deg] below and above.
        slide: from a slope [deg] to the distance [m] that a plank moves in 0.5 s, after 0.3 s in which it comes to rest
            or not.
    """
    limit = math.degrees(math.atan(0.45))
    above = math.radians(limit + margin)
    pull = GRAVITY * (math.sin(above) - 0.45 * math.cos(above))
    freely = pull * 0.5 * 0.3 + pull * 0.5**2 / 2
    # Regularised friction creeps by millimetres a second; a twentieth of a true slide is a creep, not a slide.
    require_between(
        0.0, slide(limit - margin), freely / 20, f"distance [m] slid in 0.5 s {margin:g} deg below atan(mu), mu = 0.45"
    )
    # Half: one degree is 4 % of mu, and an engine whose mu is 2 % too high slides half as fast here.
    require_between(
        0.5 * freely, slide(limit + margin), 1.5 * freely, f"distance [m] slid in 0.5 s {margin:g} deg above atan(mu)"
    )


def plank(x: float = 0.0, z: float = THICKNESS / 2, lean: float = 0.0) -> Brick:
    """A plank centred on y = 0, by default at rest on the ground.

    Args:
        x: centre [m].
        z: height of the centre [m].
        lean: angle [rad] by which its long edge rises from +x towards +z.
    """
    return Brick(PLANK, MASS, (x, 0.0, z), (math.cos(lean / 2), 0.0, -math.sin(lean / 2), 0.0))


class Rig:
    """Opens worlds of one engine under one profile, and closes them all in the end."""

    def __init__(self, open_world: Callable[[World], Simulation], capabilities: Capabilities) -> None:
        self.capabilities = capabilities
        self._open_world = open_world
        self._opened: list[Simulation] = []

    def open(
        self, friction: float = 0.45, gravity: Vector = (0.0, 0.0, -GRAVITY), fixed: tuple[Brick, ...] = ()
    ) -> Simulation:
        """An empty world that a core watches: asked for its port, an engine records contact velocities."""
        simulation = self._open_world(World(friction, gravity, fixed))
        self._opened.append(simulation)
        require(len(simulation.port.masses().body) == 0, "a new world must be empty")
        return simulation

    def close(self) -> None:
        """Close every world that was opened."""
        while self._opened:
            self._opened.pop().close()


def advance(simulation: Simulation, seconds: float) -> None:
    """Step whole frames until ``seconds`` have passed."""
    for _ in range(frames(simulation, seconds)):
        simulation.step(simulation.info.frame_s)


def frames(simulation: Simulation, seconds: float) -> int:
    """Number of frames in a time."""
    return math.ceil(seconds / simulation.info.frame_s - 1e-9)


def pose(simulation: Simulation, body: int) -> FloatArray:
    """Position [m] and quaternion of one body, shape (7,)."""
    bodies, positions, quaternions = simulation.poses()
    row = bodies.tolist().index(body)
    return np.concatenate((positions[row], quaternions[row]))


def velocity(simulation: Simulation, body: int) -> FloatArray:
    """Linear [m/s] and angular [rad/s] velocity of one body, shape (6,)."""
    linear, angular = simulation.velocities()
    row = simulation.poses()[0].tolist().index(body)
    return np.concatenate((linear[row], angular[row]))


def touching(contacts: Contacts, body: int) -> Contacts:
    """The contacts of one body."""
    rows = (contacts.body_a == body) | (contacts.body_b == body)
    return contacts.chosen(rows)


def pairs(contacts: Contacts) -> set[tuple[int, int]]:
    """Which bodies touch: pairs of ids, the smaller one first."""
    return {(min(pair), max(pair)) for pair in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)}


def approach_speed(contacts: Contacts) -> float:
    """The fastest approach [m/s] along the normals; -inf without contacts."""
    return max(-np.einsum("ij,ij->i", contacts.relative_velocity, contacts.normal), default=-math.inf)


def penetration(contacts: Contacts) -> float:
    """The deepest overlap [m]; 0 without one."""
    return max(0.0, -min(contacts.separation, default=0.0))


def frozen_column(simulation: Simulation, levels: int, xs: Iterable[float] = (0.0,)) -> list[int]:
    """Flat planks piled at each x, frozen before they ever move; the ids of the top level."""
    top: list[int] = []
    for level in range(levels):
        top = [simulation.spawn(plank(x, (level + 0.5) * THICKNESS)) for x in xs]
        simulation.port.sleep(top)
    return top


def place_on(simulation: Simulation, levels: int, x: float = 0.0) -> int:
    """Release a flat plank ``CLEARANCE`` above ``levels`` levels; return its id."""
    return simulation.spawn(plank(x, (levels + 0.5) * THICKNESS + CLEARANCE))
