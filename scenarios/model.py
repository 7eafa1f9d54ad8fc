"""The data model of a scene: bricks, timed actions, and the outcome that theory demands.

Units are SI, z is up, quaternions are (w, x, y, z). The model does not depend on an engine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from scenarios.shapes import Shape

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


CLEARANCE = 0.5e-3
"""Gap [m] between a released brick and its actual support. Heights are relative to the actual support, because with
planned absolute heights the drops would grow as the stack sinks."""


@dataclass(frozen=True, slots=True)
class World:
    """Gravity, fixed bodies and default coefficients of a scene. The ground's upper face is z = 0."""

    friction: float = 0.45
    """Coulomb coefficient of the ground, and of every brick and fixed body without its own. A pair has the geometric
    mean of both coefficients."""
    gravity: Vector = (0.0, 0.0, -9.81)
    """Gravitational acceleration [m/s2]."""
    fixed: tuple[Brick, ...] = ()
    """Bodies that never move: walls, tables, ceilings. They may touch each other and the ground; their mass and level
    have no effect. In contacts, they count as part of the ground."""
    restitution: float = 0.0
    """Coefficient of restitution of the ground, and of every brick and fixed body without its own. A pair has the
    geometric mean of both coefficients."""


@dataclass(frozen=True, slots=True)
class Brick:
    """A rigid convex body in its planned pose: by default a homogeneous box.

    ``scenarios.solids`` makes bricks of other shapes.
    """

    size: Vector
    """Edge lengths [m], along the brick's own x, y and z, of the smallest box that holds the brick."""
    mass: float
    """Mass [kg]."""
    position: Vector
    """Centre of mass [m]. Its height is only planned: see ``Place``."""
    quaternion: Quaternion = UPRIGHT
    level: int = 1
    """Level of the brick in the stack; the lowest level is 1."""
    moved: bool = False
    """True for a body that only the host moves: a lift, a belt, a door. The body carries bricks. It must not touch the
    ground, fixed bodies or other moved bodies. Its mass has no effect."""
    shape: Shape = "box"
    """Shape, in the brick's own frame: see ``scenarios.shapes``."""
    friction: float | None = None
    """Coulomb coefficient; None for the world's."""
    restitution: float | None = None
    """Coefficient of restitution; None for the world's."""
    moments: Vector | None = None
    """Moments of inertia [kg m2] about the brick's own axes; None for a homogeneous brick."""


@dataclass(frozen=True, slots=True)
class Place:
    """Action that releases bricks together, as one rigid group, at a given height above their actual support.

    The group keeps its planned x, y, orientation and relative heights. The harness shifts the group along z until the
    least gap between the group and the actual bodies below is ``height`` [m].
    """

    time: float
    """Start of the action [s], from the start of the trial."""
    bricks: tuple[Brick, ...]
    height: float = CLEARANCE
    """Release height [m] above the actual support. With 0, the group is a prebuilt stack, which may have several
    levels: the harness places the group without a gap, and a stability extension judges the stack before the next
    engine step."""


@dataclass(frozen=True, slots=True)
class Remove:
    """Action that takes a brick out of the world."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""


@dataclass(frozen=True, slots=True)
class Push:
    """Action that strikes a brick at its centre of mass."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    impulse: Vector
    """Impulse [N s]."""


@dataclass(frozen=True, slots=True)
class Pull:
    """Action that pulls a brick sideways at its centre of mass with a given velocity, then removes the brick.

    The force is as large as the velocity requires. Monitors count the brick as intact at any position, because the
    manipulator holds the brick from the start of the action.
    """

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    velocity: tuple[float, float]
    """Velocity in x and y [m/s]."""
    seconds: float
    """Duration [s]."""
    is_carried: bool = False
    """True if the manipulator also carries the brick's weight, so that the brick does not tip."""

    @property
    def until(self) -> float:
        """Return the end of the action [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Press:
    """Action that presses on a brick at its centre of mass with a steady force, then releases the brick."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0."""
    force: Vector
    """Force [N]."""
    seconds: float
    """Duration [s]."""

    @property
    def until(self) -> float:
        """Return the end of the action [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Tilt:
    """Action that turns gravity about a horizontal axis, as if the ground tilted.

    Every frame turns gravity by one step. After ``seconds`` [s] gravity has turned by ``speed`` [deg/s] times
    ``seconds``.
    """

    time: float
    axis: tuple[float, float]
    """Direction of the axis in x and y, by the right-hand rule for the tilted ground: about (0, 1) the +x end of the
    ground goes down, and gravity turns from -z towards +x."""
    speed: float
    """Angular speed [deg/s]."""
    seconds: float
    """Duration [s]."""

    @property
    def until(self) -> float:
        """Return the end of the action [s], from the start of the trial."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class Drive:
    """Action that accelerates a moved brick to a velocity; the brick keeps this velocity until the next ``Drive``."""

    time: float
    brick: int
    """The brick's index in the order of placement, from 0; the brick's ``moved`` must be True."""
    velocity: Vector
    """Velocity of the brick's centre [m/s]."""
    spin: Vector = (0.0, 0.0, 0.0)
    """Angular velocity [rad/s]."""
    seconds: float = 0.0
    """Duration [s] of the acceleration, which is uniform and begins at the present velocities. With 0, the velocities
    change at once."""
    carries: bool = False
    """True if monitors expect bricks of higher levels to travel with the moved brick; False if monitors expect bricks
    of higher levels to stay in place."""

    @property
    def until(self) -> float:
        """Return the time [s], from the start of the trial, at which the brick has reached the velocity."""
        return self.time + self.seconds


@dataclass(frozen=True, slots=True)
class MustMove:
    """A brick's motion that theory demands: from a given time until the brick's centre has moved a given distance."""

    brick: int
    """The brick's index in the order of placement, from 0."""
    from_s: float
    """Start of the motion [s]."""
    way_m: float
    """Straight-line distance [m] that the brick's centre must move."""
    takes_s: float | None
    """Duration [s] of the motion by theory; None if theory gives no duration."""


Action: TypeAlias = Place | Remove | Push | Pull | Press | Tilt | Drive


@dataclass(frozen=True, slots=True)
class Expectation:
    """The outcome that theory demands."""

    outcome: Literal["stand", "fall", "study"]
    theory: str
    """Reason of the outcome, in one line, with its source."""
    level: int | None = None
    """Level at which the scene must fall; None unless ``outcome`` is "fall"."""
    not_before_s: float = 0.0
    """Earliest time [s] of the fall, because a scene must stand until the removal of a brick."""
    within_s: float | None = None
    """Time [s] after ``not_before_s`` within which the scene must fall; a later fall counts as standing. None for no
    limit."""

    def __str__(self) -> str:
        if self.outcome != "fall":
            return {"stand": "stands", "study": "study"}[self.outcome]
        return f"falls at {self.level}" + (f" after {self.not_before_s:g} s" if self.not_before_s else "")


@dataclass(frozen=True, slots=True)
class Scene:
    """A variant of a scenario: world, actions and expectation."""

    scenario: str
    """Registry name, such as ``four_stack``."""
    variant: str
    """Id of this variant, different for every choice of the parameters, such as ``card_house-2``."""
    parameters: Mapping[str, float | int | str]
    world: World
    actions: tuple[Action, ...]
    """Timed actions, in order of time."""
    expectation: Expectation
    look_for: str
    """Behaviour that an observer should look for."""
    pair: str = ""
    """Id shared by a scene that must stand and its partner that must fall, which differ only in the deciding quantity.
    Only both scenes together distinguish a stability test from a rule that freezes everything. Empty without a
    partner."""
    planar: bool = False
    """True if every brick stays in the x-z plane, so that a planar engine can play the scene."""
    poured: bool = False
    """True for a pile: no brick has a planned place, and the harness measures the pile as a whole."""
    watch_s: float = 5.0
    """Time [s] for which the trial continues after the last action."""
    must_move: tuple[MustMove, ...] = ()
    """Bricks that must not sleep. The harness measures the time for which these bricks sleep."""
    size: float = 1.0
    """Factor by which ``scenarios.scenes.shared.transforms`` enlarged the scene. Placement noise grows by this factor
    too."""
    bricks: tuple[Brick, ...] = field(init=False)
    """All bricks in the order of placement."""
    levels: int = field(init=False)
    """Highest level of all bricks."""

    def __post_init__(self) -> None:
        placed = tuple(brick for action in self.actions if isinstance(action, Place) for brick in action.bricks)
        object.__setattr__(self, "bricks", placed)
        object.__setattr__(self, "levels", max(brick.level for brick in placed))

    @property
    def pace(self) -> float:
        """Return the factor on all times: see ``pace_of``."""
        return pace_of(self.size)

    @property
    def done_s(self) -> float:
        """Return the time [s] at which the last action ends."""
        return max(
            action.until if isinstance(action, Pull | Press | Tilt | Drive) else action.time for action in self.actions
        )


def pace_of(size: float) -> float:
    """Return the factor on all times of a scene with ``size`` times the lengths.

    A fall takes sqrt(``size``) times as long, because gravity stays the same. The factor is at least 1, because an
    engine's frames do not become shorter for small bricks.
    """
    return max(1.0, math.sqrt(size))
