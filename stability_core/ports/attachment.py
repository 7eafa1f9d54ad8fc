"""``Attachment``: a stability extension on a simulation that the user owns."""

from __future__ import annotations

import weakref
from collections.abc import Hashable, Iterable
from typing import Protocol

from stability_core.batch import Change
from stability_core.extension import StabilityExtension
from stability_core.policies import Policy
from stability_core.port import StabilityPort
from stability_core.settings import Settings

_ATTACHED: weakref.WeakValueDictionary[Hashable, Attachment] = weakref.WeakValueDictionary()
"""The open attachment of each world, by ``EnginePort.world``."""


class EnginePort(StabilityPort, Protocol):
    """A port that follows the bodies, the gravity and the time of an engine's world."""

    engine: str
    """Name of the engine in messages."""
    world: Hashable
    """Identity of the world."""

    def gravity(self) -> tuple[float, float, float]:
        """Return the world's gravity [m/s2], as the port has last read it."""
        ...

    def begin_update(self, dt: float) -> Iterable[int]:
        """Follow bodies that come and go, and check the time; return the ids that the attachment must wake.

        Supports that turned in place are an example. The time ``dt`` [s] is 0 for a read without a step.

        Raises:
            ValueError: if the world contradicts ``dt``, or has a state that the port cannot follow, such as a pose that
                is not finite; the message names the fix.
            RuntimeError: if the call comes inside a step of the engine.
        """
        ...

    def add(self, bodies: Iterable[int]) -> None:
        """Control bodies.

        Raises:
            ValueError: for a body that the port cannot freeze or controls already; the message names the fix.
        """
        ...

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; a frozen body in the world becomes live first."""
        ...

    def find_contacts(self) -> None:
        """Make the next ``contacts`` return the contacts of the present poses."""
        ...


class Attachment(StabilityExtension):
    """A stability extension attached to a user's simulation.

    Call ``update(dt)`` after the engine's steps. Gravity follows the world's gravity. Bodies have the port's ids.
    """

    port: EnginePort

    def __init__(self, port: EnginePort, policy: str | Policy, settings: Settings | None) -> None:
        """Attach the extension to the world of ``port``.

        Raises:
            RuntimeError: if an open attachment of the world exists.
            ValueError: if the world has no gravity, or its gravity is not finite.
            UnknownNameError: if ``POLICIES`` does not contain ``policy``.
        """
        if port.world in _ATTACHED:
            raise RuntimeError(
                f"this {port.engine} world already has an extension attached: call close() of that extension first, or "
                "call add() of that extension to control more bodies"
            )
        gravity = port.gravity()
        if not any(gravity):
            raise ValueError(
                f"this {port.engine} world has no gravity, and without gravity nothing stands: set the world's gravity "
                "before attach()"
            )
        super().__init__(port, policy, gravity, settings)
        _ATTACHED[port.world] = self

    def update(self, dt: float) -> Change:
        """Read the world after steps of ``dt`` seconds in all; freeze and unfreeze bodies.

        See ``StabilityExtension.update``.

        Raises:
            ValueError: if ``dt`` is not the time of the steps since the previous update, or the port cannot follow the
                world. An example is a pose that is not finite. The message names the fix.
            RuntimeError: if the attachment is closed, or the call comes inside a step of the engine.
        """
        self._check_open()
        self._follow_world(dt)
        return super().update(dt)

    def adopt(self, bodies: Iterable[int] | None = None) -> Change:
        """Judge bodies in place by statics, with the contacts of the present poses, and freeze bodies that stand.

        Call this method after you have built the stack, before the first step. See ``StabilityExtension.adopt``.

        Raises:
            KeyError: for a body that the port has not listed.
            ValueError: if the port cannot follow the world, for example because a pose is not finite.
            RuntimeError: if the attachment is closed, or the call comes inside a step of the engine.
        """
        self._check_open()
        self._follow_world(0.0)
        self.port.find_contacts()
        return super().adopt(bodies)

    def add(self, bodies: Iterable[int]) -> None:
        """Control more bodies, in the forms that ``attach`` accepts.

        An attachment without a list of bodies finds new bodies itself.

        Raises:
            ValueError: for a body that cannot freeze, such as a robot, or that the port controls already; the message
                names the reason.
            TypeError: for an object that is no body (pymunk, DART).
            KeyError: for a body that is not in the world (DART).
            RuntimeError: if the attachment is closed.
        """
        self._check_open()
        self.port.add(bodies)

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies among them become live. Call this method before you delete a body.

        Raises:
            KeyError: for an id that the port does not know (MuJoCo, pymunk, DART).
            RuntimeError: if the attachment is closed, or the call comes inside a step of the engine.
        """
        self._check_open()
        self.port.remove(bodies)

    def close(self) -> None:
        """Unfreeze every body, and release the world, so that the user can attach another extension.

        Raises:
            RuntimeError: if bodies are frozen, and the call comes inside a step of the engine.
        """
        _ATTACHED.pop(self.port.world, None)
        super().close()

    def _follow_world(self, dt: float) -> None:
        turned = self.port.begin_update(dt)
        gravity = self.port.gravity()
        if gravity != self.gravity:
            self.gravity = gravity
        if turned:
            self.wake(turned)
