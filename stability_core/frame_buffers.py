"""The recent history of contacts, and the worklist of the latest frame.

The buffers keep the contacts of some frames, because a single frame often does not show the true contact area. The
kept frames are the "dwell frames". The arrays persist from frame to frame. ADR-0002 gives the reason.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import CONTACT, ContactRows
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import ROUNDING_S
from stability_core.stack import ABSENT, Bodies

FRAME_S = 1 / 60
"""Least length [s] of a dwell frame. At 1 kHz the buffers keep every 17th frame of the host. Therefore six dwell frames
span the true contact area as at 60 Hz, at the same cost."""

STRUCK, AT_REST, LEANING, LYING, GONE, MOVED, PUSHED = range(7)
"""Rows of ``FrameBuffers.worklist``:

- STRUCK: frozen bodies that must unfreeze because of blows;
- AT_REST: live bodies at rest, which the policy must judge now;
- LEANING: live bodies at rest by the rule for leaning, which the policy must judge now;
- LYING: live bodies on a support, with missing or outdated patches;
- GONE: live bodies that have patches, but no longer lie on a support;
- MOVED: kinematic bodies that began to move, bodies that stopped being kinematic, and frozen bodies that a kinematic
  body moves;
- PUSHED: frozen bodies on which a push has changed or has lasted ``still_s``.
"""
STOOD, LENGTH, NOW, HAS_FORCES = range(4)
"""Entries of ``FrameBuffers.clock``."""


class FrameBuffers(NamedTuple):
    """The dwell frames, and the worklist of the latest frame.

    A dwell frame lasts at least ``FRAME_S``, and at least one frame of the host.
    """

    contacts: ContactRows
    """Kept contacts: ``room`` rows of ``CONTACT`` for each dwell frame, shape (frames x room,)."""
    sizes: IntArray
    """Number of used rows of each dwell frame, shape (frames,)."""
    latest: IntArray
    """Index of the latest dwell frame, shape (1,). A new dwell frame overwrites the oldest dwell frame."""
    clock: FloatArray
    """Four numbers, shape (4,):

    - STOOD: age of the latest dwell frame [s];
    - LENGTH: least length of a dwell frame [s] at the host's frame rate;
    - NOW: time since the first frame [s];
    - HAS_FORCES: 1 if the engine reports contact forces, else 0.
    """
    worklist: IntArray
    """A list of bodies in each row: their number, then their rows of ``BODY``, shape (7, 1 + room)."""


def buffers_for(seconds: float, room: int, known: FrameBuffers | None = None) -> FrameBuffers:
    """Return arrays for dwell frames that span ``seconds``, with the ``known`` contacts and an empty worklist.

    Each dwell frame has room for ``room`` contacts, and each list has room for ``room`` bodies.
    """
    frames = max(1, math.ceil((seconds - ROUNDING_S) / FRAME_S))
    fresh = FrameBuffers(
        np.zeros(frames * room, CONTACT),
        np.zeros(frames, np.int64),
        np.zeros(1, np.int64),
        np.array([0.0, FRAME_S, 0.0, 0.0]),
        np.zeros((7, 1 + room), np.int64),
    )
    if known is not None:
        fresh.contacts.reshape(frames, room)[:, : len(known.contacts) // frames] = known.contacts.reshape(frames, -1)
        fresh.sizes[:], fresh.latest[:], fresh.clock[:] = known.sizes, known.latest, known.clock
    return fresh


def skip_frame(buffers: FrameBuffers, dt: float) -> None:
    """Record a frame of ``dt`` seconds without live bodies and without contacts."""
    buffers.clock[NOW] += dt
    stood = buffers.clock.item(STOOD) + dt
    if stood >= FRAME_S - ROUNDING_S:
        stood = 0.0
        buffers.latest[0] = (buffers.latest.item(0) + 1) % len(buffers.sizes)
    buffers.clock[STOOD] = stood
    buffers.sizes[buffers.latest.item(0)] = 0


@compiled
def _is_gone(bodies: Bodies, body: int) -> bool:
    return bool(body != GROUND and bodies[body].state == ABSENT)


@compiled
def forget_contacts(bodies: Bodies, buffers: FrameBuffers) -> None:
    """Drop the contacts of bodies that left the world, because new bodies may get their rows: O(contacts)."""
    contacts, sizes = buffers.contacts, buffers.sizes
    room = len(contacts) // len(sizes)
    for frame in range(len(sizes)):
        kept = first = frame * room
        for i in range(first, first + sizes[frame]):
            if not (_is_gone(bodies, contacts[i].body_a) or _is_gone(bodies, contacts[i].body_b)):
                contacts[kept] = contacts[i]
                kept += 1
        sizes[frame] = kept - first


@compiled
def next_frame(sizes: IntArray, latest: IntArray, clock: FloatArray, dt: float) -> None:
    """Advance to the next dwell frame if the latest dwell frame is ``FRAME_S`` old.

    Otherwise this frame overwrites the latest dwell frame.
    """
    clock[NOW] += dt
    clock[STOOD] += dt
    clock[LENGTH] = max(dt, FRAME_S)
    if clock[STOOD] >= FRAME_S - ROUNDING_S:
        clock[STOOD] = 0.0
        latest[0] = (latest[0] + 1) % len(sizes)


@compiled
def frames_of(buffers: FrameBuffers, seconds: float) -> int:
    """Return the number of latest dwell frames that span ``seconds``: at least one, and at most all."""
    frames = int(np.ceil((seconds - ROUNDING_S) / buffers.clock[LENGTH]))
    return min(max(1, frames), len(buffers.sizes))


@compiled
def listed(buffers: FrameBuffers, kind: int) -> IntArray:
    """Return the bodies of one list of the latest frame, shape (k,)."""
    ids: IntArray = buffers.worklist[kind, 1 : 1 + buffers.worklist[kind, 0]]
    return ids


@compiled
def frame_before(buffers: FrameBuffers, back: int) -> int:
    """Return the index of the dwell frame that is ``back`` dwell frames before the latest dwell frame."""
    return int((buffers.latest[0] - back) % len(buffers.sizes))
