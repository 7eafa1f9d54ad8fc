"""Slight overlaps and gaps of imported bodies: removed up to a tolerance, refused beyond it."""

import pytest

from scenarios.formats.imported import Imported, ImportRefusedError
from scenarios.formats.settling import GAP, OVERLAP, settled
from scenarios.model import Brick, World
from scenarios.solids import sphere

CUBE = (0.1, 0.1, 0.1)


def content(*positions, world=None):
    bricks = tuple(Brick(CUBE, 1.0, position) for position in positions)
    return Imported("mine", world or World(), bricks, tuple(f"cube {k}" for k in range(len(bricks))))


def test_the_lowest_body_comes_first_and_each_touches_exactly():
    found = settled(content((0, 0, 0.158), (0, 0, 0.0495)))
    assert found.names == ("cube 1", "cube 0")
    assert [brick.position[2] for brick in found.bricks] == pytest.approx([0.05, 0.15], abs=1e-9)
    assert len(found.notes) == 2
    assert "cube 0 moved by (0.000, 0.000, -8.000) mm" in found.notes[1]


def test_neighbours_that_overlap_move_apart_sideways():
    found = settled(content((0, 0, 0.05), (0.0995, 0, 0.05)))
    assert [brick.position[0] for brick in found.bricks] == pytest.approx([0.0, 0.1], abs=1e-9)


def test_a_sphere_sinks_onto_a_fixed_sphere():
    world = World(fixed=(sphere(0.05, position=(0, 0, 0.05), mass=1.0),))
    ball = sphere(0.05, position=(0.0, 0.0, 0.155), mass=1.0)
    found = settled(Imported("mine", world, (ball,), ("ball",)))
    assert found.bricks[0].position[2] == pytest.approx(0.15, abs=1e-9)


def test_exact_bodies_stay_to_the_bit():
    exact = content((0, 0, 0.05), (0, 0, 0.15000000000000002))
    assert settled(exact).notes == ()


@pytest.mark.parametrize(
    ("height", "message"),
    [
        (0.15 - 2 * OVERLAP, "cube 1 overlaps cube 0 by 2.000 mm, more than 1 mm: move the bodies apart"),
        (0.15 + 2 * GAP, "cube 1 floats 20.0 mm above cube 0, more than 10 mm: lower cube 1"),
    ],
)
def test_more_is_refused(height, message):
    with pytest.raises(ImportRefusedError, match=message):
        settled(content((0, 0, 0.05), (0, 0, height)))
