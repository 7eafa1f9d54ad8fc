"""Errors of an engine in a separate process, each with the status of the trial that the error ends."""

from __future__ import annotations

from typing import ClassVar, Literal


class PeerError(RuntimeError):
    """An engine reports a failure, or cannot be started."""

    status: ClassVar[Literal["error", "crashed", "timeout"]] = "error"
    """Status of a trial that ends with this error."""


class ProtocolError(PeerError):
    """An engine breaks the protocol of the bridge; the message states the received and the required content."""


class PeerExitError(PeerError):
    """An engine's process ended; the message contains its exit status and its last line on stderr."""

    status = "crashed"


class PeerTimeoutError(PeerError):
    """An engine did not answer in time, and its process was killed."""

    status = "timeout"
