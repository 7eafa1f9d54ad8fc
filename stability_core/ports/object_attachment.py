"""``ObjectAttachment``: an attachment to an engine whose bodies are objects without numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

from stability_core.batch import Change
from stability_core.policies import Policy
from stability_core.ports.attachment import Attachment, EnginePort
from stability_core.settings import Settings


class ObjectPort(EnginePort, Protocol):
    """A port that numbers the engine's objects."""

    def id_of(self, body: Any) -> int:
        """Return the id of one of the engine's bodies.

        Raises:
            KeyError: if the body is not in the world.
            TypeError: if ``body`` is no body of the engine. A port may raise ``KeyError`` instead.
            ValueError: for an object of several bodies.
        """
        ...

    def body_of(self, body: int) -> Any:
        """Return the engine's body of an id.

        Raises:
            KeyError: if no body in the world has this id.
        """
        ...


class ObjectAttachment(Attachment):
    """An attachment whose methods accept the engine's bodies as well as their ids; ``add`` accepts bodies only.

    ``frozen`` and every ``Change`` hold ids. ``body_of`` converts ids to bodies, and ``id_of`` converts bodies to ids.
    A method that accepts bodies raises the errors of ``id_of``.
    """

    port: ObjectPort

    def __init__(self, port: ObjectPort, policy: str | Policy, settings: Settings | None) -> None:
        """Attach the extension to the world of ``port``.

        Raises:
            RuntimeError: if an open attachment of the world exists.
            ValueError: if the world has no gravity, or its gravity is not finite.
            UnknownNameError: if ``POLICIES`` does not contain ``policy``.
        """
        super().__init__(port, policy, settings)

    def id_of(self, body: Any) -> int:
        """Return the id of one of the engine's bodies; return an id unchanged.

        Raises:
            KeyError: if the body is not in the world.
            TypeError: if ``body`` is neither an id nor a body (DART; pymunk raises ``KeyError``).
            ValueError: for a skeleton of several bodies (DART).
        """
        return body if isinstance(body, int) else self.port.id_of(body)

    def body_of(self, body: int) -> Any:
        """Return the engine's body of an id.

        Raises:
            KeyError: if no body in the world has this id.
        """
        return self.port.body_of(body)

    def adopt(self, bodies: Iterable[Any] | None = None) -> Change:
        """Judge bodies in place by statics: see ``Attachment.adopt``."""
        return super().adopt(None if bodies is None else self._ids(bodies))

    def wake(self, bodies: Iterable[Any]) -> Change:
        """Unfreeze bodies and the frozen bodies on them at once: see ``StabilityExtension.wake``."""
        return super().wake(self._ids(bodies))

    def disturb(self, bodies: Iterable[Any]) -> None:
        """Keep bodies live while a user holds or pushes them: see ``StabilityExtension.disturb``."""
        super().disturb(self._ids(bodies))

    def release(self, bodies: Iterable[Any]) -> None:
        """Let bodies freeze again once they are at rest: see ``StabilityExtension.release``."""
        super().release(self._ids(bodies))

    def why(self, body: Any) -> str:
        """Explain why a body is live, or why the core froze the body: see ``StabilityExtension.why``."""
        return super().why(self.id_of(body))

    def remove(self, bodies: Iterable[Any]) -> None:
        """Stop controlling bodies; frozen bodies among them become live: see ``Attachment.remove``."""
        super().remove(self._ids(bodies))

    def _ids(self, bodies: Iterable[Any]) -> list[int]:
        return [self.id_of(body) for body in bodies]
