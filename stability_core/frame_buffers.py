"""What the core has seen of late: the contacts of the last frames, and what the latest one asks to be decided.

Both are kept in arrays that live from frame to frame: to make an array and hand it from a kernel to Python takes
as long as to filter ten contacts.
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
"""Least time [s] that a dwell frame covers. Of a host at 1 kHz the last of 17 frames is kept: six of them span the true
contact area as they do at 60 Hz, at the same cost."""

STRUCK, AT_REST, LEANING, LYING, GONE, MOVED, PUSHED = range(7)
"""Rows of ``FrameBuffers.worklist``: frozen bodies hit by an impact; live bodies due for the flat and for the leaning
test; live bodies that lie on the stack anew, and those that do so no more; kinematic bodies that began to move, and
frozen bodies that one of them moves; frozen bodies on which a push has changed."""
STOOD, LENGTH, NOW, TOLD = range(4)
"""Entries of ``FrameBuffers.clock``."""


class FrameBuffers(NamedTuple):
    """The dwell frames, of ``FRAME_S`` or of the host if that is slower, and the lists of the latest one."""

    contacts: ContactRows
    """The contacts that count, as many rows of ``CONTACT`` for each frame, shape (frames x room,)."""
    sizes: IntArray
    """How many of the rows of each frame are in use, shape (frames,)."""
    latest: IntArray
    """The latest frame, shape (1,): frames are written in turn."""
    clock: FloatArray
    """For how long [s] the latest frame has stood there; how long one stands at least; time since the first frame [s];
    one if the engine tells contact forces; shape (4,)."""
    worklist: IntArray
    """A list of bodies in each row: how many, then their rows, shape (7, 1 + room)."""


def buffers_for(seconds: float, room: int, known: FrameBuffers | None = None) -> FrameBuffers:
    """Arrays for dwell frames of ``seconds`` in all, with ``room`` contacts and bodies each.

    What is ``known`` is taken over.
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
    """Note a frame of ``dt`` seconds in which nothing is live: it has no contacts."""
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
    """Drop the contacts of bodies that left the world, whose rows other bodies will have: O(contacts)."""
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
    """Go on to the next dwell frame, if the latest has stood for ``FRAME_S``: a faster host writes over it."""
    clock[NOW] += dt
    clock[STOOD] += dt
    clock[LENGTH] = max(dt, FRAME_S)
    if clock[STOOD] >= FRAME_S - ROUNDING_S:
        clock[STOOD] = 0.0
        latest[0] = (latest[0] + 1) % len(sizes)


@compiled
def frames_of(buffers: FrameBuffers, seconds: float) -> int:
    """How many of the latest dwell frames lie in as many ``seconds``: at least one."""
    frames = int(np.ceil((seconds - ROUNDING_S) / buffers.clock[LENGTH]))
    return min(max(1, frames), len(buffers.sizes))


@compiled
def listed(buffers: FrameBuffers, kind: int) -> IntArray:
    """The bodies of one list of the latest frame, shape (k,)."""
    ids: IntArray = buffers.worklist[kind, 1 : 1 + buffers.worklist[kind, 0]]
    return ids


@compiled
def frame_before(buffers: FrameBuffers, back: int) -> int:
    """The row of the frame ``back`` frames before the latest."""
    return int((buffers.latest[0] - back) % len(buffers.sizes))
