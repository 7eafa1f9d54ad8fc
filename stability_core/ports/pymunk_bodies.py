"""Record of the bodies of a pymunk space: live bodies, frozen bodies and obstacles, and the row of each body in arrays.

The port numbers the bodies, because pymunk identifies bodies by memory addresses. A body keeps its id as long as the
body is in the space. The rows have the order of the ids. The last row is ``space.static_body``, which counts as ground.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pymunk

from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.ports.pymunk_calls import forget_pairs, freeze, unfreeze
from stability_core.ports.pymunk_touch import reach_of

AUDIT_EVERY = 8
"""Number of frames for each read of the shapes of one body, because a read takes as long as a step of a small space."""


class Inertia(NamedTuple):
    """The properties of a body that pymunk deletes when the body becomes static."""

    mass: float
    moment: float
    center: pymunk.Vec2d
    """Centre of gravity in the body's own coordinates."""


class PymunkBodies:
    """Record of the bodies of one space."""

    def __init__(self, space: pymunk.Space, *, takes_all: bool) -> None:
        self._space, self._takes_all = space, takes_all
        self.id_of: dict[pymunk.Body, int] = {}
        """Id of each body of the space, except the space's own static body, in rising order."""
        self.frozen: dict[pymunk.Body, Inertia] = {}
        self.live: set[pymunk.Body] = set()
        self.touched: set[int] = set()
        """Ids of the obstacles that have touched a controlled body."""
        self._listed: set[pymunk.Body] = set()  # bodies that the host passed to ``add``
        self._left_out: set[pymunk.Body] = set()  # bodies that the host passed to ``remove``
        self._removed: list[int] = []
        self._next = 0
        self._seen: tuple[list[pymunk.Body], list[pymunk.Constraint], int] | None = None
        self._audited = 0
        self.rows: list[pymunk.Body] = []
        """Body of each row."""
        self.ids: IntArray = np.empty(0, np.int64)
        """Id of each row, in rising order; the last row has the id ``GROUND``."""
        self.mass: FloatArray = np.empty(0)
        """Mass of each row: infinite for obstacles, without a meaning for frozen bodies."""
        self.is_live: BoolArray = np.empty(0, np.bool_)
        self.is_frozen: BoolArray = np.empty(0, np.bool_)
        self.is_loose: BoolArray = np.empty(0, np.bool_)
        """Mask of the obstacles that move by forces, such as the parts of a ragdoll."""
        self.has_loose = False
        self.has_kinematic = False
        self.friction: FloatArray = np.empty(0)
        """Coefficient of friction of each row; the coefficient of a pair is the product of both."""
        self.depths: FloatArray = np.empty(0)
        """Extent of each row across the plane: the reach of the body, or infinity for the ground. With a much
        smaller extent, a contact would count as an edge."""
        self.centers: FloatArray = np.empty((0, 2))
        """Centre of gravity in the body's own coordinates."""

    # -- bodies that come and go -------------------------------------------------------------------

    def follow(self) -> bool:
        """Follow masses, and bodies, joints and shapes that come and go; return True after a rebuild of the rows."""
        space = self._space
        seen = list(space.bodies), list(space.constraints), len(space.shapes)
        rows: list[int] = np.flatnonzero(self.is_live).tolist() if self.live else []
        masses = [self.rows[row].mass for row in rows]
        if seen == self._seen and all(mass < math.inf for mass in masses):  # a static body has infinite mass
            if masses:
                self.mass[rows] = masses
                self._audit_next()
            return False
        self._seen = seen
        self.refresh()
        return True

    def are_at_rest(self) -> bool:
        """Return True if no body can move by itself, and the space has as many bodies, joints and shapes as before.

        "Before" is the latest ``follow``. Frozen and static bodies cannot move by themselves.
        """
        if self.live or self.has_loose or self.has_kinematic or self._seen is None:
            return False
        (bodies, joints, shapes), space = self._seen, self._space
        # private lists, because pymunk's public properties copy the lists
        return (len(space._bodies), len(space._constraints), len(space._shapes)) == (len(bodies), len(joints), shapes)

    def refresh(self) -> None:
        """Find the bodies to control, stop controlling bodies that can no longer freeze, and rebuild the rows."""
        present = self._space.bodies
        known = set(present)
        for planar in [planar for planar in self.id_of if planar not in known]:
            self._forget(planar)
        for planar in present:
            if planar not in self.id_of:
                self.id_of[planar] = self._next
                self._next += 1
            wanted = (self._takes_all or planar in self._listed) and planar not in self._left_out
            controlled = planar in self.live or planar in self.frozen
            if wanted and not controlled and self.reason_against(planar) is None:
                self.live.add(planar)
                self.touched.discard(self.id_of[planar])
            elif controlled and (not wanted or self.reason_against(planar)):
                self._let_go(planar)
        self._build_rows()

    def reason_against(self, planar: pymunk.Body) -> str | None:
        """Return why a body of the space cannot freeze; None if it can freeze."""
        if any(joint in self._space.constraints for joint in planar.constraints):
            return "has joints: list free bodies only, because the extension leaves jointed bodies alone"
        if planar.body_type != pymunk.Body.DYNAMIC and planar not in self.frozen:
            return "is kinematic or static: list dynamic bodies only"
        return None

    def add(self, planar: pymunk.Body) -> None:
        """Control a body at the next ``refresh``.

        Raises:
            TypeError: if ``planar`` is no body of pymunk.
            ValueError: if the body is not in the space, cannot freeze, or is under control already.
        """
        if not isinstance(planar, pymunk.Body):
            raise TypeError(
                f"the port to pymunk controls pymunk.Body, got {type(planar).__name__}: pass bodies, such as shape.body"
            )
        if planar.space is not self._space:
            raise ValueError(f"{planar} is not in this space: call space.add(body, shape) first")
        if planar in self.live or planar in self.frozen or planar in self._listed - self._left_out:
            raise ValueError(f"the port controls {planar} already: list each body once, in attach() or in add()")
        reason = self.reason_against(planar)
        if reason:
            raise ValueError(f"{planar} {reason}")
        self._listed.add(planar)
        self._left_out.discard(planar)

    def leave_out(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies become live. The rows change at the next ``refresh``.

        Raises:
            KeyError: for an id that is not in the space.
        """
        for body in bodies:
            planar = self.body_of(body)
            self._left_out.add(planar)
            if planar in self.live or planar in self.frozen:
                self._let_go(planar)

    def take_removed(self) -> list[int]:
        """Return the ids of bodies that left the space or the port's control since the previous call."""
        removed, self._removed = self._removed, []
        return removed

    def has_news(self) -> bool:
        """Return True if a body has left the space or the port's control since the latest ``take_removed``."""
        return bool(self._removed)

    def body_of(self, body: int) -> pymunk.Body:
        """Return the body of an id.

        Raises:
            KeyError: if the space has no body with this id.
        """
        row = np.searchsorted(self.ids[:-1], body)
        if row < len(self.ids) - 1 and self.ids[row] == body:
            return self.rows[row]
        raise KeyError(f"no body of this pymunk space has the id {body}: pass ids that id_of() or update() returned")

    def rows_of(self, bodies: Iterable[int]) -> list[int]:
        """Return the rows of the ids of bodies in the space; skip other ids."""
        found = ((int(np.searchsorted(self.ids[:-1], body)), body) for body in bodies)
        return [row for row, body in found if row < len(self.ids) - 1 and self.ids[row] == body]

    # -- freezing ----------------------------------------------------------------------------------

    def freeze(self, row: int) -> None:
        """Freeze a live body."""
        planar = self.rows[row]
        self.live.remove(planar)
        self.frozen[planar] = Inertia(planar.mass, planar.moment, planar.center_of_gravity)
        freeze(planar)
        forget_pairs(self._space, planar)
        self.is_live[row], self.is_frozen[row] = False, True

    def unfreeze(self, row: int) -> None:
        """Return a frozen body to pymunk."""
        planar = self.rows[row]
        self._make_dynamic(planar)
        self.live.add(planar)
        self.is_live[row], self.is_frozen[row] = True, False
        self.mass[row] = planar.mass

    # -- helpers -----------------------------------------------------------------------------------

    def _make_dynamic(self, planar: pymunk.Body) -> None:
        """Make a frozen body dynamic, with its former mass, moment of inertia and centre of gravity."""
        kept, position = self.frozen.pop(planar), planar.position
        unfreeze(planar, kept.mass, kept.moment)
        if kept.center != (0.0, 0.0):  # pymunk has moved the centre of gravity to the body's origin
            planar.center_of_gravity = kept.center
            planar.position = position

    def _let_go(self, planar: pymunk.Body) -> None:
        """Stop controlling a body of the space."""
        if planar in self.frozen:
            self._make_dynamic(planar)
        self.live.discard(planar)
        self._removed.append(self.id_of[planar])

    def _forget(self, planar: pymunk.Body) -> None:
        """Forget a body that left the space; make a frozen body dynamic, because the host may add the body again."""
        body = self.id_of[planar]
        if planar in self.live or planar in self.frozen:
            self._let_go(planar)
        elif body in self.touched:
            self._removed.append(body)
        self.touched.discard(body)
        self._listed.discard(planar)
        self._left_out.discard(planar)
        del self.id_of[planar]

    def _build_rows(self) -> None:
        self.rows = [*self.id_of, self._space.static_body]
        self.ids = np.array([*self.id_of.values(), GROUND], np.int64)
        self.is_live = np.array([planar in self.live for planar in self.rows])
        self.is_frozen = np.array([planar in self.frozen for planar in self.rows])
        dynamic = [planar.body_type == pymunk.Body.DYNAMIC for planar in self.rows]
        self.is_loose = np.array(dynamic) & ~self.is_live
        self.has_loose = bool(self.is_loose.any())
        self.has_kinematic = any(planar.body_type == pymunk.Body.KINEMATIC for planar in self.rows)
        self.mass = np.array([planar.mass if planar in self.live else math.inf for planar in self.rows])
        self.friction, self.depths = np.empty(len(self.rows)), np.empty(len(self.rows))
        self.centers = np.empty((len(self.rows), 2))
        for row in range(len(self.rows)):
            self._read_shapes(row)

    def _audit_next(self) -> None:
        """Read the shapes of the next body in one of ``AUDIT_EVERY`` calls; in the other calls, do nothing.

        The reads detect changes of friction and size by the host.
        """
        self._audited = (self._audited + 1) % (len(self.rows) * AUDIT_EVERY)
        if self._audited % AUDIT_EVERY == 0:
            self._read_shapes(self._audited // AUDIT_EVERY)

    def _read_shapes(self, row: int) -> None:
        """Read the friction, the extent and the centre of gravity of a body."""
        planar = self.rows[row]
        x, y = self.centers[row] = self.frozen[planar].center if planar in self.frozen else planar.center_of_gravity
        self.friction[row] = min((shape.friction for shape in planar.shapes), default=0.0)
        if planar is self._space.static_body:
            self.depths[row] = math.inf
        else:
            self.depths[row] = max((reach_of(shape, (x, y)) for shape in planar.shapes), default=0.0)
