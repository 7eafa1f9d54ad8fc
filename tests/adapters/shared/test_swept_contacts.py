"""Where and when boxes that fly will meet: by geometry, against what a plain simulation of the flight finds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters.shared.contact_completion import BoxTable
from scenarios.geometry import Boxes
from stability_core.port import Contacts

CUBE = (0.04, 0.04, 0.04)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
AHEAD_S = 1 / 30


def ahead(places, turns, velocities, sizes=(CUBE, CUBE), live=(0, 1), contacts: Contacts | None = None) -> Contacts:
    table = BoxTable()
    for body, size in enumerate(sizes):
        table.add(body, size)
    bodies = np.arange(len(sizes))
    table.place(bodies, np.array(places, float), np.array(turns, float))
    known = contacts or Contacts.empty()
    return table.with_approaching(known, np.array(live, np.int64), bodies, np.array(velocities, float), AHEAD_S, 0.5)


def about(axis: int, degrees: float) -> tuple[float, ...]:
    half = math.radians(degrees) / 2
    quaternion = [math.cos(half), 0.0, 0.0, 0.0]
    quaternion[1 + axis] = math.sin(half)
    return tuple(quaternion)


def test_two_cubes_face_to_face() -> None:
    """30 mm apart at 2 m/s: they meet after 15 ms, in the middle of their faces."""
    found = ahead([(0, 0, 0), (0.07, 0, 0)], [UPRIGHT, UPRIGHT], [(0, 0, 0), (-2, 0, 0)])
    assert (found.body_a.tolist(), found.body_b.tolist()) == ([0], [1])
    assert found.separation == pytest.approx([0.03])
    assert found.normal[0] == pytest.approx([1, 0, 0])
    assert found.point[0] == pytest.approx([0.02, 0, 0])
    assert found.relative_velocity[0] == pytest.approx([-2, 0, 0])


def test_a_corner_meets_a_face_where_it_points() -> None:
    """A cube that stands on its edge about y falls on a plate: its lowest edge, in the middle, is where they meet."""
    found = ahead(
        [(0, 0, 0), (0.03, 0, 0.06)], [UPRIGHT, about(1, 45)], [(0, 0, 0), (0, 0, -2)], sizes=((0.2, 0.2, 0.02), CUBE)
    )
    assert found.separation == pytest.approx([0.06 - 0.01 - 0.02 * math.sqrt(2)])
    assert found.normal[0] == pytest.approx([0, 0, 1])
    assert found.point[0] == pytest.approx([0.03, 0, 0.01])


def test_edge_meets_edge_at_their_crossing() -> None:
    """Two cubes on edge, one about x and one about y: the lower ridge and the upper one cross above the origin."""
    reach = 0.02 * math.sqrt(2)
    found = ahead([(0, 0, 0), (0, 0, 2 * reach + 0.02)], [about(0, 45), about(1, 45)], [(0, 0, 0), (0, 0, -2)])
    assert found.separation == pytest.approx([0.02])
    assert found.normal[0] == pytest.approx([0, 0, 1])
    assert found.point[0] == pytest.approx([0, 0, reach])


@pytest.mark.parametrize(
    ("place", "velocity"),
    [
        ((0.07, 0, 0), (2, 0, 0)),  # flies away
        ((0.07, 0.05, 0), (-2, 0, 0)),  # passes by
        ((0.07, 0, 0), (-0.8, 0, 0)),  # comes too late
        ((0.041, 0, 0), (-0.1, 0, 0)),  # is slow: the engine sees it in time
        ((0.03, 0, 0), (-2, 0, 0)),  # overlaps already: the engine lists it
    ],
)
def test_nothing_is_listed_for_what_does_not_strike(place, velocity) -> None:
    assert len(ahead([(0, 0, 0), place], [UPRIGHT, UPRIGHT], [(0, 0, 0), velocity])) == 0


def test_pairs_that_are_listed_or_not_live_are_left_alone() -> None:
    places, turns, velocities = [(0, 0, 0), (0.07, 0, 0)], [UPRIGHT, UPRIGHT], [(0, 0, 0), (-2, 0, 0)]
    once = ahead(places, turns, velocities)
    assert len(ahead(places, turns, velocities, contacts=once)) == 1
    assert len(ahead(places, turns, velocities, live=())) == 0, "of each pair one body must be live"


def test_two_fast_bodies_are_listed_once() -> None:
    found = ahead([(0, 0, 0), (0.1, 0, 0)], [UPRIGHT, UPRIGHT], [(1.5, 0, 0), (-1.5, 0, 0)])
    assert len(found) == 1
    assert found.separation == pytest.approx([0.06])


def test_random_flights_agree_with_boxes_moved_in_small_steps() -> None:
    """The truth is found by moving the boxes on by 0.5 ms until no axis parts them; grazing flights are left out."""
    draw, strikes = np.random.default_rng(3), 0
    for _ in range(120):
        turns = draw.normal(size=(2, 4))
        turns /= np.linalg.norm(turns, axis=1)[:, None]
        places = np.array([(0, 0, 0), draw.normal(size=3) * 0.06])
        velocity = draw.normal(size=3) * 2.0
        gaps = [parting(places + np.array([(0, 0, 0), velocity * t]), turns) for t in np.arange(0, AHEAD_S, 5e-4)]
        if gaps[0] <= 0 or abs(min(gaps)) < 1e-3:
            continue
        found = ahead(places, turns, [(0, 0, 0), velocity])
        assert len(found) == (min(gaps) < 0)
        strikes += len(found)
    assert strikes > 10, "the flights must not all miss"


def parting(places: np.ndarray, turns: np.ndarray) -> float:
    """Widest gap [m] over the 15 axes that may part two cubes; negative if they overlap."""
    corners = Boxes.at(np.array([CUBE, CUBE]), places, turns).corners
    axes = [np.array(rotation(turn)).T for turn in turns]
    every = [*axes[0], *axes[1], *(np.cross(u, v) for u in axes[0] for v in axes[1])]
    widest = -np.inf
    for axis in every:
        length = np.linalg.norm(axis)
        if length > 1e-3:
            along = corners @ (axis / length)
            widest = max(widest, along[1].min() - along[0].max(), along[0].min() - along[1].max())
    return widest


def rotation(quaternion: np.ndarray) -> list[list[float]]:
    w, x, y, z = quaternion
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
