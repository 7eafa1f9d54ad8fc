"""The bodies of a PyBullet world: live, frozen, or obstacles that a port does not control."""

from __future__ import annotations

from dataclasses import dataclass

import pybullet

from stability_core.port import GROUND
from stability_core.ports.pybullet_calls import Row, unfreeze
from stability_core.ports.pybullet_shapes import solid_of
from stability_core.ports.shared.shapes import ShapeTable

LINK_ID = 1 << 20
"""Step of the ids of links: link k of an obstacle b has the id b + (k + 1) LINK_ID. The base, link -1, has the id b."""
MASS_EVERY = 31
"""Number of calls of ``next_changed`` for each read of a mass, because a read takes half as long as Bullet's step."""
_BASE = -1
_MASS, _FRICTION, _INERTIA = 0, 1, 2  # columns of getDynamicsInfo


@dataclass(frozen=True, slots=True)
class Inertia:
    """Mass [kg] and principal moments of inertia [kg m2] of a body."""

    mass: float
    inertia: tuple[float, float, float]


class PybulletBodies:
    """Record of the bodies of one world."""

    def __init__(self, client: int, *, takes_all: bool) -> None:
        self._client, self._takes_all = client, takes_all
        self.live: dict[int, Inertia] = {}
        self.frozen: dict[int, Inertia] = {}
        self.obstacles: dict[int, tuple[int, int]] = {}
        """Body and link, by id, of each obstacle that has touched a controlled body."""
        self.movers: list[int] = []
        """Bodies that the port does not control, and that have joints or a mass."""
        self.shapes = ShapeTable()
        self.count = -1
        """Number of bodies in the world."""
        self._friction: dict[tuple[int, int], float] = {}
        self._planes: set[int] = set()
        self._removed: list[int] = []
        self._audited: list[int] = []
        self._passed = 0
        self._places: dict[int, object] = {}

    def follow(self) -> None:
        """Control new free bodies, if the port controls all bodies; forget bodies that left the world.

        While the number of bodies in the world is the same, the method does nothing.
        """
        client = self._client
        count = pybullet.getNumBodies(client)
        if count == self.count:
            return
        self.count = count
        present = {pybullet.getBodyUniqueId(index, client) for index in range(count)}
        for body in [body for body in (*self.live, *self.frozen) if body not in present]:
            self.remove(body)
        gone = [key for key, (body, _) in self.obstacles.items() if body not in present]
        for key in gone:
            del self.obstacles[key]
        self._removed += gone
        self._planes &= present
        self._friction.clear()
        others = sorted(present - self.live.keys() - self.frozen.keys())
        for body in others:
            if self._takes_all and self.reason_against(body) is None:
                self._control(body)
        self.movers = [body for body in others if body not in self.live and self._can_move(body)]

    def reason_against(self, body: int) -> str | None:
        """Return why a body of the world cannot freeze; None if it can freeze."""
        if pybullet.getNumJoints(body, self._client):
            return "has joints: list free bodies only, because the extension leaves robots alone"
        if not pybullet.getDynamicsInfo(body, _BASE, self._client)[_MASS] > 0.0:
            return "has no mass, and is static already: list bodies with a mass only"
        return None

    def add(self, body: int) -> None:
        """Control a free body.

        Raises:
            ValueError: if the body does not exist, is static, has joints, or is already under control.
        """
        present = [
            pybullet.getBodyUniqueId(index, self._client) for index in range(pybullet.getNumBodies(self._client))
        ]
        if body not in present:
            raise ValueError(
                f"PyBullet client {self._client} has no body {body}: pass ids that createMultiBody or loadURDF "
                f"returned; the client has the bodies {present}"
            )
        if body in self.live or body in self.frozen:
            raise ValueError(f"the port controls body {body} already: list each body once, in attach() or in add()")
        reason = self.reason_against(body)
        if reason:
            raise ValueError(f"body {body} {reason}")
        self._control(body)

    def _control(self, body: int) -> None:
        """Start to control a free body; delete the body from the obstacles."""
        self.obstacles.pop(body, None)
        info = pybullet.getDynamicsInfo(body, _BASE, self._client)
        self.live[body] = Inertia(info[_MASS], info[_INERTIA])
        solid = solid_of(body, self._client, is_hull=True)
        if solid is not None:
            self.shapes.add(body, solid)

    def remove(self, body: int) -> None:
        """Delete the record of a body that leaves the world or the port's control."""
        self.live.pop(body, None)
        self.frozen.pop(body, None)
        self.shapes.remove(body)
        self._removed.append(body)

    def freeze(self, body: int) -> None:
        """Record a live body as frozen, with its mass and inertia, because Bullet deletes both."""
        info = pybullet.getDynamicsInfo(body, _BASE, self._client)
        del self.live[body]
        self.frozen[body] = Inertia(info[_MASS], info[_INERTIA])
        self._places[body] = pybullet.getBasePositionAndOrientation(body, self._client)

    def unfreeze(self, body: int) -> Inertia:
        """Record a frozen body as live; return its mass and inertia."""
        kept = self.live[body] = self.frozen.pop(body)
        return kept

    def next_changed(self) -> list[int]:
        """Check the next controlled body, in turn; return a list with the body if it differs from the record.

        The method compares the pose of a frozen body, and in one of ``MASS_EVERY`` calls the mass. A frozen body that
        the host has moved becomes dynamic. Reason: a host may remove a body and add another between two updates, and
        the new body may have the same id.
        """
        if not self._audited:
            self._audited = [*self.live, *self.frozen]
        body = self._audited.pop() if self._audited else -1
        is_frozen = body in self.frozen
        stays = is_frozen and pybullet.getBasePositionAndOrientation(body, self._client) == self._places[body]
        self._passed = (self._passed + 1) % MASS_EVERY if stays or body in self.live else 0
        if self._passed or not (is_frozen or body in self.live):
            return []
        mass = pybullet.getDynamicsInfo(body, _BASE, self._client)[_MASS]
        if not is_frozen:
            return [] if mass == self.live[body].mass else [body]
        if mass == 0.0 and not stays:  # the host has moved the frozen body
            kept = self.frozen[body]
            unfreeze(body, self._client, kept.mass, pybullet.ACTIVATION_STATE_WAKE_UP)
        return [] if mass == 0.0 and stays else [body]

    def take_removed(self) -> list[int]:
        """Return the ids of bodies that left the world or the port's control since the previous call."""
        removed, self._removed = self._removed, []
        return removed

    def mass_of(self, key: int) -> float:
        """Return the mass [kg] of a live body, infinite for an obstacle."""
        body = self.live.get(key)
        return float("inf") if body is None else body.mass

    def friction_of(self, body: int, link: int) -> float:
        """Return the coefficient of friction of a body's link; the coefficient of a pair is the product of both.

        The link -1 is the base.
        """
        known = self._friction.get((body, link))
        if known is None:
            known = self._friction[body, link] = pybullet.getDynamicsInfo(body, link, self._client)[_FRICTION]
        return known

    def pair_of(self, row: Row) -> tuple[int, int] | None:
        """Return the core's ids of a contact's sides, and add a new obstacle; None without a controlled body."""
        a, b = row[1], row[2]
        controls_a, controls_b = a in self.live or a in self.frozen, b in self.live or b in self.frozen
        if controls_a and controls_b:
            return a, b
        if controls_a:
            return a, self._obstacle(b, row[4])
        if controls_b:
            return self._obstacle(a, row[3]), b
        return None

    def _can_move(self, body: int) -> bool:
        has_mass: bool = pybullet.getDynamicsInfo(body, _BASE, self._client)[_MASS] > 0.0
        return has_mass or bool(pybullet.getNumJoints(body, self._client))

    def _obstacle(self, body: int, link: int) -> int:
        """Return the id of an obstacle or its link, and add a new obstacle. A plane is the ground."""
        if body in self._planes:
            return GROUND
        key = body + (link + 1) * LINK_ID
        if key not in self.obstacles:
            solid = solid_of(body, self._client, is_hull=False) if link == _BASE else None
            if solid is not None and not len(solid.vertices):
                self._planes.add(body)
                self.shapes.add(GROUND, solid)
                return GROUND
            self.obstacles[key] = body, link
            if solid is not None:
                self.shapes.add(key, solid)
        return key
