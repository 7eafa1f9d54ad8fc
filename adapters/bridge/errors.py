"""Errors of an engine in a separate process, each with the status of the trial that the error ends."""

from __future__ import annotations

from typing import ClassVar, Literal


class PeerError(RuntimeError):
    """Error for an engine that reports a failure or does not start."""

    status: ClassVar[Literal["error", "crashed", "timeout"]] = "error"
    """Status of a trial that ends with this error."""


class ProtocolError(PeerError):
    """Error for an engine that breaks the protocol; the message states the required content and the fault."""


class PeerExitError(PeerError):
    """Error for an engine whose process ended; the message has the exit status or signal, and the last stderr line."""

    status = "crashed"


class PeerTimeoutError(PeerError):
    """Error for an engine that did not read a message and answer in time; the suite has killed the engine's process."""

    status = "timeout"
