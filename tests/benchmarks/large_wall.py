"""A wall of some 5,000 planks in running bond, scripted: spawned as a whole, struck, and robbed of a plank."""

from __future__ import annotations

import time
from dataclasses import fields

import numpy as np

from stability_core import GROUND, Contacts, Masses, StabilityExtension
from tests.benchmarks.worlds import ACROSS, DT, LENGTH, MASS, MU, THICKNESS, UP

COURSES, PLACES = 68, 76
"""Number of courses, and of planks in the lowest course. Every second course, also the top one, has a plank less."""
COURSE = np.repeat(np.arange(COURSES), [PLACES - course % 2 for course in range(COURSES)])
PLANKS = len(COURSE)
FIRST = np.searchsorted(COURSE, np.arange(COURSES))
"""First plank of each course."""
GAP = 0.002
"""Gap [m] between the planks of a course, in the wall that is not tight."""
STRIKER = PLANKS


class WallPort:
    """Exact contacts of all planks, without those between bodies that the core has frozen.

    Args:
        gap: gap [m] between the planks of a course. Planks without a gap touch at their ends.
    """

    def __init__(self, gap: float) -> None:
        self.frozen = np.zeros(PLANKS + 1, np.bool_)
        place, pitch = np.arange(PLANKS) - FIRST[COURSE], LENGTH + gap
        self.center = np.column_stack(
            [(place + 0.5 * (COURSE % 2)) * pitch, np.zeros(PLANKS), (COURSE + 0.5) * THICKNESS]
        )
        self.is_there = np.ones(PLANKS, np.bool_)
        self.removed: list[int] = []
        self.blow: list[tuple[int, float]] = []
        """The planks that the striker is about to strike, with its speed [m/s]."""
        rows = [row for body in range(PLANKS) for row in self._below(body, pitch)]
        if gap == 0.0:
            rows += [row for body in range(PLANKS) if body not in FIRST for row in self._beside(body)]
        lower, upper, point, normal = zip(*rows, strict=True)
        self.rows = Contacts(
            np.array(lower),
            np.array(upper),
            np.array(point),
            np.array(normal),
            np.zeros(len(rows)),
            np.zeros((len(rows), 3)),
            np.full(len(rows), MU),
        )

    def _below(self, body: int, pitch: float):
        x, _, z = self.center[body]
        course = COURSE[body]
        if course == 0:
            return [(GROUND, body, (x + i, y, 0.0), UP) for i in (-LENGTH / 2, LENGTH / 2) for y in ACROSS]
        found = []
        for lower in range(FIRST[course - 1], FIRST[course]):
            aside = self.center[lower, 0] - x
            if abs(aside) < 0.6 * pitch:
                low, high = max(-LENGTH / 2, aside - LENGTH / 2), min(LENGTH / 2, aside + LENGTH / 2)
                found += [(lower, body, (x + i, y, z - THICKNESS / 2), UP) for i in (low, high) for y in ACROSS]
        return found

    def _beside(self, body: int):
        x, _, z = self.center[body]
        heights = (z - THICKNESS / 2, z + THICKNESS / 2)
        return [(body - 1, body, (x - LENGTH / 2, y, at), (1.0, 0.0, 0.0)) for y in ACROSS for at in heights]

    def contacts(self) -> Contacts:
        there = np.append(np.append(self.is_there, True), True)  # the striker, and the ground at index -1
        still = np.append(self.frozen, True)
        a, b = self.rows.body_a, self.rows.body_b
        found = self.rows.chosen(there[a] & there[b] & ~(still[a] & still[b]))
        if not self.blow:
            return found
        target, speed = map(np.array, zip(*self.blow, strict=True))
        n = len(target)
        struck = Contacts(
            np.full(n, STRIKER),
            target,
            self.center[target] - (0.0, ACROSS[1], 0.0),
            np.tile((0.0, 1.0, 0.0), (n, 1)),
            np.full(n, 0.5 * speed.max() * DT),
            np.column_stack([np.zeros(n), -speed, np.zeros(n)]),
            np.full(n, MU),
        )
        columns = ((getattr(part, item.name) for part in (found, struck)) for item in fields(Contacts)[:7])
        return Contacts(*(np.concatenate(list(column)) for column in columns))

    def masses(self) -> Masses:
        live = np.flatnonzero(self.is_there & ~self.frozen[:-1])
        center = self.center[live]
        if self.blow:
            live = np.append(live, STRIKER)
            center = np.vstack([center, self.center[self.blow[0][0]] - (0.0, 0.1, 0.0)])
        removed, self.removed = self.removed, []
        return Masses(live, np.full(len(live), MASS), center, removed)

    def sleep(self, bodies) -> None:
        self.frozen[list(bodies)] = True

    def wake(self, bodies) -> None:
        self.frozen[list(bodies)] = False

    def remove(self, body: int) -> None:
        self.is_there[body] = False
        self.frozen[body] = False
        self.removed.append(body)


class FrozenWall:
    """A wall with the extension, and the processor time of the core in each frame so far [ms]."""

    def __init__(self, gap: float) -> None:
        self.port = WallPort(gap)
        self.extension = StabilityExtension(self.port, "equilibrium")
        self.times: list[float] = []

    def frame(self):
        """Play a frame, and time the core without the port."""
        contacts, masses = self.port.contacts(), self.port.masses()
        self.extension.port = _Given(contacts, masses, self.port)
        begin = time.thread_time()
        change = self.extension.update(DT)
        self.times.append(1e3 * (time.thread_time() - begin))
        return change

    def until_frozen(self, most: int = 600) -> None:
        """Play until all planks are frozen.

        Raises:
            AssertionError: if some are live after ``most`` frames.
        """
        for _ in range(most):
            self.frame()
            if self.port.frozen[:-1][self.port.is_there].all():
                return
        raise AssertionError(f"{np.count_nonzero(~self.port.frozen[:-1])} planks are live after {most} frames")


class _Given:
    """Contacts and masses that were made before the core is timed."""

    def __init__(self, contacts: Contacts, masses: Masses, port: WallPort) -> None:
        self._contacts, self._masses, self.sleep, self.wake = contacts, masses, port.sleep, port.wake

    def contacts(self) -> Contacts:
        return self._contacts

    def masses(self) -> Masses:
        return self._masses
