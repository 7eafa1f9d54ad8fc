"""The loop of the welding policies on a world by hand: two planks, of which the upper rests on the lower."""

from collections.abc import Iterable

import numpy as np
import pytest

from bench.welding import WeldExtension
from stability_core.port import GROUND, Contacts, Masses

LENGTH, WIDTH, THICKNESS = 0.117, 0.0234, 0.0078
FRAME_S = 1 / 60
DWELL = 7
"""Frames until two planks at rest are joined: the first only shows where they are, and six are the time at rest."""


class TwoPlanks:
    """A port whose upper plank may be shifted, be lost for a frame, or be struck."""

    def __init__(self) -> None:
        self.shift = 0.0
        self.shows_upper_contact = True
        self.approach = 0.0
        self.is_upper_gone = False
        self.joined: set[tuple[int, int]] = set()

    def contacts(self) -> Contacts:
        pairs = [(GROUND, 0, 0.0)]
        if self.shows_upper_contact and not self.is_upper_gone:
            pairs.append((0, 1, THICKNESS))
        low, high = -LENGTH / 2 + self.shift, LENGTH / 2
        corners = [
            (a, b, (x, y, z))
            for a, b, z in pairs
            for x in ((-high, high) if b == 0 else (low, high))
            for y in (-WIDTH / 2, WIDTH / 2)
        ]
        count = len(corners)
        velocity = np.array([(0.0, 0.0, -self.approach if b == 1 else 0.0) for _, b, _ in corners])
        return Contacts(
            np.array([a for a, _, _ in corners]),
            np.array([b for _, b, _ in corners]),
            np.array([corner for _, _, corner in corners]),
            np.tile((0.0, 0.0, 1.0), (count, 1)),
            np.zeros(count),
            velocity,
            np.full(count, 0.45),
        )

    def masses(self) -> Masses:
        centers = [(0.0, 0.0, THICKNESS / 2), (self.shift, 0.0, 1.5 * THICKNESS)]
        count = 1 if self.is_upper_gone else 2
        return Masses(np.arange(count), np.ones(count), np.array(centers[:count]), [1] if self.is_upper_gone else [])

    def sleep(self, bodies) -> None: ...

    def wake(self, bodies) -> None: ...

    def join(self, pairs: Iterable[tuple[int, int]]) -> None:
        self.joined.update(pairs)

    def part(self, pairs: Iterable[tuple[int, int]]) -> None:
        self.joined.difference_update(pairs)


@pytest.fixture
def world() -> tuple[TwoPlanks, WeldExtension]:
    """Return a port and its extension, once both planks are joined."""
    port = TwoPlanks()
    extension = WeldExtension(port, "carried", (0.0, 0.0, -9.81))
    for _ in range(12):
        extension.update(FRAME_S)
    assert port.joined == {(0, 1)}
    return port, extension


def test_planks_are_joined_once_they_have_rested_for_the_dwell_time() -> None:
    port = TwoPlanks()
    extension = WeldExtension(port, "carried", (0.0, 0.0, -9.81))
    changes = [extension.update(FRAME_S) for _ in range(DWELL + 5)]
    frames = [frame for frame, change in enumerate(changes, 1) if change.joined]
    assert len(frames) == 1
    assert DWELL <= frames[0] <= DWELL + 5, "at the first review after the dwell time"
    assert changes[frames[0] - 1].joined == ((0, 1),)


def test_a_prebuilt_stack_is_joined_at_once() -> None:
    port = TwoPlanks()
    change = WeldExtension(port, "carried", (0.0, 0.0, -9.81)).adopt([0, 1])
    assert change.joined == ((0, 1),)
    assert port.joined == {(0, 1)}


def test_a_plank_beyond_its_balance_is_never_joined() -> None:
    port = TwoPlanks()
    port.shift = 0.6 * LENGTH
    extension = WeldExtension(port, "carried", (0.0, 0.0, -9.81))
    assert not any(extension.update(FRAME_S).joined for _ in range(30))


def test_a_contact_missed_for_a_frame_parts_nothing(world) -> None:
    port, extension = world
    for frame in range(30):
        port.shows_upper_contact = frame % 3 > 0
        assert not extension.update(FRAME_S).parted


def test_a_lost_support_parts(world) -> None:
    port, extension = world
    port.shows_upper_contact = False
    changes = [extension.update(FRAME_S) for _ in range(20)]
    assert [pair for change in changes for pair in change.parted] == [(0, 1)]
    assert any("out of balance" in change.reasons.values() for change in changes)
    assert port.joined == set()


@pytest.mark.parametrize(("approach", "parts"), [(0.4, False), (1.0, True)])
def test_a_fast_strike_parts_at_once(world, approach, parts) -> None:
    """The limit is 0.5 m/s for a plank; three frames of gravity, 0.49 m/s, are below it."""
    port, extension = world
    port.approach = approach
    change = extension.update(FRAME_S)
    assert bool(change.parted) == parts
    assert bool(change.reasons) == parts


def test_a_held_plank_is_parted_until_it_has_rested_again(world) -> None:
    port, extension = world
    extension.disturb([1])
    assert port.joined == set()
    assert extension.update(FRAME_S).parted == ((0, 1),)
    assert not any(extension.update(FRAME_S).joined for _ in range(30))
    extension.release([1])
    assert any(extension.update(FRAME_S).joined for _ in range(12))


def test_joints_of_a_removed_body_are_forgotten(world) -> None:
    port, extension = world
    port.is_upper_gone = True
    change = extension.update(FRAME_S)
    assert not change.parted, "the port has parted it"
    assert extension.joined == set()


def test_gravity_that_turns_parts_what_no_longer_balances(world) -> None:
    _, extension = world
    extension.gravity = (9.81, 0.0, -0.5)
    changes = [extension.update(FRAME_S) for _ in range(3)]
    assert any(change.parted for change in changes)
