"""The contacts of the latest frames, because engines drop a contact for a frame while both bodies still touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from bench.welding.settings import CORE
from stability_core.port import Contacts, IntArray
from stability_core.settings import ROUNDING_S


class RecentContacts:
    """Contacts that may carry force, of the frames within the core's ``rest_s``, the latest frame first."""

    def __init__(self) -> None:
        self._frames: list[tuple[float, Contacts]] = []  # age [s] at the latest frame, and contacts

    def add(self, contacts: Contacts, dt: float) -> None:
        """Add the contacts of a frame of ``dt`` seconds; drop the frames that are too old."""
        older = [(age + dt, frame) for age, frame in self._frames if age + dt < CORE.rest_s - ROUNDING_S]
        self._frames = [(0.0, contacts), *older]

    def forget(self, bodies: Sequence[int]) -> None:
        """Drop the contacts of ``bodies`` that have left the world."""
        gone = np.array(bodies, np.int64)
        self._frames = [
            (age, frame.chosen(~(np.isin(frame.body_a, gone) | np.isin(frame.body_b, gone))))
            for age, frame in self._frames
        ]

    def latest_of_pairs(self) -> Contacts:
        """Return the contacts of each pair, without forces, in the latest frame in which the pair had contacts."""
        kept: list[Contacts] = []
        seen: IntArray = np.empty((0, 2), np.int64)
        for _, frame in self._frames:
            pairs = np.sort(np.stack((frame.body_a, frame.body_b), axis=1), axis=1)
            is_new = ~(pairs[:, None, :] == seen[None, :, :]).all(axis=2).any(axis=1)
            if is_new.any():
                kept.append(frame.chosen(is_new))
                seen = np.concatenate((seen, np.unique(pairs[is_new], axis=0)))
        if not kept:
            return Contacts.empty()
        names = [item.name for item in fields(Contacts) if item.name != "force"]
        return Contacts(**{name: np.concatenate([getattr(frame, name) for frame in kept]) for name in names})
