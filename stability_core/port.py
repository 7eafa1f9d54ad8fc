"""The core's view of a physics engine: contacts, sleep and mass.

- Values are float64 arrays in SI units, in the coordinates of the engine. Gravity defines the vertical.
- Body ids are 64-bit integers from 0. The host must not reuse an id. Memory grows with the number of bodies in the
  world, not with the greatest id.
- "Sleep" is an exact freeze: a frozen body does not move until ``wake``, even after a blow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]

GROUND = -1
"""Id of the ground: all objects that do not move in the simulation, such as floor, table and walls.

A body that the host moves (a lift, a door, a conveyor belt) has its own id and infinite mass, see ``Masses``. If a part
of the ground starts to move, list this part as a body of infinite mass from then on. Pass the bodies that rest on this
part to ``StabilityExtension.wake``.
"""


@dataclass(frozen=True, slots=True)
class Contacts:
    """All contact points of the live bodies in one frame, with one row for each point.

    ``separation`` and ``relative_velocity`` may contain NaN, for values that an engine does not report. Other fields
    must be finite.
    """

    body_a: IntArray
    """First body of the pair, a body id or ``GROUND``, shape (n,)."""
    body_b: IntArray
    """Second body of the pair, a body id or ``GROUND``, shape (n,)."""
    point: FloatArray
    """Contact points [m] in the coordinates of the engine, shape (n, 3)."""
    normal: FloatArray
    """Unit normals pointing from body a to body b, shape (n, 3)."""
    separation: FloatArray
    """Signed distance [m] at the point, shape (n,). A negative distance is a penetration."""
    relative_velocity: FloatArray
    """Velocity [m/s] of b against a at the point, shape (n, 3), before the solver stops the approach. With several
    substeps per frame, give the velocity of the fastest approach."""
    friction: FloatArray
    """Coulomb coefficient of the pair, shape (n,)."""
    force: FloatArray | None = None
    """Force [N] on body b at each point, mean over the frame's substeps, shape (n, 3). The opposite force acts on body
    a. A listed point without touch has zero force. The field is None if the engine reports no forces."""

    @classmethod
    def empty(cls) -> Contacts:
        """Return an empty set of contacts."""
        ids, scalars, vectors = np.empty(0, np.int64), np.empty(0), np.empty((0, 3))
        return cls(ids, ids, vectors, vectors, scalars, vectors, scalars)

    def __len__(self) -> int:
        return len(self.body_a)

    def chosen(self, rows: BoolArray | IntArray) -> Contacts:
        """Return the contacts of ``rows``: a mask of shape (n,), or row numbers."""
        columns = {item.name: getattr(self, item.name) for item in fields(self)}
        return replace(self, **{name: column[rows] for name, column in columns.items() if column is not None})


@dataclass(frozen=True, slots=True)
class Masses:
    """Mass and centre of mass of the live bodies, and the bodies that have left the world.

    The port may leave out frozen bodies, because the core remembers their mass and place. If a listed frozen body
    has moved, the core makes the body live. If the mass of a listed frozen body has changed, the core judges the stack
    with the new mass.

    A body that the host moves has infinite mass. List this body in every frame, even while all other bodies are frozen,
    so that the core sees its motion. While the body keeps its place, it counts as ground. When the body begins to move,
    all bodies on it unfreeze. A body that moves in its place, such as a belt or a turntable, must show this motion at
    its contacts with frozen bodies (``Contacts.relative_velocity``). If the engine does not list these contacts, pass
    the body to ``StabilityExtension.wake``.
    """

    body: IntArray
    """Body ids, shape (m,)."""
    mass: FloatArray
    """Masses [kg], positive, shape (m,). A body that the host moves has infinite mass."""
    center_of_mass: FloatArray
    """Centres of mass [m], shape (m, 3)."""
    removed: Sequence[int] = ()
    """Ids of bodies that left the world since the last call, shape (k,)."""


class StabilityPort(Protocol):
    """The four methods through which the core reads and controls an engine."""

    def contacts(self) -> Contacts:
        """Return every contact of a live body after the latest step."""
        ...

    def masses(self) -> Masses:
        """Return the masses and centres of the live bodies after the latest step."""
        ...

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies exactly in their present poses."""
        ...

    def wake(self, bodies: Sequence[int]) -> None:
        """Unfreeze bodies, at rest, with their former mass."""
        ...
