"""Errors of an engine in a separate process, each with the status of a trial that it ends."""

from __future__ import annotations

from typing import ClassVar, Literal


class PeerError(RuntimeError):
    """The engine reports that it failed, or it cannot be started."""

    status: ClassVar[Literal["error", "crashed", "timeout"]] = "error"
    """Status of a trial that ends by this error."""


class ProtocolError(PeerError):
    """The engine breaks the protocol of the bridge; the message says what came, and what must come."""


class PeerExitError(PeerError):
    """The engine's process ended; the message has its exit status and its last line on stderr."""

    status = "crashed"


class PeerTimeoutError(PeerError):
    """The engine does not answer; its process was killed."""

    status = "timeout"
