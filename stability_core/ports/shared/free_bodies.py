"""``FreeBodies``: the live bodies, the frozen bodies and the obstacles of a user's world."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.ports.shared.body_motions import COLUMNS, POSE
from stability_core.ports.shared.free_body_world import FreeBodyWorld
from stability_core.ports.shared.shapes import ShapeTable

LOOK_S = 0.1
"""Time [s] between two looks at the places of frozen and of static bodies. The port lists the bodies of a world with
the same delay if ``FreeBodyWorld.can_read`` allows the delay. Reason: a list of a hundred bodies costs half as much as
the engine's step of frozen bodies."""
AT_A_LOOK = 5
"""Greatest number of frozen bodies whose places the port checks at a look, because some engines read body by body."""
BESIDE = 1e-3
"""Greatest gap [m] between the box around a kinematic body and the box around a frozen body beside this body."""


class FreeBodies:
    """Record of the bodies of a world: live, frozen, or obstacles that the port does not control."""

    def __init__(self, world: FreeBodyWorld, *, takes_all: bool) -> None:
        self._world, self._takes_all = world, takes_all
        self.live: dict[int, float] = {}
        """Mass [kg] of each live body."""
        self.frozen: dict[int, float] = {}
        """Mass [kg] of each frozen body."""
        self.obstacles: set[int] = set()
        """Uncontrolled bodies, except half spaces, that have touched a controlled body."""
        self.movers: set[int] = set()
        """Bodies that move by forces, outside the control of the port. These bodies collide with frozen bodies."""
        self.moved: list[int] = []
        """Frozen bodies that the host had moved, among the bodies that a look in this frame checked."""
        self.has_looked = True
        """True in the frames of looks."""
        self.has_new_obstacle = False
        """True if ``sides`` has noted an obstacle since the latest read of the motions."""
        self.kinematic: list[int] = []
        """Uncontrolled bodies that the host moves."""
        self.shapes = ShapeTable()
        self._present: set[int] = set()
        self._planes: set[int] = set()
        self._kinematic_rows: FloatArray = np.empty((0, COLUMNS))
        self._removed: list[int] = []
        self._frozen_poses: dict[int, FloatArray] = {}
        self._boxes: tuple[list[int], FloatArray] | None = None
        self._unchecked: list[int] = []  # live bodies
        self._unseen: list[int] = []  # frozen bodies
        self._look_s = np.inf  # time since the latest look

    # -- bodies that come and go ----------------------------------------------------------------------

    def look(self, dt: float) -> list[int]:
        """Follow the world through a frame of ``dt`` [s]; in the frame of a look, check the places of frozen bodies.

        A frame with ``dt`` = 0, or ``LOOK_S`` after the latest look, has a look.

        Returns:
            A list with the next live body, in turn, if this body can no longer freeze, for example because of a new
            joint; otherwise an empty list.
        """
        self._look_s += dt
        self.has_looked = self._look_s >= LOOK_S or dt == 0.0
        self.moved = []
        if self.has_looked or not self._world.can_read([*self.live, *self.movers, *self.obstacles, *self.kinematic]):
            self.follow()
        if self.has_looked:
            self._look_s = 0.0
            self._find_moved()
            if not self.live:
                self._world.rest()
        return self._check_next()

    def follow(self) -> None:
        """Control new free bodies, if the port controls all bodies; forget bodies that left the world."""
        if not self._world.has_changed():
            return
        present = set(self._world.bodies())
        gone, new = self._present - present, present - self._present
        self._present = present
        for body in gone:
            self._forget(body)
        if self._takes_all:
            for body in sorted(new):
                if self._world.reason_against(body) is None:
                    self._control(body)
        self._sort_others()

    def add(self, bodies: Iterable[int]) -> None:
        """Control free bodies.

        Raises:
            ValueError: for a body that does not exist, cannot freeze, or is under control already.
        """
        self.follow()
        for body in bodies:
            if body not in self._present:
                raise ValueError(
                    f"this {self._world.engine} world has no body {body!r}: pass {self._world.ids_from} of a body in "
                    f"the world; the world has the bodies {sorted(self._present)}"
                )
            if body in self.live or body in self.frozen:
                raise ValueError(f"the port controls body {body} already: list each body once, in attach() or in add()")
            reason = self._world.reason_against(body)
            if reason:
                raise ValueError(f"body {body} {reason}")
            self._control(body)
        self._sort_others()

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling live bodies; skip unknown bodies."""
        for body in bodies:
            self._forget(body)
        self._sort_others()

    def take_removed(self) -> list[int]:
        """Return the ids of bodies that left the world or the port's control since the previous call."""
        removed, self._removed = self._removed, []
        return removed

    # -- live and frozen ------------------------------------------------------------------------------

    def freeze(self, body: int) -> None:
        """Freeze a live body."""
        self.frozen[body] = self.live.pop(body)
        self._world.freeze(body)
        self._frozen_poses[body] = self._world.motions([body])[0, POSE]
        self._boxes = None

    def unfreeze(self, body: int) -> None:
        """Make a frozen body live."""
        self.live[body] = self.frozen.pop(body)
        del self._frozen_poses[body]
        self._boxes = None
        self._world.unfreeze(body)

    # -- obstacles ------------------------------------------------------------------------------------

    def concerns(self, a: int, b: int) -> bool:
        """Return True if a contact of two bodies touches a live body, or joins a frozen body and a mover."""
        if a in self.live or b in self.live:
            return True
        return (a in self.frozen and b in self.movers) or (b in self.frozen and a in self.movers)

    def sides(self, bodies: IntArray) -> IntArray:
        """Return the core's ids of bodies in contacts (n,), and note new obstacles. A half space is the ground."""
        for body in {*bodies.tolist()}:
            if not (body in self.live or body in self.frozen or body in self.obstacles or body in self._planes):
                self._note_obstacle(body)
        for plane in self._planes:
            bodies = np.where(bodies == plane, GROUND, bodies)
        return bodies

    def beside_kinematic(self) -> Sequence[int]:
        """Return the frozen bodies beside a kinematic body that has moved since the latest comparison.

        The method compares poses only while bodies are frozen.
        """
        if not self.kinematic or not self.frozen:
            return ()
        rows = self._world.motions(self.kinematic)
        moved = np.flatnonzero((rows[:, POSE] != self._kinematic_rows[:, POSE]).any(axis=1))
        self._kinematic_rows = rows
        if not len(moved):
            return ()
        if self._boxes is None:
            self._boxes = list(self.frozen), np.array([self._world.box(body) for body in self.frozen])
        bodies, boxes = self._boxes
        beside: BoolArray = np.zeros(len(bodies), np.bool_)
        for row in moved.tolist():
            box = np.asarray(self._world.box(self.kinematic[row]))
            beside |= ((boxes[:, :3] <= box[3:] + BESIDE) & (boxes[:, 3:] >= box[:3] - BESIDE)).all(axis=1)
        return [bodies[row] for row in np.flatnonzero(beside).tolist()]

    # -- helpers --------------------------------------------------------------------------------------

    def _find_moved(self) -> None:
        """Set ``moved`` to the bodies with a pose other than at their freeze, among the next frozen bodies in turn."""
        if not self._unseen:
            self._unseen = [*self.frozen]
        frozen = [body for body in self._unseen[:AT_A_LOOK] if body in self.frozen]
        del self._unseen[:AT_A_LOOK]
        if frozen:
            kept = np.array([self._frozen_poses[body] for body in frozen])
            differs = (self._world.motions(frozen)[:, POSE] != kept).any(axis=1)
            self.moved = [frozen[row] for row in np.flatnonzero(differs).tolist()]

    def _check_next(self) -> list[int]:
        """Check the next live body, in turn; return a list with the body if it can no longer freeze.

        Otherwise the list is empty, and the method records the body's mass.
        """
        if not self.live:
            return []
        if not self._unchecked:
            self._unchecked = [*self.live]
        body = self._unchecked.pop()
        if body not in self.live:
            return []
        if self._world.reason_against(body):
            return [body]
        self.live[body] = self._world.mass(body)
        return []

    def _control(self, body: int) -> None:
        """Start to control a free body; delete the body from the obstacles."""
        self.obstacles.discard(body)
        self.live[body] = self._world.mass(body)
        solid = self._world.solid(body)
        if solid is not None:
            self.shapes.add(body, solid)

    def _forget(self, body: int) -> None:
        """Delete the record of a body that leaves the world or the port's control."""
        if body in self.live or body in self.frozen or body in self.obstacles:
            self._removed.append(body)
        self.live.pop(body, None)
        self.frozen.pop(body, None)
        self._frozen_poses.pop(body, None)
        self.obstacles.discard(body)
        self._planes.discard(body)
        self.shapes.remove(body)
        self._boxes = None

    def _note_obstacle(self, body: int) -> None:
        """Record an obstacle that touches a controlled body for the first time; add a half space to the ground."""
        solid = self._world.solid(body)
        if solid is not None and not len(solid.vertices):
            self._planes.add(body)
            self.shapes.add(GROUND, solid)
            return
        self.obstacles.add(body)
        self.has_new_obstacle = True
        if solid is not None:
            self.shapes.add(body, solid)

    def _sort_others(self) -> None:
        """Find the movers and the kinematic bodies among the bodies that the port does not control."""
        others = sorted(self._present - self.live.keys() - self.frozen.keys())
        self.movers = {body for body in others if self._world.is_mover(body)}
        self.kinematic = [body for body in others if self._world.is_kinematic(body)]
        self._kinematic_rows = self._world.motions(self.kinematic)
