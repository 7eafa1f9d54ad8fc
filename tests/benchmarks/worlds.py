"""Scripted worlds, whose arrays are made beforehand, so that the port costs the core nothing."""

from __future__ import annotations

import numpy as np

from stability_core import GROUND, Change, Contacts, Masses, StabilityExtension
from tests.stability_core.dwell import REST_FRAMES

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
MASS = 0.0119
MU = 0.45
DT = 1 / 60
UP = (0.0, 0.0, 1.0)
ACROSS = (-DEPTH / 2, DEPTH / 2)
CORNERS = np.array([(x, y, 0.0) for x in (-LENGTH / 2, LENGTH / 2) for y in ACROSS])
NO_CONTACT = Contacts.empty()
NO_MASS = Masses(np.empty(0, np.int64), np.empty(0), np.empty((0, 3)))


def contacts_of(rows) -> Contacts:
    lower, upper, point, normal = zip(*rows, strict=True)
    n = len(rows)
    return Contacts(
        np.array(lower),
        np.array(upper),
        np.array(point),
        np.array(normal, float),
        np.zeros(n),
        np.zeros((n, 3)),
        np.full(n, MU),
    )


def rectangle(x, y, z, lower, upper):
    return [(lower, upper, (x + i, y + j, z), UP) for i in ACROSS for j in ACROSS]


def plank_of_four_stack(body: int):
    """Two planks a level, each level across the one below: centre and contacts of plank ``body``."""
    level, side = divmod(body, 2)
    reach = (LENGTH - DEPTH) / 2 * (2 * side - 1)
    z = level * THICKNESS
    along_x = level % 2 == 0
    center = (0.0, reach, z + THICKNESS / 2) if along_x else (reach, 0.0, z + THICKNESS / 2)
    rows = []
    for end in (0, 1):
        at = (LENGTH - DEPTH) / 2 * (2 * end - 1)
        lower = GROUND if level == 0 else 2 * (level - 1) + end
        rows += rectangle(*((at, reach) if along_x else (reach, at)), z, lower, body)
    return center, rows


def plank_of_wall(body: int):
    """A wall of four planks a course in running bond, every second course half a plank further: centre and contacts."""
    course, place = divmod(body, 4)
    x, z = (place + 0.5 * (course % 2)) * LENGTH, course * THICKNESS
    center = (x, 0.0, z + THICKNESS / 2)
    if course == 0:
        return center, [(GROUND, body, (x + i, y, z), UP) for i in (-LENGTH / 2, LENGTH / 2) for y in ACROSS]
    below = {body - 4: 0.25 if course % 2 == 0 else -0.25}
    neighbour = place - 1 if course % 2 == 0 else place + 1
    if 0 <= neighbour < 4:
        below[(course - 1) * 4 + neighbour] = -below[body - 4]
    return center, [
        (lower, body, (x + aside * LENGTH + i, y, z), UP)
        for lower, aside in below.items()
        for i in (-LENGTH / 4, LENGTH / 4)
        for y in ACROSS
    ]


class _Port:
    """Obeys sleep and wake."""

    def __init__(self) -> None:
        self.frozen: set[int] = set()

    def sleep(self, bodies) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies) -> None:
        self.frozen.difference_update(bodies)


class GrowingPort(_Port):
    """A stack of frozen planks with one live plank on it."""

    def __init__(self, plank) -> None:
        super().__init__()
        self.plank = plank

    def place(self, body: int) -> None:
        self.live = body
        center, rows = self.plank(body)
        self.touch = contacts_of(rows)
        self.weight = Masses(np.array([body]), np.array([MASS]), np.array([center]))

    def contacts(self) -> Contacts:
        return NO_CONTACT if self.live in self.frozen else self.touch

    def masses(self) -> Masses:
        return NO_MASS if self.live in self.frozen else self.weight


class GrowingStack:
    """A frozen stack that grows plank by plank from ``n`` planks on, and begins anew when it is a quarter larger.

    Args: plank: centre and contacts of a plank, by its number.
    """

    def __init__(self, plank, n: int, policy: str) -> None:
        self.plank, self.n, self.policy = plank, n, policy
        self.height = np.inf

    def place_one_more(self) -> None:
        """Put a plank on a stack of ``n`` to 1.25 ``n`` planks, all of them frozen."""
        if self.height >= 1.25 * self.n:
            self.port = GrowingPort(self.plank)
            self.extension = StabilityExtension(self.port, self.policy)
            for body in range(self.n):
                self.port.place(body)
                self.until_joined()
            self.height = self.n
        self.port.place(self.height)
        self.height += 1

    def until_it_joins(self) -> None:
        """A new plank, up to the last frame before it freezes."""
        self.place_one_more()
        for _ in range(REST_FRAMES):
            assert not self.frame().frozen

    def frame(self) -> Change:
        return self.extension.update(DT)

    def until_joined(self) -> None:
        while not self.frame().frozen:
            pass

    def check(self) -> None:
        assert self.port.frozen == set(range(self.height)), "no plank was left out and none woke"


class CarpetPort(_Port):
    """``live`` planks on a table, a contact at each corner: all at rest, or all sliding to and fro."""

    def __init__(self, live: int, is_moving: bool) -> None:
        super().__init__()
        self.is_moving = is_moving
        self.lay(0, live)

    def lay(self, first: int, live: int) -> None:
        """Show ``live`` planks with ids from ``first``, and no others: those are frozen."""
        ids = np.arange(first, first + live)
        n = live * len(CORNERS)
        place = np.column_stack([0.2 * ids, np.zeros((live, 2))])
        self.touch = Contacts(
            np.full(n, GROUND),
            np.repeat(ids, len(CORNERS)),
            (place[:, None] + CORNERS).reshape(-1, 3),
            np.tile(UP, (n, 1)),
            np.zeros(n),
            np.zeros((n, 3)),
            np.full(n, MU),
        )
        self.weight = Masses(ids, np.full(live, MASS), place + np.array([0.0, 0.0, THICKNESS / 2]))

    def contacts(self) -> Contacts:
        return self.touch

    def masses(self) -> Masses:
        if self.is_moving:
            self.weight.center_of_mass[:, 1] = 0.002 - self.weight.center_of_mass[:, 1]
        return self.weight


class FacePort(_Port):
    """A plate at rest on a floor that it touches in about ``points`` points, the corners of a grid.

    As long as it is live both are listed.
    """

    def __init__(self, points: int) -> None:
        super().__init__()
        side = round(points**0.5)
        x, y = np.meshgrid(np.linspace(-0.05, 0.05, side), np.linspace(-0.01, 0.01, points // side))
        point = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
        self.touch = Contacts(
            np.full(x.size, GROUND),
            np.zeros(x.size, np.int64),
            point,
            np.tile(UP, (x.size, 1)),
            np.zeros(x.size),
            np.zeros((x.size, 3)),
            np.full(x.size, MU),
        )
        self.weight = Masses(np.zeros(1, np.int64), np.full(1, MASS), np.array([[0.0, 0.0, THICKNESS / 2]]))

    def contacts(self) -> Contacts:
        return Contacts.empty() if self.frozen else self.touch

    def masses(self) -> Masses:
        return Masses(np.empty(0, np.int64), np.empty(0), np.empty((0, 3))) if self.frozen else self.weight


def quiet(frozen: int, policy: str, live: int = 1) -> StabilityExtension:
    """``frozen`` planks and ``live`` ones that never come to rest."""
    port = CarpetPort(10, is_moving=False)
    extension = StabilityExtension(port, policy)
    while len(port.frozen) < frozen:
        port.lay(len(port.frozen), min(100, frozen - len(port.frozen)))
        for _ in range(REST_FRAMES + 1):
            extension.update(DT)
    port.is_moving = True
    port.lay(frozen, live)
    extension.update(DT)
    return extension


def coming_to_rest(live: int, policy: str) -> StabilityExtension:
    """``live`` planks, in the last frame before all of them freeze."""
    extension = StabilityExtension(CarpetPort(live, is_moving=False), policy)
    for _ in range(REST_FRAMES):
        assert not extension.update(DT).frozen
    return extension
