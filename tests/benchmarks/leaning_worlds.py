"""Worlds of leaning planks and random piles, scripted, and the cost of each plank."""

from __future__ import annotations

import time

import numpy as np

from stability_core import GROUND, Contacts, Masses, Settings, StabilityExtension
from tests.stability_core.dwell import REST_FRAMES
from tests.stability_core.piles import overlap

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
MASS = 0.0119
MU = 0.45
DT = 1 / 60
UP = (0.0, 0.0, 1.0)
ACROSS = (-DEPTH / 2, DEPTH / 2)
SETTINGS = Settings()


class World:
    """Live planks with exact contacts; the arrays of a frame are made before the frame is timed."""

    def __init__(self) -> None:
        self.center: dict[int, tuple[float, ...]] = {}
        self.mass: dict[int, float] = {}
        """Of what weighs other than a plank [kg]."""
        self.rows: list[tuple] = []
        self.frozen: set[int] = set()
        self.removed: list[int] = []

    def place(self, group) -> None:
        """Add planks, each as (id, centre, rows of (lower, upper, point, normal, friction))."""
        for body, center, rows in group:
            self.center[body] = center
            self.rows += rows
        self.refresh()

    def remove(self, body: int) -> None:
        del self.center[body]
        self.rows = [row for row in self.rows if body not in row[:2]]
        self.removed.append(body)
        self.refresh()

    def refresh(self) -> None:
        live = sorted(self.center.keys() - self.frozen)
        self.weight = Masses(
            np.array(live, np.int64),
            np.array([self.mass.get(body, MASS) for body in live]),
            np.array([self.center[body] for body in live]).reshape(-1, 3),
            self.removed,
        )
        self.removed = []
        touching = [row for row in self.rows if not {row[0], row[1]} <= self.frozen | {GROUND}]
        n = len(touching)
        if n == 0:
            self.touch = Contacts.empty()
            return
        lower, upper, point, normal, friction = zip(*touching, strict=True)
        self.touch = Contacts(
            np.array(lower),
            np.array(upper),
            np.array(point),
            np.array(normal),
            np.zeros(n),
            np.zeros((n, 3)),
            np.array(friction),
        )

    def contacts(self) -> Contacts:
        return self.touch

    def masses(self) -> Masses:
        return self.weight

    def sleep(self, bodies) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies) -> None:
        self.frozen.difference_update(bodies)


class Stopwatch:
    """Times single frames by the thread's own clock, which other processes do not turn; keeps each plank's longest."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.extension = StabilityExtension(world, "equilibrium")
        self.longest: list[float] = []

    def grow(self, group) -> None:
        """Place a group and wait until it is frozen, or refused twice."""
        self.world.place(group)
        longest = 0.0
        for _ in range(2 * REST_FRAMES + 2):
            start = time.thread_time()
            change = self.extension.update(DT)
            longest = max(longest, time.thread_time() - start)
            if change.frozen or change.woken:
                self.world.refresh()
            if {body for body, *_ in group} <= self.world.frozen:
                break
        self.longest.append(longest)
        self.world.refresh()


def card(body: int, foot_x: float, ridge_x: float, bottom: float, stand: int, friction: float = MU):
    """A plank of 70 deg that stands on ``stand``: (id, centre, rows)."""
    height = LENGTH * np.sin(THETA) + THICKNESS * np.cos(THETA)
    outward = np.sign(foot_x - ridge_x)
    center = ((foot_x + ridge_x + outward * EDGE) / 2, 0.0, bottom + height / 2)
    return body, center, [(stand, body, (foot_x, y, bottom), UP, friction) for y in ACROSS]


THETA = np.radians(70.0)
EDGE = THICKNESS * np.sin(THETA)
SPREAD = LENGTH * np.cos(THETA)
STOREY = LENGTH * np.sin(THETA) + THICKNESS * np.cos(THETA)
PITCH = 0.1


def inverted_v(first: int, x: float, bottom: float, stand: int, friction: float = MU):
    """Two planks that lean against each other above ``x``."""
    left = card(first, x - SPREAD, x, bottom, stand, friction)
    right = card(first + 1, x + SPREAD, x, bottom, stand, friction)
    ridge = bottom + LENGTH * np.sin(THETA)
    right[2].extend((first, first + 1, (x, y, ridge), (1.0, 0.0, 0.0), friction) for y in ACROSS)
    return [left, right]


def house(storeys: int):
    """A card house from the ground up, in the order of building: a list of groups that are placed at once.

    A roof reaches over both edges of each of its two ridges; where two roofs meet, each is halved in depth.
    """
    groups, body = [], 0
    stands = [GROUND] * storeys
    for storey in range(storeys):
        bottom = storey * (STOREY + THICKNESS)
        count = storeys - storey
        ridges = [(index - (count - 1) / 2) * PITCH for index in range(count)]
        first = body
        for x, stand in zip(ridges, stands, strict=True):
            groups.append(inverted_v(body, x, bottom, stand))
            body += 2
        top = bottom + STOREY
        stands = []
        for index in range(count - 1):
            rows = []
            for end, depth in ((0, (-DEPTH / 2, 0.0)), (1, (0.0, DEPTH / 2))):
                ridge = index + end
                is_outermost = ridge in (0, count - 1)
                for side, aside in ((0, -EDGE), (1, EDGE)):
                    lower = first + 2 * ridge + side
                    rows += [
                        (lower, body, (ridges[ridge] + aside, y, top), UP, MU)
                        for y in (ACROSS if is_outermost else depth)
                    ]
            middle = (ridges[index] + ridges[index + 1]) / 2
            groups.append([(body, (middle, 0.0, top + THICKNESS / 2), rows)])
            stands.append(body)
            body += 1
    return groups


def house_of(storeys: int, groups: int | None = None) -> Stopwatch:
    """A card house as it has been built, up to group number ``groups`` or whole."""
    watch = Stopwatch(World())
    for group in house(storeys)[:groups]:
        watch.grow(group)
    return watch


def smooth_v(first: int):
    """A V whose feet find no grip on the topmost roof of a house of 7 storeys."""
    return inverted_v(first, 0.0, 7 * (STOREY + THICKNESS), 97, friction=0.05)


def refuse_smooth_v(watch: Stopwatch, first: int) -> None:
    """Lay a V that must slip on a house of 7 storeys, see it refused twice, and take it away."""
    standing = set(watch.world.frozen)
    watch.grow(smooth_v(first))
    assert watch.world.frozen == standing, "it stays live, and all else frozen"
    for body in watch.world.center.keys() - standing:
        watch.world.remove(body)
        watch.extension.update(DT)


def overload(body: int):
    """A brick as heavy as 20 planks on one card of the topmost V of a house of 8 storeys."""
    top = 7 * (STOREY + THICKNESS) + STOREY
    return [(body, (EDGE, 0.0, top + THICKNESS / 2), [(99, body, (EDGE, y, top), UP, MU) for y in ACROSS])]


def corners(x: float, y: float, yaw: float) -> np.ndarray:
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2) @ turn + (x, y)


def pile_up(seed: int, planks: int) -> Stopwatch:
    """A pile grown plank by plank: each is let go at random over the same patch and lies on the highest below it.

    What does not freeze is taken away.
    """
    random = np.random.default_rng(seed)
    watch = Stopwatch(World())
    shapes: dict[int, tuple[np.ndarray, float]] = {}
    for body in range(planks):
        x, y = random.uniform(-1.5, 1.5, 2) * LENGTH
        shape = corners(x, y, random.uniform(0.0, np.pi))
        shared = {other: overlap(shape, below) for other, (below, _) in shapes.items()}
        bottom = max((shapes[other][1] for other, area in shared.items() if len(area) > 2), default=0.0)
        rows = [(GROUND, body, (*corner, 0.0), UP, MU) for corner in shape] if bottom == 0.0 else []
        for other, area in shared.items():
            if bottom > 0.0 and shapes[other][1] == bottom and len(area) > 2:
                rows += [(other, body, (*corner, bottom), UP, MU) for corner in area]
        watch.grow([(body, (x, y, bottom + THICKNESS / 2), rows)])
        shapes[body] = (shape, bottom + THICKNESS)
        for loose in watch.world.center.keys() - watch.world.frozen:
            watch.world.remove(loose)
            watch.extension.update(DT)
            del shapes[loose]
    return watch
