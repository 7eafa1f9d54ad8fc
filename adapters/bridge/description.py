"""An engine's description in its hello message: name, version, capabilities, and the time of its contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, Literal

from adapters.bridge.errors import ProtocolError
from adapters.bridge.messages import PROTOCOL
from adapters.profile import Capabilities
from scenarios.lookup import one_of

Detection = Literal["start", "end"]
"""Time of the poses at which the engine detects contact points: the start of the latest substep, or its end."""

_NOT_IN_PROTOCOL = ("shapes", "other_shapes", "own_friction", "restitution", "own_moments", "weld")
"""Capabilities that an external engine cannot have, because the messages describe free boxes of one friction only."""
_UNLESS_SAID = {"relative_velocity": "from the velocities before the step", "frozen_contacts": False}


@dataclass(frozen=True, slots=True)
class Description:
    """Description of an engine behind the bridge."""

    engine: str
    version: str
    capabilities: Capabilities
    contacts_at: Detection
    iterations: str = ""
    """Name of the knob for the solver's iterations; empty if the engine has no such knob."""
    solver_noise: float = 0.0
    """Greatest speed [m/s] at which bodies at rest vibrate, the margin of ``fastest_approach``."""


def described(hello: Mapping[str, Any]) -> Description:
    """Return the description in a hello message.

    Raises:
        ProtocolError: if the protocol has another version, an entry is missing or not valid, or a capability is
            unknown; the message names the entry.
    """
    if hello.get("protocol") != PROTOCOL:
        raise ProtocolError(
            f"hello: 'protocol' must be {PROTOCOL}, got {hello.get('protocol')!r}; "
            f"implement version {PROTOCOL} of the protocol in docs/bridge.md"
        )
    return Description(
        _text(hello, "engine"),
        _text(hello, "version"),
        _capabilities(hello.get("capabilities")),
        _detection(hello.get("contacts_at")),
        _text(hello, "iterations") if "iterations" in hello else "",
        _noise(hello.get("solver_noise", 0.0)),
    )


def _detection(said: object) -> Detection:
    if said == "start":
        return "start"
    if said == "end":
        return "end"
    raise ProtocolError(
        f"hello: 'contacts_at' must be 'start' or 'end' (of a substep), got {said!r}; write the time of the poses at "
        "which the engine detects contacts"
    )


def _capabilities(said: Any) -> Capabilities:
    if not isinstance(said, dict):
        raise ProtocolError(
            f"hello: 'capabilities' must be a JSON object, got {said!r}; write an object with the entries in "
            "docs/bridge.md"
        )
    said = _UNLESS_SAID | said
    known = {field.name: field for field in fields(Capabilities) if field.name not in _NOT_IN_PROTOCOL}
    for name, value in said.items():
        if name not in known:
            raise ProtocolError(f"hello: unknown capability '{name}'; use {one_of(known)}")
        wanted = bool if known[name].type in ("bool", bool) else str
        if type(value) is not wanted:
            kind = "true or false" if wanted is bool else "a text"
            raise ProtocolError(f"hello: capability '{name}' must be {kind}, got {value!r}; write {kind}")
    for name, field in known.items():
        if name not in said and field.default is MISSING:
            raise ProtocolError(f"hello: capability '{name}' is missing; add this capability (see docs/bridge.md)")
    return Capabilities(**said)


def _text(hello: Mapping[str, Any], key: str) -> str:
    text = hello.get(key)
    if not (isinstance(text, str) and text.strip()):
        raise ProtocolError(f"hello: '{key}' must be a text that is not empty, got {text!r}; write a text")
    return text


def _noise(speed: object) -> float:
    if not (isinstance(speed, (int, float)) and 0.0 <= speed < 1.0):
        raise ProtocolError(
            f"hello: 'solver_noise' must be a speed [m/s] of at least 0 and less than 1, got {speed!r}; write the "
            "greatest speed at which bodies at rest vibrate"
        )
    return float(speed)
