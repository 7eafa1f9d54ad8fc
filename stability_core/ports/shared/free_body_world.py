"""``FreeBodyWorld``: the interface by which ``FreeBodyPort`` reads and controls an engine's world of rigid bodies."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence, Set
from typing import ClassVar, NamedTuple, TypeAlias

from stability_core.port import FloatArray, IntArray
from stability_core.ports.shared.shapes import Solid

Vector: TypeAlias = tuple[float, float, float]
Concerns: TypeAlias = Callable[[int, int], bool]
"""Function that returns True if the port needs the contacts of two bodies."""


class Touching(NamedTuple):
    """Contact points of an engine, n in all."""

    body_a: IntArray
    """Ids of bodies a, shape (n,)."""
    body_b: IntArray
    """Ids of bodies b, shape (n,)."""
    point: FloatArray
    """Points [m] in the world's frame, shape (n, 3)."""
    normal: FloatArray
    """Unit normals from a to b, shape (n, 3)."""
    separation: FloatArray
    """Separations [m], shape (n,)."""
    friction: FloatArray
    """Coefficients of friction of the pairs, shape (n,)."""
    force: FloatArray
    """Normal forces [N] on b, shape (n, 3)."""


class FreeBodyWorld(ABC):
    """A user's world. Each body has an id. The world never gives this id to another body."""

    engine: ClassVar[str]
    """Name of the engine in messages."""
    setter: ClassVar[str]
    """Attribute by which a user sets the step, in messages."""
    ids_from: ClassVar[str]
    """Expression that gives a user the id of a body, in messages."""

    @abstractmethod
    def gravity(self) -> Vector:
        """Return the world's gravity [m/s2]."""

    @abstractmethod
    def step_s(self) -> float:
        """Return the time [s] of one step."""

    def check(self) -> None:  # noqa: B027 # few engines report it
        """Raise ``ValueError`` if the engine reports a state that the port cannot follow, for example a divergence."""

    def rest(self) -> None:  # noqa: B027 # few engines need it
        """Make the engine's steps skip the frozen bodies. The port calls this method only while no body is live."""

    @abstractmethod
    def has_changed(self) -> bool:
        """Return True if bodies have come or gone since the previous call. ``bodies`` then returns the present ids."""

    def can_read(self, bodies: Collection[int]) -> bool:
        """Return True if ``motions`` can read ``bodies`` without a call of ``has_changed``, at little cost."""
        return not bodies

    @abstractmethod
    def bodies(self) -> list[int]:
        """Return the ids of the bodies of the world at the latest ``has_changed``."""

    @abstractmethod
    def reason_against(self, body: int) -> str | None:
        """Return why a body that is not frozen cannot freeze, and the fix; None if it can freeze."""

    @abstractmethod
    def mass(self, body: int) -> float:
        """Return the mass [kg] of a live body."""

    @abstractmethod
    def solid(self, body: int) -> Solid | None:
        """Return the shape of a body, relative to its centre of mass; None for a shape without known vertices.

        Round, concave and compound shapes are examples. A half space has a ``Solid`` without vertices.
        """

    @abstractmethod
    def motions(self, bodies: list[int]) -> FloatArray:
        """Return the motions of bodies in the columns of ``body_motions``, shape (n, 13)."""

    @abstractmethod
    def box(self, body: int) -> Sequence[float] | FloatArray:
        """Return the lower, then the upper corner [m] of the box around a body, along the world's axes, shape (6,)."""

    @abstractmethod
    def is_kinematic(self, body: int) -> bool:
        """Return True for a body that the user moves; the engine lists no contact between it and frozen bodies."""

    @abstractmethod
    def is_mover(self, body: int) -> bool:
        """Return True if a body that the port does not control moves by forces, such as a link of a robot."""

    @abstractmethod
    def freeze(self, body: int) -> None:
        """Freeze a live body at its present pose."""

    @abstractmethod
    def unfreeze(self, body: int) -> None:
        """Make a frozen body live, at rest."""

    @abstractmethod
    def step_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:
        """Return the contacts of the latest step that ``concerns`` selects.

        Args:
            concerns: returns True if the port needs the contacts of two bodies.
            bodies: the live bodies and the movers, for engines that list the contacts of one body. Each contact that
                ``concerns`` names touches a body of this set.
        """

    @abstractmethod
    def present_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:
        """Return the contacts of the present poses that ``concerns`` selects, without a change of the world."""
