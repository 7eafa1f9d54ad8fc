"""Random piles, level and leaning, against linear programmes by HiGHS: code of another kind and by other people.

A pyramid inscribed in the cone proves that a pile stands, one circumscribed that it falls; 32 sides leave half a
percent of friction between the two, where either verdict may be right.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

from stability_core import GROUND, Contacts, Masses, solve_equilibrium

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
MASS = 0.0119
SIDES = 32
UP = (0.0, 0.0, 1.0)


def least_imbalance(contacts: Contacts, masses: Masses, gravity: np.ndarray, stretch: float) -> float:
    """Least sum of unbalanced forces and moments, over all weight; pyramids of mu ``stretch`` times the cone's."""
    n, m = len(masses.body), len(contacts)
    aside = np.eye(3)[np.argmin(np.abs(contacts.normal), axis=1)]
    first = np.cross(contacts.normal, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(contacts.normal, first)
    around = 2 * np.pi * np.arange(SIDES) / SIDES
    tangent = np.cos(around)[:, None, None] * first + np.sin(around)[:, None, None] * second
    edge = (contacts.normal + stretch * contacts.friction[:, None] * tangent).reshape(-1, 3)
    balance = sparse.lil_matrix((6 * n, SIDES * m))
    for sign, bodies in ((-1.0, contacts.body_a), (1.0, contacts.body_b)):
        for body in masses.body:
            columns = np.flatnonzero(np.tile(bodies == body, SIDES))
            lever = np.tile(contacts.point, (SIDES, 1))[columns] - masses.center_of_mass[body]
            part = sign * np.hstack([edge[columns], np.cross(lever, edge[columns]) / LENGTH])
            balance[6 * body : 6 * body + 6, columns] += part.T
    wanted = np.hstack([-masses.mass[:, None] * gravity, np.zeros((n, 3))]).ravel()
    wanted /= np.abs(wanted).sum()
    slack = sparse.identity(6 * n)
    return linprog(
        np.concatenate([np.zeros(SIDES * m), np.ones(12 * n)]),
        A_eq=sparse.hstack([balance, slack, -slack], format="csc"),
        b_eq=wanted,
        method="highs",
    ).fun


class Pile:
    """Bodies and contacts, told one after the other."""

    def __init__(self, friction: float) -> None:
        self.friction = friction
        self.mass, self.center, self.rows = [], [], []

    def add(self, center, mass: float) -> int:
        self.mass.append(mass)
        self.center.append(center)
        return len(self.mass) - 1

    def touch(self, upper: int, lower: int, points, normal=UP) -> None:
        self.rows.extend((lower, upper, point, normal) for point in points)

    def world(self, turn: np.ndarray) -> tuple[Contacts, Masses]:
        """As the core takes it, the whole world turned."""
        lower, upper, point, normal = zip(*self.rows, strict=True)
        n = len(lower)
        return (
            Contacts(
                np.array(lower),
                np.array(upper),
                np.array(point) @ turn.T,
                np.array(normal) @ turn.T,
                np.zeros(n),
                np.zeros((n, 3)),
                np.full(n, self.friction),
            ),
            Masses(np.arange(len(self.mass)), np.array(self.mass), np.array(self.center) @ turn.T),
        )


def overlap(subject: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """What two convex polygons share, shape (k, 2) (Sutherland and Hodgman)."""
    shape = list(subject)
    for a, b in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        normal = np.array([a[1] - b[1], b[0] - a[0]])
        before, shape = shape, []
        for p, q in zip(before, before[1:] + before[:1], strict=True):
            inside_p, inside_q = normal @ (p - a), normal @ (q - a)
            if inside_p >= 0:
                shape.append(p)
            if inside_p * inside_q < 0:
                shape.append(p + (q - p) * (inside_p / (inside_p - inside_q)))
    return np.array(shape).reshape(-1, 2)


def level_pile(random: np.random.Generator) -> Pile:
    """3 to 12 yawed planks let go one after the other: each comes to lie on the highest that is below it."""
    pile, shapes, tops = Pile(random.uniform(0.1, 0.8)), [], []
    spread = random.uniform(0.05, 0.5)
    for body in range(random.integers(3, 13)):
        x, y = random.uniform(-spread, spread, 2) * LENGTH
        yaw = random.choice([random.uniform(0, np.pi), 0.5 * np.pi * random.integers(2)])
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        shape = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2) @ turn + (x, y)
        shared = [overlap(shape, other) for other in shapes]
        bottom = max([top for top, area in zip(tops, shared, strict=True) if len(area) > 2], default=0.0)
        pile.add((x, y, bottom + THICKNESS / 2), MASS * random.uniform(0.8, 1.2))
        if bottom == 0.0:
            pile.touch(body, GROUND, [(*corner, 0.0) for corner in shape])
        for other, area in enumerate(shared):
            if bottom > 0.0 and tops[other] == bottom and len(area) > 2:
                pile.touch(body, other, [(*corner, bottom) for corner in area])
        shapes.append(shape)
        tops.append(bottom + THICKNESS)
    return pile


def jostled_pile(random: np.random.Generator) -> Pile:
    """A level pile in which some planks also press against each other sideways."""
    pile = level_pile(random)
    for _ in range(3):
        a, b = random.choice(len(pile.mass), 2, replace=False)
        azimuth = random.uniform(0, 2 * np.pi)
        middle = (np.array(pile.center[a]) + np.array(pile.center[b])) / 2 + random.normal(0, THICKNESS / 2, 3)
        pile.touch(b, a, [middle], (np.cos(azimuth), np.sin(azimuth), 0.0))
    return pile


def roofed_pair(random: np.random.Generator) -> Pile:
    """Two inverted Vs, and a roof plank somewhere above them."""
    pile = Pile(random.uniform(0.1, 0.8))
    theta = random.uniform(np.radians(50), np.radians(85))
    across = (-DEPTH / 2, DEPTH / 2)
    spread, edge = LENGTH * np.cos(theta), THICKNESS * np.sin(theta)
    ridge, top = LENGTH * np.sin(theta), LENGTH * np.sin(theta) + THICKNESS * np.cos(theta)
    pitch = 2 * spread + random.uniform(0.01, 0.04)
    roof_at = pitch / 2 + random.uniform(-0.05, 0.05)
    edges = []
    for middle in (0.0, pitch):
        for side in (1.0, -1.0):
            foot = middle - side * spread
            body = pile.add((foot + side * (spread - edge) / 2, 0.0, top / 2), MASS)
            pile.touch(body, GROUND, [(foot, y, 0.0) for y in across])
            edges.append((body, middle - side * edge))
        pile.touch(body, body - 1, [(middle, y, ridge) for y in across], (1.0, 0.0, 0.0))
    roof = pile.add((roof_at, 0.0, top + THICKNESS / 2), MASS * random.uniform(0.5, 3.0))
    for body, x in edges:
        if abs(x - roof_at) < LENGTH / 2:
            pile.touch(roof, body, [(x, y, top) for y in across])
    return pile


@pytest.mark.parametrize("make", [level_pile, jostled_pile, roofed_pair])
@pytest.mark.parametrize("slope", [0.0, 0.25])
def test_no_verdict_contradicts_the_linear_programmes(make, slope):
    """20 piles of a kind, in any orientation, on the level and on slopes; only a jam of friction may be a doubt."""
    for seed in range(20):
        random = np.random.default_rng([seed, int(100 * slope)])
        pile = make(random)
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        turn *= np.linalg.det(turn)
        angle, azimuth = random.uniform(0, slope), random.uniform(0, 2 * np.pi)
        fall = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), -np.cos(angle)])
        contacts, masses = pile.world(turn)
        found = solve_equilibrium(contacts, masses, 9.81 * turn @ fall)
        case = f"{make.__name__} {seed}: {found.verdict}, residual {found.residual:.1e}"
        if found.forces is None:
            assert found.verdict == "unstable", case
            outer = least_imbalance(contacts, masses, turn @ fall, 1 / np.cos(np.pi / SIDES))
            inner = outer if outer > 1e-6 else least_imbalance(contacts, masses, turn @ fall, 1.0)
            assert inner > 1e-6, case
        else:
            assert least_imbalance(contacts, masses, turn @ fall, 1 / np.cos(np.pi / SIDES)) < 1e-6, case
