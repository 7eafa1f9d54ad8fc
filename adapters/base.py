"""What the harness drives: ``Simulation``, and the few lines that every adapter shares.

An adapter fills in the hooks (``_spawn``, ``_step``, ``_contacts`` ...); the public methods around
them check their input once for all engines, so that an engine never sees a NaN or an unknown id.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal, Self

import numpy as np

from adapters.approaching import HORIZON
from adapters.box_table import BoxTable, joined, prepare
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses

GROUND_HALF_EDGES = (2.0, 2.0, 0.5)
"""Half the least edges [m] of engines' grounds: room for any scene of planks, and too thick to fall through."""
PLANK_SIZE = math.hypot(117.0e-3, 23.4e-3, 7.8e-3)
"""Diagonal [m] of the plank for which the profiles' lengths were chosen."""
SMALL = 0.25
"""Size of the largest brick over a plank's up to which a profile's lengths shrink with the bricks; larger bricks keep
those of a plank."""
REACH_OF_SMALL = 0.5
"""Lengths for small bricks over those in proportion. PhysX, which looks for contacts from twice 1 mm on, held planks of
0.78 mm that nothing carried between neighbours 0.2 mm apart; with half of the reach they fall. Found by trial, not
derived: a ``contact_offset`` of 0.105 mm held such a plank, 0.09 mm let it fall."""
DEEPEST_REST = 1e-3
"""Overlap [m] with a moved body in which a brick may have come to rest: engines leave up to 0.4 mm."""
GROUND_ROOM = 2.0
"""How many times as far as the farthest brick that is expected the ground reaches: room to fall."""

NO_FORCE: Vector = (0.0, 0.0, 0.0)
NO_VELOCITY: Vector = (0.0, 0.0, 0.0)
NO_CONTACTS, NOWHERE = Contacts.empty(), np.empty((0, 3))
"""What there is to read while nothing is live, which is most of the time: no engine is asked for it."""

Sleeping = Literal["off", "native", "raised"]


@dataclass(frozen=True, slots=True)
class Knob:
    """One engine setting that differs from how the engine is shipped, and why."""

    value: float | int | str | bool
    reason: str
    follows_world: bool = False
    """True for a length that was chosen for the size of the bricks: in a scaled world it grows with them, and where all
    bricks are small (``SMALL``) it shrinks."""


@dataclass(frozen=True, slots=True)
class Profile:
    """How an engine is set up: ``default`` as shipped, ``game`` cheap, ``tuned`` the best an expert gets."""

    name: str
    description: str
    substeps: int
    """Engine steps per frame."""
    frame_s: float = 1 / 60
    """Length of a frame [s]."""
    knobs: Mapping[str, Knob] = field(default_factory=dict)
    tuned_by: str = "as shipped"
    scale: float = 1.0
    """Lengths in the engine's world over those of the scene: see ``adapters.scaled``."""
    forces: bool = True
    """False to report no contact forces (``Contacts.force`` is None), whether or not the engine tells them."""


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What an engine's API gives to the core; the capability table is made from these."""

    contact_points: str
    """What is reported for one pair, such as "up to 4 points"."""
    near_contacts: bool
    """True if points are listed that nearly touch; for other engines the port adds them from the boxes' geometry."""
    separation: bool
    relative_velocity: str
    """"reported", or how the adapter gets it, such as "from the velocities before the step"."""
    forces: str
    """What of a contact's force is reported: "normal and friction"; "no"; or where friction comes from."""
    freeze: str
    """How the adapter freezes a body exactly."""
    frozen_contacts: bool
    """True if contacts between two frozen bodies stay listed by the engine."""
    friction_law: str
    moved: str
    """How the adapter moves a body at a prescribed velocity, so that friction carries what lies on it."""
    deterministic: str
    """"across processes", "within a process" or "no"."""
    planar: bool = False
    """True for a 2-D engine: it plays planar scenes only."""


@dataclass(frozen=True, slots=True)
class EngineInfo:
    """Which engine this is, recorded with every trial."""

    engine: str
    version: str
    profile: Profile
    sleeping: Sleeping
    unit_scale: float = 1.0

    @property
    def frame_s(self) -> float:
        """Length of a frame [s]."""
        return self.profile.frame_s


class EnginePort:
    """The core's whole view of a simulation: contacts, masses, sleep, wake."""

    __slots__ = ("_simulation",)

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def contacts(self) -> Contacts:
        """Every contact that touches a live body after the latest step, or ``find_contacts`` since."""
        return self._simulation._whole_contacts()

    def masses(self) -> Masses:
        """The live bodies after the latest step, and the ids removed since the last call."""
        return self._simulation._masses()

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies exactly where they are; freezing a frozen body does nothing."""
        self._simulation._sleep(bodies)

    def wake(self, bodies: Sequence[int]) -> None:
        """Let frozen bodies move again, from rest; waking a live body does nothing."""
        self._simulation._wake(bodies)


class Simulation(ABC):
    """One world of one engine. Positions [m] and quaternions (w, x, y, z) are those of centres of mass."""

    engine: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    profiles: ClassVar[Mapping[str, Profile]]
    iterations: ClassVar[str]
    """Name of the knob that says how often the solver iterates, at most, in a step."""

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        """Open an empty world with its ground and its fixed boxes.

        Args:
            profile: one of ``profiles``.
            world: friction, gravity and fixed boxes.
            sleeping: the engine's own sleeping: off, as shipped, or with its threshold raised.
            expected: the bricks that will be spawned, for engines that must allocate beforehand;
                others may ignore it, and a brick that was not expected must still be accepted.
        """
        for box in world.fixed:
            _check_box(box)
        self.world = world
        self.expected = tuple(expected)
        self._unfitted = profile
        profile = _fitted(profile, expected)
        self.info = EngineInfo(self.engine, self._version(), profile, sleeping)
        self.bricks: dict[int, Brick] = {}
        self.frozen: set[int] = set()
        self._live: dict[int, float] = {}  # mass [kg] of every live body, in the order of ids
        self._live_rows: tuple[IntArray, FloatArray] | None = None  # the same, once asked for
        self._removed: list[int] = []
        self._moved: dict[int, tuple[Vector, Vector]] = {}  # velocity [m/s] and spin [rad/s] of bodies the host moves
        self._steady: dict[int, Vector] = {}  # force [N] on each body that something presses
        self._next_id = 0
        self._boxes = BoxTable(world.fixed)
        self._found: Contacts | None = None  # by find_contacts, until the next step
        self._port: EnginePort | None = None

    # -- driven by the harness ---------------------------------------------------------------------

    @property
    def port(self) -> EnginePort:
        """The core's view. An engine that is never asked for it need not record what only the core reads."""
        if self._port is None:
            self._port = EnginePort(self)
            prepare()
        return self._port

    @property
    def scale(self) -> float:
        """What an adapter's own lengths [m] must be multiplied by, such as its ground's: the profile's scale."""
        return self.info.profile.scale

    @property
    def ground_half_edges(self) -> Vector:
        """Half the ground's edges, in the engine's world; larger scenes get a larger ground."""
        x, y, z = GROUND_HALF_EDGES
        reach = GROUND_ROOM * max((_reach(brick) for brick in (*self.expected, *self.world.fixed)), default=0.0)
        return max(x * self.scale, reach), max(y * self.scale, reach), z * self.scale

    @property
    def is_observed(self) -> bool:
        """True once the port has been handed out: contact velocities must then be recorded."""
        return self._port is not None

    @property
    def reads_forces(self) -> bool:
        """True if contact forces must be recorded: the port has been handed out, and the profile asks for them."""
        return self.is_observed and self.info.profile.forces

    def spawn(self, brick: Brick) -> int:
        """Put a brick at rest into the world, live or moved by the host; returns its id.

        Raises:
            ValueError: if size or mass is not positive and finite, or the pose is not finite.
        """
        if not (math.isfinite(brick.mass) and brick.mass > 0):
            raise ValueError(f"brick mass must be positive and finite, got {brick.mass} kg")
        _check_box(brick)
        body, self._next_id = self._next_id, self._next_id + 1
        if brick.moved:
            self._spawn_moved(body, brick)
            self._moved[body] = NO_VELOCITY, NO_VELOCITY
        else:
            self._spawn(body, brick)
            self._live[body] = brick.mass
        self._boxes.add(body, brick.size)
        self.bricks[body] = brick
        self._live_rows = None
        return body

    def remove(self, body: int) -> None:
        """Take a body out of the world.

        Raises:
            KeyError: if there is no such body.
        """
        self._check_known((body,))
        if self._steady.pop(body, None):
            self._press(body, NO_FORCE)
        self._remove(body)
        self._boxes.remove(body)
        del self.bricks[body]
        self.frozen.discard(body)
        self._live.pop(body, None)
        self._moved.pop(body, None)
        self._live_rows = None
        self._removed.append(body)

    def push(self, body: int, impulse: Vector) -> None:
        """Strike a body at its centre of mass with an impulse [N s]; a frozen or moved body feels nothing.

        Raises:
            KeyError: if there is no such body.
            ValueError: if the impulse is not finite.
        """
        self._check_known((body,))
        if not np.isfinite(impulse).all():
            raise ValueError(f"impulse must be finite, got {impulse} N s")
        if body in self._live:
            self._push(body, impulse)

    def apply_force(self, body: int, force: Vector) -> None:
        """Press on a body's centre of mass with a steady force [N], in every step until it is set to zero.

        A frozen or moved body feels nothing; once a frozen one is woken the force acts on it.

        Raises:
            KeyError: if there is no such body.
            ValueError: if the force is not finite, or leaves the plane of a planar engine.
        """
        self._check_known((body,))
        if not np.isfinite(force).all():
            raise ValueError(f"force must be finite, got {force} N")
        if self.capabilities.planar and force[1] != 0.0:
            raise ValueError(f"{self.engine} is planar: a force must lie in the x-z plane, got {force} N")
        if any(force):
            self._steady[body] = force
        elif self._steady.pop(body, None):
            self._press(body, NO_FORCE)

    def drive(self, body: int, linear: Vector, angular: Vector = (0.0, 0.0, 0.0)) -> None:
        """Move a body of the host's at this velocity [m/s] and spin [rad/s], in every step until it is driven anew.

        Raises:
            KeyError: if there is no such body, or it was not spawned with ``Brick.moved``.
            ValueError: if the velocities are not finite, or leave the plane of a planar engine.
        """
        if body not in self._moved:
            raise KeyError(f"body {body} is not moved by the host: spawn it as Brick(..., moved=True)")
        if not (np.isfinite(linear).all() and np.isfinite(angular).all()):
            raise ValueError(f"velocities must be finite, got {linear} m/s and {angular} rad/s")
        if self.capabilities.planar and (linear[1] or angular[0] or angular[2]):
            raise ValueError(
                f"{self.engine} is planar: drive bodies in the x-z plane, got {linear} m/s, {angular} rad/s"
            )
        self._moved[body] = linear, angular

    def set_gravity(self, gravity: Vector) -> None:
        """Change gravity [m/s2] for all following steps, on live bodies and on those that are woken later.

        Raises:
            ValueError: if it is not finite, or leaves the plane of a planar engine.
        """
        if not np.isfinite(gravity).all():
            raise ValueError(f"gravity must be finite, got {gravity} m/s2")
        self._set_gravity(gravity)
        self.world = replace(self.world, gravity=gravity)

    def move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set a body's pose and stop it.

        Raises:
            KeyError: if there is no such body.
            ValueError: if the pose is not finite.
        """
        self._check_known((body,))
        _check_pose(position, quaternion)
        self._move(body, position, quaternion)
        if self._found is not None:
            self._found = self._found.chosen((self._found.body_a != body) & (self._found.body_b != body))
        if body in self.frozen:
            self._note_boxes([body])

    def step(self, seconds: float) -> None:
        """Advance the world by one frame of ``seconds``, in the profile's substeps."""
        self._found = None
        self._step(seconds)

    def find_contacts(self) -> None:
        """Detect the contacts of the present poses without moving anything.

        A host calls it before the first step, so that the extension judges stacks that start in place. Until the next
        step ``port.contacts()`` returns the contacts that this call found:

        - Pairs whose faces or parallel edges touch within 0.1 mm (planks; other bricks in proportion) have the corners
          of their contact area, from the bricks' geometry (``BoxTable.with_exact_faces``), because engines miss gaps of
          exactly zero, or list normals there that are rounding.
        - Deeper overlaps and edges that cross are those that the engine finds at the present poses.
        - Separations are measured at the present poses; relative velocities are those that the bodies have now. There
          are no forces, because no step has solved these contacts.
        - Bodies that are frozen, removed or moved afterwards drop out. Bodies that are spawned or woken afterwards, and
          the moved ones, have no contacts until the next step or call.

        No pose and no velocity changes by a bit, and the simulation goes on as if it had never been asked, unless the
        docstring of the adapter says what changes.
        """
        self._found = None
        if not self._live:
            return
        found = self._find_contacts()
        self._note_boxes(self.bricks)
        whole = self._with_exact_faces(found)
        velocity = self._velocities_at(whole.body_b, whole.point) - self._velocities_at(whole.body_a, whole.point)
        self._found = replace(whole, relative_velocity=velocity, force=None)

    def poses(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """All bodies, frozen ones too, by rising id: ids (n,), positions (n, 3) [m], quaternions (n, 4)."""
        bodies = np.fromiter(self.bricks, np.int64, len(self.bricks))
        return bodies, *self._poses(bodies)

    def velocities(self) -> tuple[FloatArray, FloatArray]:
        """Linear (n, 3) [m/s] and angular (n, 3) [rad/s] velocities, in the order of ``poses``."""
        return self._velocities(np.fromiter(self.bricks, np.int64, len(self.bricks)))

    def close(self) -> None:
        """Free the engine's memory; the simulation cannot be used afterwards."""
        self._close()

    # -- driven by the core, through the port ------------------------------------------------------

    def _whole_contacts(self) -> Contacts:
        driven = self._driven()
        if not self._live and not driven:
            return NO_CONTACTS
        if self._found is not None:
            return self._without_fixed_ids(self._of_live(self._found))
        contacts = self._contacts() if self._live else NO_CONTACTS
        if self._live and not self.capabilities.near_contacts:
            contacts = self._completed(contacts, self._note_boxes(self._live))
        if driven:
            contacts = self._with_driven(contacts, driven)
        return self._without_fixed_ids(self._with_approaching(contacts))

    def _driven(self) -> list[int]:
        """Return the bodies that the host moves now, rising."""
        return sorted(body for body, (linear, angular) in self._moved.items() if any(linear) or any(angular))

    def _with_driven(self, contacts: Contacts, driven: list[int]) -> Contacts:
        """Add the contacts of ``driven`` bodies with frozen ones, which no engine lists: nothing moves either of them.

        Points, normals and separations are those of the boxes where they are now, as far apart as they come within a
        frame.
        """
        rows = self._note_boxes(driven)
        linear, angular = self._velocities_now(rows)
        reach = np.array([math.hypot(*self.bricks[body].size) / 2 for body in driven])
        speed = np.linalg.norm(linear, axis=1) + reach * np.linalg.norm(angular, axis=1)
        way = float(speed.max()) * self.info.frame_s
        deep = way + DEEPEST_REST
        found = self._boxes.with_near_pairs(NO_CONTACTS, rows, self.world.friction, self._velocities_at, deep)
        is_with_frozen = [
            (a in self.frozen or b in self.frozen) and separation <= way
            for a, b, separation in zip(
                found.body_a.tolist(), found.body_b.tolist(), found.separation.tolist(), strict=True
            )
        ]
        return joined(contacts, found.chosen(np.array(is_with_frozen, np.bool_)))

    def _with_exact_faces(self, contacts: Contacts) -> Contacts:
        """Replace contacts of pairs that nearly touch by those of their geometry."""
        return self._boxes.with_exact_faces(contacts, self._live_bodies()[0], self.world.friction)

    def _completed(self, contacts: Contacts, live: IntArray) -> Contacts:
        """Add the corners and the pairs that nearly touch and that the engine did not list."""
        if self._moved:
            self._note_boxes(self._moved)
        whole = self._boxes.with_missing_corners(contacts)
        return self._boxes.with_near_pairs(whole, live, self.world.friction, self._velocities_at)

    def _with_approaching(self, contacts: Contacts) -> Contacts:
        """Add the pairs of bodies that will meet within the next frames, if any body is fast."""
        movers = self._moving_bodies()
        velocity, _ = self._velocities_now(movers)
        if not self._boxes.are_fast(movers, velocity):
            return contacts
        self._note_boxes(movers.tolist())
        seconds = HORIZON * self.info.frame_s
        live, _ = self._live_bodies()
        return self._boxes.with_approaching(contacts, live, movers, velocity, seconds, self.world.friction)

    def _of_live(self, contacts: Contacts) -> Contacts:
        """Return the contacts that touch a live body and no removed one."""
        live, there = self._live, self.bricks
        kept = [
            (a in live or b in live) and (a in there or a <= GROUND) and (b in there or b <= GROUND)
            for a, b in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
        ]
        return contacts if all(kept) else contacts.chosen(np.array(kept, np.bool_))

    def _without_fixed_ids(self, contacts: Contacts) -> Contacts:
        """Replace the ids of fixed boxes, which the core does not know, by ``GROUND``."""
        if not self.world.fixed:
            return contacts
        body_a, body_b = np.maximum(contacts.body_a, GROUND), np.maximum(contacts.body_b, GROUND)
        return replace(contacts, body_a=body_a, body_b=body_b)

    def _note_boxes(self, bodies: Collection[int]) -> IntArray:
        """Tell the table of boxes where ``bodies`` are now; returns them, shape (k,)."""
        rows = np.fromiter(bodies, np.int64, len(bodies))
        self._boxes.place(rows, *self._poses(rows))
        return rows

    def _live_bodies(self) -> tuple[IntArray, FloatArray]:
        """Ids (m,), rising, and masses (m,) [kg] of the live bodies: the same arrays until another body is live."""
        if self._live_rows is None:
            count = len(self._live)
            self._live_rows = (
                np.fromiter(self._live, np.int64, count),
                np.fromiter(self._live.values(), np.float64, count),
            )
        return self._live_rows

    def _velocities_at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        """Velocities (k, 3) [m/s] that bodies (k,) have at points (k, 3) [m]; the ground and frozen ones have none."""
        found = np.zeros(points.shape)
        rows = np.flatnonzero([body in self._live or body in self._moved for body in bodies.tolist()])
        linear, angular = self._velocities_now(bodies[rows])
        found[rows] = linear + np.cross(angular, points[rows] - self._positions(bodies[rows]))
        return found

    def _velocities_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return linear and angular velocities (k, 3) of bodies (k,); of moved ones those at which they are driven."""
        linear, angular = self._velocities(bodies)
        if self._moved:
            for row, body in enumerate(bodies.tolist()):
                if body in self._moved:
                    linear[row], angular[row] = self._moved[body]
        return linear, angular

    def _borne_forces(self, bodies: IntArray, before: FloatArray, seconds: float) -> tuple[IntArray, FloatArray]:
        """Return the live ones of ``bodies`` (k,), and the sum of contact forces [N] on each over a step, by momentum.

        Args:
            bodies: rising ids, shape (k,).
            before: their velocities [m/s] at the start of the step, shape (k, 3).
            seconds: length of the step.
        """
        rows = np.flatnonzero([body in self._live for body in bodies.tolist()])
        live = bodies[rows]
        mass = np.array([self._live[body] for body in live.tolist()])[:, None]
        steady = np.array([self._steady.get(body, NO_FORCE) for body in live.tolist()]).reshape(-1, 3)
        gained = (self._velocities(live)[0] - before[rows]) / seconds
        return live, mass * (gained - np.array(self.world.gravity)) - steady

    def _act_on_bodies(self, seconds: float) -> None:
        """Let steady forces act, and driven bodies move, in the engine's next substep; adapters call it before each.

        Args:
            seconds: length of the substep.
        """
        for body, (linear, angular) in self._moved.items():
            self._drive(body, linear, angular, seconds)
        for body, force in self._steady.items():
            if body in self._live:
                self._press(body, force)

    def _moving_bodies(self) -> IntArray:
        """Return the ids (k,), rising, of the bodies that may move: live ones and those of the host."""
        bodies, _ = self._live_bodies()
        return np.union1d(bodies, np.fromiter(self._moved, np.int64, len(self._moved))) if self._moved else bodies

    def _masses(self) -> Masses:
        bodies, mass = self._live_bodies()
        removed, self._removed = self._removed, []
        if self._moved:
            live, bodies = bodies, self._moving_bodies()
            mass = np.full(len(bodies), np.inf)
            mass[np.isin(bodies, live)] = self._live_bodies()[1]
        return Masses(bodies, mass, self._positions(bodies) if len(bodies) else NOWHERE, removed)

    def _sleep(self, bodies: Sequence[int]) -> None:
        self._check_known(bodies)
        for body in bodies:
            if body in self._live:
                if body in self._steady:
                    self._press(body, NO_FORCE)
                self._freeze(body)
                self.frozen.add(body)
                del self._live[body]
        self._live_rows = None
        self._note_boxes(bodies)

    def _wake(self, bodies: Sequence[int]) -> None:
        self._check_known(bodies)
        for body in bodies:
            if body in self.frozen:
                self._thaw(body)
                self.frozen.remove(body)
                self._live[body] = self.bricks[body].mass
        self._live = dict(sorted(self._live.items()))
        self._live_rows = None

    def _twin(self) -> Self:
        """Open a second, weightless world of the engine: the same bodies under the same ids, where they are now.

        Live bodies are at rest there. For engines that detect contacts only as they step, or that remember having been
        asked; the caller closes it.
        """
        twin = type(self)(self._unfitted, replace(self.world, gravity=(0.0, 0.0, 0.0)), "off", self.expected)
        positions, quaternions = self._poses(np.fromiter(self.bricks, np.int64, len(self.bricks)))
        places = zip(self.bricks.items(), positions.tolist(), quaternions.tolist(), strict=True)
        for (body, brick), (x, y, z), (w, i, j, k) in places:
            twin.bricks[body] = replace(brick, position=(x, y, z), quaternion=(w, i, j, k))
            if body in self._moved:
                twin._spawn_moved(body, twin.bricks[body])
            else:
                twin._spawn(body, twin.bricks[body])
            if body in self.frozen:
                twin._freeze(body)
        twin.frozen, twin._live = set(self.frozen), dict(self._live)
        return twin

    def _check_known(self, bodies: Iterable[int]) -> None:
        unknown = [body for body in bodies if body not in self.bricks]
        if unknown:
            raise KeyError(f"unknown body {', '.join(map(str, unknown))}: it was never spawned, or was removed")

    # -- what an adapter fills in ------------------------------------------------------------------

    @staticmethod
    @abstractmethod
    def _version() -> str:
        """The engine's version."""

    @abstractmethod
    def _spawn(self, body: int, brick: Brick) -> None: ...

    @abstractmethod
    def _spawn_moved(self, body: int, brick: Brick) -> None:
        """Put in a body that only ``_drive`` moves."""

    @abstractmethod
    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        """Move a body of the host's at these velocities [m/s, rad/s] in the next substep of ``seconds``."""

    @abstractmethod
    def _remove(self, body: int) -> None: ...

    @abstractmethod
    def _push(self, body: int, impulse: Vector) -> None: ...

    @abstractmethod
    def _press(self, body: int, force: Vector) -> None:
        """Let a force [N] act at a body's centre of mass in the next substep.

        It is called before each substep while the force is not zero, and once with zero when it ends.
        """

    @abstractmethod
    def _set_gravity(self, gravity: Vector) -> None: ...

    @abstractmethod
    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None: ...

    @abstractmethod
    def _step(self, seconds: float) -> None: ...

    @abstractmethod
    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]: ...

    def _positions(self, bodies: IntArray) -> FloatArray:
        """Centres of mass alone; overridden where they cost less than whole poses."""
        return self._poses(bodies)[0]

    @abstractmethod
    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]: ...

    @abstractmethod
    def _contacts(self) -> Contacts:
        """Return every contact that touches a live body; fixed boxes go by ``box_table.fixed_id``."""

    @abstractmethod
    def _find_contacts(self) -> Contacts:
        """Return the contacts that the engine finds at the present poses; the simulation must not notice.

        Relative velocities are filled in by ``find_contacts``; contacts between two frozen bodies may be listed.
        """

    @abstractmethod
    def _freeze(self, body: int) -> None: ...

    @abstractmethod
    def _thaw(self, body: int) -> None: ...

    @abstractmethod
    def _close(self) -> None: ...


def _fitted(profile: Profile, expected: Sequence[Brick]) -> Profile:
    """Return the profile with the lengths that suit small bricks, if all that are expected are small."""
    plank = PLANK_SIZE * profile.scale
    size = max((math.hypot(*brick.size) for brick in expected), default=plank) / plank
    if size > SMALL:
        return profile
    knobs = {
        name: replace(knob, value=float(knob.value) * REACH_OF_SMALL * size) if knob.follows_world else knob
        for name, knob in profile.knobs.items()
    }
    return replace(profile, knobs=knobs)


def _check_box(brick: Brick) -> None:
    if not all(math.isfinite(edge) and edge > 0 for edge in brick.size):
        raise ValueError(f"brick size must be three positive lengths, got {brick.size} m")
    _check_pose(brick.position, brick.quaternion)


def _check_pose(position: Vector, quaternion: Quaternion) -> None:
    if not np.isfinite(position).all():
        raise ValueError(f"position must be finite, got {position} m")
    if not abs(np.linalg.norm(quaternion) - 1) < 1e-6:  # written so that NaN fails too
        raise ValueError(f"quaternion (w, x, y, z) must be of unit length, got {quaternion}")


def _reach(brick: Brick) -> float:
    """How far [m] from the z axis a brick may lie, however it is turned."""
    x, y, _ = brick.position
    return math.hypot(x, y) + math.hypot(*brick.size) / 2
