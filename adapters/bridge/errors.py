"""Errors of an engine in a separate process, each with the status of the trial that the error ends."""

from __future__ import annotations

from typing import ClassVar, Literal


class PeerError(RuntimeError):
    """Error for an engine that reports a failure or does not start."""

    status: ClassVar[Literal["error", "crashed", "timeout"]] = "error"
    """Status of a trial that ends with this error."""


class ProtocolError(PeerError):
    """Error for an engine that breaks the protocol; the message states the received and the required content."""


class PeerExitError(PeerError):
    """Error for an engine whose process ended; the message contains the exit status and the last line on stderr."""

    status = "crashed"


class PeerTimeoutError(PeerError):
    """Error for an engine that did not answer in time; the suite has killed the engine's process."""

    status = "timeout"
