"""Conversion of the bridge's messages to and from bytes, in protocol version 1: see docs/bridge.md.

A message is a header of two 32-bit numbers, the length of the body [bytes] and the kind of the message, followed by the
body. Numbers are little-endian. The body of a step is an array of 64-bit floats. All other bodies are JSON in UTF-8.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from adapters.bridge.errors import ProtocolError
from adapters.bridge.received import Finding, receive
from stability_core.port import FloatArray, IntArray

PROTOCOL = 1
"""Version of the protocol. The number changes whenever engines of the previous version would no longer work."""
HEADER = struct.Struct("<II")
"""Header of a message: length of the body [bytes], kind."""
MAX_BODY = 2**26
"""Greatest length of a message's body [bytes]: 64 MiB, so that the states of 100,000 bodies over five substeps fit.
``Peer`` rejects a header with a greater length, because the engine has probably printed text to stdout."""

COMMAND_WIDTH = 13
"""Count of numbers in a command: its code, the id of a body, and up to 11 arguments."""
STATE_WIDTH = 13
"""Count of numbers in a body's state: position [m], quaternion (w, x, y, z), velocity [m/s], spin [rad/s]."""
CONTACT_WIDTH = 14
"""Count of numbers in a contact point: ids a and b, points on a and b [m], normal from a to b, force on b [N]."""
FORCE_WIDTH = 6
"""Count of numbers in a force of an earlier substep: index of the substep, ids a and b, force on b [N]."""
POSITION, QUATERNION, LINEAR, ANGULAR = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)
"""Columns of a state, for each of its four parts."""
_STEP_HEAD = struct.Struct("<4d")
_REPLY_HEAD = struct.Struct("<5d")
_WORD = 8
"""Length of a number [bytes]."""

Command = tuple[float, ...]
"""Numbers of a command, without the zeros that fill its row."""


class Kind(IntEnum):
    """Kind of a message. An answer has the kind of the request, or the kind of an error."""

    HELLO = 1
    OPEN = 2
    STEP = 3
    ERROR = 4


class Code(IntEnum):
    """Codes of the commands in a step message. The engine executes the commands before the first substep."""

    SPAWN = 1
    SPAWN_MOVED = 2
    REMOVE = 3
    MOVE = 4
    PUSH = 5
    PRESS = 6
    DRIVE = 7
    GRAVITY = 8
    FREEZE = 9
    UNFREEZE = 10


class StepReply(NamedTuple):
    """An engine's answer to a step of n substeps. The arrays are views of the answer's bytes."""

    engine_s: float
    """Duration [s] of the engine's own steps, measured by the engine."""
    states: FloatArray
    """States before each substep and after the last substep, shape (n + 1, m, 13).

    Only the states after the last substep, shape (1, m, 13), if the step message requests no contacts.
    """
    contacts: FloatArray
    """Contact points of the last substep, shape (k, 14)."""
    forces: FloatArray
    """Forces of all substeps except the last, shape (l, 6)."""
    is_finite: bool
    """True if all states are finite."""


def json_body(content: object) -> bytes:
    """Return the body of a JSON message, in UTF-8."""
    return json.dumps(content).encode()


def json_content(body: bytes | memoryview) -> dict[str, Any]:
    """Return the content of a JSON body.

    Raises:
        ProtocolError: if the body is not a JSON object.
    """
    try:
        content = json.loads(bytes(body))
    except ValueError as error:
        raise ProtocolError(
            f"the engine's answer must be a JSON object, got {bytes(body[:60])!r}, which is not JSON ({error}): "
            "write a JSON object in UTF-8"
        ) from error
    if not isinstance(content, dict):
        raise ProtocolError(
            f"the engine's answer must be a JSON object, got {bytes(body[:60])!r}: write an object in "
            "braces, as docs/bridge.md shows"
        )
    return content


def step_body(seconds: float, substeps: int, is_read: bool, commands: Iterable[Command]) -> bytes:
    """Return the body of a step message.

    Args:
        seconds: length of a substep.
        substeps: number of substeps.
        is_read: whether the answer must contain contacts, forces and the states before each substep.
        commands: commands that the engine executes before the first substep.
    """
    rows = [_row(command) for command in commands]
    return b"".join((_STEP_HEAD.pack(seconds, substeps, is_read, len(rows)), *rows))


def _row(command: Command) -> bytes:
    return struct.pack(f"<{len(command)}d", *command).ljust(_WORD * COMMAND_WIDTH, b"\0")


def step_reply(body: bytes | memoryview, bodies: IntArray, states: int, table: FloatArray) -> StepReply:
    """Return the content of the answer to a step, and store the latest state of each body in ``table``.

    Args:
        body: body of the answer.
        bodies: ids of the bodies whose states the answer must contain, in rising order, shape (m,).
        states: required number of states of each body.
        table: latest states by id, shape (n, 13). If any state is not finite, the rows of all ``bodies`` become NaN.

    Raises:
        ProtocolError: if the answer has another length, other bodies, or numbers that are not valid.
    """
    length, rest = divmod(len(body), _WORD)
    if rest:
        raise ProtocolError(
            f"the answer to a step must consist of 64-bit floats, 8 bytes each, got {len(body)} bytes: write "
            "whole floats"
        )
    if len(body) < _REPLY_HEAD.size:
        raise ProtocolError(
            f"the answer to a step must begin with {_REPLY_HEAD.size // _WORD} numbers, but its whole length is "
            f"{length}: write the time of the steps, then the four counts"
        )
    engine_s, *counts = _REPLY_HEAD.unpack_from(body)
    if not 0.0 <= engine_s < math.inf:
        raise ProtocolError(
            f"the time of the engine's steps must be finite and at least 0 s, got {engine_s} s: correct the "
            "engine's clock"
        )
    if not all(count >= 0.0 and count.is_integer() for count in counts):
        raise ProtocolError(
            f"the counts in the answer to a step must be whole numbers of at least 0, got {counts}: write the counts "
            "as 64-bit floats"
        )
    listed, blocks, points, forces = map(int, counts)
    of_points = listed + blocks * listed * STATE_WIDTH
    of_forces = of_points + points * CONTACT_WIDTH
    needed = of_forces + forces * FORCE_WIDTH
    if length != _REPLY_HEAD.size // _WORD + needed:
        raise ProtocolError(
            f"an answer with the counts {listed} (bodies), {blocks} (states of each body), {points} (contact points) "
            f"and {forces} (forces) must have {_REPLY_HEAD.size // _WORD + needed} numbers, got {length}: write counts "
            "that fit the numbers"
        )
    words = np.frombuffer(body, np.float64, offset=_REPLY_HEAD.size)
    finding: int = Finding.OTHER_BODIES
    if blocks == states and listed == len(bodies):
        finding = receive(words, bodies, blocks, table)
    if finding == Finding.OTHER_BODIES:
        raise ProtocolError(
            f"the answer must have the states of the live and moved bodies, by rising id: ids {_listed(bodies)} (count "
            f"{len(bodies)}), with {states} as the count of states of each body; got ids {_listed(words[:listed])} "
            f"(count {listed}), with {blocks} as the count of states{_first_difference(bodies, words[:listed])}: write "
            "the required states, in the order of the required ids"
        )
    if finding == Finding.POINTS_NOT_FINITE:
        place = int(np.flatnonzero(~np.isfinite(words[of_points:]))[0])
        row, of_force = place // CONTACT_WIDTH, place - points * CONTACT_WIDTH
        where = f"contact point {row}" if of_force < 0 else f"force {of_force // FORCE_WIDTH}"
        raise ProtocolError(
            f"contact points and forces in the answer must be finite, got {words[of_points + place]} in {where} (from "
            "0): send finite numbers only"
        )
    return StepReply(
        engine_s,
        words[listed:of_points].reshape(blocks, listed, STATE_WIDTH),
        words[of_points:of_forces].reshape(points, CONTACT_WIDTH),
        words[of_forces:].reshape(forces, FORCE_WIDTH),
        finding == Finding.VALID,
    )


def _listed(ids: FloatArray | IntArray) -> str:
    """Return the first ten ids as text."""
    shown = ", ".join(f"{number:.15g}" for number in ids[:10].tolist())
    return f"[{shown}{', ...' if len(ids) > 10 else ''}]"


def _first_difference(required: IntArray, given: FloatArray) -> str:
    """Return the first place where both lists have different ids as text; empty if there is no such place."""
    common = min(len(required), len(given))
    places = np.flatnonzero(required[:common] != given[:common])
    if not len(places):
        return ""
    place = places[0]
    return f", first different in place {place} (from 0), {given[place]:.15g} instead of {required[place]}"
