"""The words in which a scene is told: bricks, timed actions, and what must happen by theory.

SI units, z up; quaternions are (w, x, y, z). Nothing here knows an engine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


CLEARANCE = 0.5e-3
"""Gap [m] between a brick that is let go and its actual support. Absolute heights would punish a stack
that sinks with ever larger drops."""


@dataclass(frozen=True, slots=True)
class World:
    """What every brick of a scene shares. The ground's upper face is z = 0."""

    friction: float = 0.45
    """Coulomb coefficient of every pair: brick on brick, on ground and on fixed boxes alike."""
    gravity: Vector = (0.0, 0.0, -9.81)
    """Gravitational acceleration [m/s2]."""
    fixed: tuple[Brick, ...] = ()
    """Boxes that never move: walls, tables, ceilings. They may touch each other and the ground; their mass and level
    mean nothing. In contacts they are part of the ground."""


@dataclass(frozen=True, slots=True)
class Brick:
    """A homogeneous rigid box and the pose in which it is planned."""

    size: Vector
    """Edge lengths [m] along the brick's own x, y and z."""
    mass: float
    """Mass [kg]."""
    position: Vector
    """Centre [m]. When a scene is played, the height is only a plan: see ``Place``."""
    quaternion: Quaternion = UPRIGHT
    level: int = 1
    """The level of the stack that the brick belongs to, from 1."""
    moved: bool = False
    """True for a body that the host moves: a lift, a belt, a door. Nothing else moves it; it carries what lies on it.
    Keep it clear of the ground, of fixed boxes and of its like. Its mass means nothing."""


@dataclass(frozen=True, slots=True)
class Place:
    """Let bricks go together, as one rigid group, a little above their actual support.

    The group keeps its planned x, y and orientation and its relative heights; the hand lowers it
    until the first of its bricks is ``height`` above whatever really lies below.
    """

    time: float
    """When [s], from the start of the trial."""
    bricks: tuple[Brick, ...]
    height: float = CLEARANCE
    """From where [m] they are dropped, above their actual support. Zero sets them down without a gap: a prebuilt stack,
    which may have several levels. The harness asks a stability extension to judge it before the next engine step."""


@dataclass(frozen=True, slots=True)
class Remove:
    """Take a brick out of the world."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""


@dataclass(frozen=True, slots=True)
class Push:
    """Strike a brick at its centre of mass."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    impulse: Vector
    """Impulse [N s]."""


@dataclass(frozen=True, slots=True)
class Pull:
    """Pull a brick sideways by its centre of mass, as hard as it takes, and then take it out of the world.

    The hand has the brick from the first: wherever it goes, it is in its place.
    """

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    velocity: tuple[float, float]
    """In x and y [m/s]."""
    seconds: float
    """How long [s]."""

    @property
    def until(self) -> float:
        """When it ends [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Press:
    """Press steadily on a brick at its centre of mass, then let it go."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    force: Vector
    """Force [N]."""
    seconds: float
    """How long [s]."""

    @property
    def until(self) -> float:
        """When it ends [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Tilt:
    """Turn gravity about a horizontal axis, which is how a table tilts as seen by who stands on it.

    Every frame turns it by a step, so that after ``seconds`` the angle is ``speed`` times ``seconds``.
    """

    time: float
    axis: tuple[float, float]
    """Direction of the axis in x and y, about which a table would turn by the right-hand rule: about (0, 1) its +x end
    goes down, so that gravity turns from -z towards +x."""
    speed: float
    """Degrees a second."""
    seconds: float
    """How long [s]."""

    @property
    def until(self) -> float:
        """When it ends [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Drive:
    """Bring a moved brick to a velocity, which it keeps until it is driven anew."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0; a brick with ``moved``."""
    velocity: Vector
    """Velocity of its centre [m/s]."""
    spin: Vector = (0.0, 0.0, 0.0)
    """Angular velocity [rad/s]."""
    seconds: float = 0.0
    """How long [s] it takes to reach them, evenly accelerated from the present ones; 0: at once."""
    carries: bool = False
    """Whether the bricks of higher levels are in place where the platform brings them; otherwise where they are now."""

    @property
    def until(self) -> float:
        """When the velocity is reached [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class MustMove:
    """A brick that must move by theory, from one time on until it has gone some way."""

    brick: int
    """The brick's index in the order of placement, from 0."""
    from_s: float
    """From when [s]."""
    way_m: float
    """How far [m] its centre must go, in a straight line from where it was."""
    takes_s: float | None
    """How long [s] that takes by theory; None if theory does not say."""


Action: TypeAlias = Place | Remove | Push | Pull | Press | Tilt | Drive


@dataclass(frozen=True, slots=True)
class Expectation:
    """What must happen by theory."""

    outcome: Literal["stand", "fall", "study"]
    theory: str
    """Why, in one line, with its source."""
    level: int | None = None
    """The level at which it must fall; None unless ``outcome`` is "fall"."""
    not_before_s: float = 0.0
    """When [s] that becomes due at the earliest: a scene that is undermined must stand until then."""
    within_s: float | None = None
    """How long [s] after that the fall may take; a fall that comes later counts as standing. None: to the end."""

    def __str__(self) -> str:
        if self.outcome != "fall":
            return {"stand": "stands", "study": "study"}[self.outcome]
        return f"falls at {self.level}" + (f" after {self.not_before_s:g} s" if self.not_before_s else "")


@dataclass(frozen=True, slots=True)
class Scene:
    """One variant of a scenario, ready to be played."""

    scenario: str
    """Registry name, such as ``four_stack``."""
    variant: str
    """Id of this variant, unique over its parameters, such as ``card_house-2``."""
    parameters: Mapping[str, float | int | str]
    world: World
    actions: tuple[Action, ...]
    """In order of time."""
    expectation: Expectation
    look_for: str
    """What a person who watches should look for."""
    pair: str = ""
    """Id that a scene which must stand shares with one that must fall and differs from it only in what decides: only
    both together tell a stability test from glue. Empty if it has no partner."""
    planar: bool = False
    """True if every brick stays in the x-z plane, so that a 2-D engine can play it."""
    poured: bool = False
    """True if bricks find their own places: none is ever out of place, and what is measured is the heap."""
    watch_s: float = 5.0
    """How long [s] the trial watches after the last action."""
    must_move: tuple[MustMove, ...] = ()
    """Bricks that may not sleep: the harness measures for how long they do."""
    size: float = 1.0
    """Factor by which ``scenarios.scenes.shared.transforms`` enlarged the scene. Placement noise grows with it."""
    bricks: tuple[Brick, ...] = field(init=False)
    """All bricks in the order of placement."""
    levels: int = field(init=False)
    """Number of levels when everything is built."""

    def __post_init__(self) -> None:
        placed = tuple(brick for action in self.actions if isinstance(action, Place) for brick in action.bricks)
        object.__setattr__(self, "bricks", placed)
        object.__setattr__(self, "levels", max(brick.level for brick in placed))

    @property
    def pace(self) -> float:
        """Factor on all times: see ``pace_of``."""
        return pace_of(self.size)

    @property
    def done_s(self) -> float:
        """When [s] the last action is over: some take their time."""
        return max(
            action.until if isinstance(action, Pull | Press | Tilt | Drive) else action.time for action in self.actions
        )


def pace_of(size: float) -> float:
    """Return the factor on all times of a scene whose lengths are ``size`` times as large.

    Gravity stays, so that falls take the square root of ``size`` longer. Smaller bricks keep their times, because the
    frames of an engine do not become shorter.
    """
    return max(1.0, math.sqrt(size))
