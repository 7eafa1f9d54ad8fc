"""What the core has seen of late: the contacts of the last frames, and what the latest one asks to be decided.

Both are kept in arrays that live from frame to frame: to make an array and hand it from a kernel to Python takes
as long as to filter ten contacts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import CONTACT, ContactRows
from stability_core.port import IntArray

STRUCK, AT_REST, LEANING, LYING, GONE = range(5)
"""Rows of ``Watch.due``: frozen bodies hit by an impact; live bodies due for the flat and for the leaning test; live
bodies that lie on the stack anew, and those that do so no more."""


class Watch(NamedTuple):
    """The dwell frames, and the lists of the latest one."""

    contacts: ContactRows
    """The contacts that count, as many rows of ``CONTACT`` for each frame, shape (frames x room,)."""
    sizes: IntArray
    """How many of the rows of each frame are in use, shape (frames,)."""
    latest: IntArray
    """The latest frame, shape (1,): frames are written in turn."""
    due: IntArray
    """A list of bodies in each row: how many, then their ids, shape (5, 1 + room)."""


def watch_for(frames: int, room: int, known: Watch | None = None) -> Watch:
    """Arrays for ``frames`` dwell frames with ``room`` contacts and bodies each, with what is ``known`` taken over."""
    fresh = Watch(
        np.zeros(frames * room, CONTACT),
        np.zeros(frames, np.int64),
        np.zeros(1, np.int64),
        np.zeros((5, 1 + room), np.int64),
    )
    if known is not None:
        fresh.contacts.reshape(frames, room)[:, : len(known.contacts) // frames] = known.contacts.reshape(frames, -1)
        fresh.sizes[:], fresh.latest[:] = known.sizes, known.latest
    return fresh


def skip_frame(watch: Watch) -> None:
    """Note a frame in which nothing is live: it has no contacts."""
    latest = (watch.latest.item(0) + 1) % len(watch.sizes)
    watch.latest[0], watch.sizes[latest] = latest, 0


@compiled
def listed(watch: Watch, kind: int) -> IntArray:
    """The bodies of one list of the latest frame, shape (k,)."""
    ids: IntArray = watch.due[kind, 1 : 1 + watch.due[kind, 0]]
    return ids


@compiled
def frame_before(watch: Watch, back: int) -> int:
    """The row of the frame ``back`` frames before the latest."""
    return int((watch.latest[0] - back) % len(watch.sizes))
