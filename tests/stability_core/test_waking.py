"""Waking follows what rests on a body, not what touches it."""

from __future__ import annotations

import math

import pytest

from stability_core import GROUND, StabilityExtension

DT = 1 / 60
X, Y = (-0.06, 0.06), (-0.01, 0.01)
ASIDE = (1.0, 0.0, 0.0)
REST_FRAMES = 8


def columns(port, levels: int, count: int = 2, friction: float = 0.45) -> None:
    """Columns of blocks side by side, each of which touches the next one at every level."""
    for column in range(count):
        for level in range(levels):
            body, x, z = levels * column + level, 0.12 * column, 0.02 * level
            port.add(body, (x, 0.0, z + 0.01))
            port.lay(body, body - 1 if level else GROUND, [x + i for i in X], Y, z, friction=friction)
            if column > 0:
                side = [(x - 0.06, y, z + k) for y in Y for k in (0.0, 0.02)]
                port.touch(body, body - levels, side, normal=ASIDE, friction=friction)


@pytest.fixture
def extension(port):
    made = StabilityExtension(port, "equilibrium")
    yield made
    made.close()


def freeze(port, extension) -> None:
    for _ in range(REST_FRAMES):
        extension.update(DT)
    assert port.frozen == port.mass.keys()


def test_the_column_beside_stays_frozen(port, extension):
    columns(port, 5)
    freeze(port, extension)
    assert extension.wake([1]).woken == (1, 2, 3, 4), "the blocks above, and no block of the column beside"


def test_a_body_that_stays_frozen_forgets_the_contact_and_is_judged_without_it(port, extension):
    columns(port, 5)
    freeze(port, extension)
    extension.wake([0])
    for body in range(5):
        x, y, z = port.center[body]
        port.center[body] = (x - 1.0, y, z)
    port.touches = [touch for touch in port.touches if touch.lower not in range(5) and touch.upper not in range(5)]
    for level in range(5):
        port.lay(level, level - 1 if level else GROUND, [i - 1.0 for i in X], Y, 0.02 * level)
    assert extension.update(DT).woken == ()
    for _ in range(4 * REST_FRAMES):
        extension.update(DT)
    assert port.frozen == port.mass.keys(), "the column stands a metre away"
    assert extension.wake([0, 1]).woken == (0, 1, 2, 3, 4)
    port.remove(5)
    assert extension.update(DT).woken == (6, 7, 8, 9)


def test_every_body_of_a_column_wakes_with_its_foot(port, extension):
    columns(port, 5, count=1)
    freeze(port, extension)
    assert extension.wake([0]).woken == (0, 1, 2, 3, 4)


def test_a_body_wakes_with_the_body_that_holds_it_from_the_side(port, extension):
    """A block clamped between two columns hangs on their friction: it rests on both, although no contact is level."""
    for body, x in ((0, -0.08), (1, 0.08)):
        port.add(body, (x, 0.0, 0.05), mass=5.0)
        port.lay(body, GROUND, [x - 0.02, x + 0.02], Y, 0.0, friction=0.9)
    wedge = math.sin(0.3), math.cos(0.3)
    port.add(2, (0.0, 0.0, 0.06), mass=0.1)
    port.touch(2, 0, [(-0.06, y, z) for y in Y for z in (0.05, 0.07)], normal=(wedge[1], 0.0, wedge[0]), friction=0.9)
    port.touch(2, 1, [(0.06, y, z) for y in Y for z in (0.05, 0.07)], normal=(-wedge[1], 0.0, wedge[0]), friction=0.9)
    for _ in range(3 * REST_FRAMES):
        extension.update(DT)
    assert 2 in port.frozen
    assert extension.wake([0]).woken == (0, 2)


def test_a_column_at_rest_freezes_in_one_frame(port, extension):
    columns(port, 40, count=1)
    changes = [extension.update(DT).frozen for _ in range(REST_FRAMES)]
    assert [frozen for frozen in changes if frozen] == [tuple(range(40))]


def test_a_column_freezes_up_to_a_body_that_the_user_holds(port, extension):
    columns(port, 6, count=1)
    extension.update(DT)
    extension.disturb([3])
    for _ in range(90):
        extension.update(DT)
    assert port.frozen == {0, 1, 2}
    extension.release([3])
    for _ in range(REST_FRAMES):
        extension.update(DT)
    assert port.frozen == port.mass.keys()


def test_tables_grow_with_faces_not_with_points(port, extension):
    """A block on 400 points needs as many rows as a block on four."""
    grid = [0.006 * k - 0.06 for k in range(20)]
    for body in range(30):
        x = 0.5 * body
        port.add(body, (x, 0.0, 0.01))
        port.touch(body, GROUND, [(x + i, j / 6, 0.0) for i in grid for j in grid])
    freeze(port, extension)
    assert len(extension._world.graph.patches) <= 1024
