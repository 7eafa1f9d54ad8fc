"""The policy `pile`: bodies inside the angle of repose of their pile freeze, and no others."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Settings, StabilityExtension
from tests.stability_core.dwell import REST_FRAMES

DT = 1 / 60
SETTINGS = Settings()
EDGE, MU = 0.1, 0.45
HALF = EDGE / 2
DWELL = REST_FRAMES + 1


def floor(port, rows: int, aside: float = 0.0, first: int = 0) -> None:
    """A square of rows x rows cubes of 0.1 m on the ground, face to face, its middle ``aside`` along x."""
    for number in range(rows**2):
        row, column = divmod(number, rows)
        x, y, body = aside + (row - (rows - 1) / 2) * EDGE, (column - (rows - 1) / 2) * EDGE, first + number
        port.add(body, (x, y, HALF))
        port.lay(body, GROUND, (x - HALF, x + HALF), (y - HALF, y + HALF), 0.0, friction=MU)
        if row:
            port.touch(body, body - rows, [(x - HALF, y, HALF)], normal=(1.0, 0.0, 0.0))
        if column:
            port.touch(body, body - 1, [(x, y - HALF, HALF)], normal=(0.0, 1.0, 0.0))


def upon(port, body: int, lower: int, x: float, level: int) -> None:
    """A cube on level ``level`` that stands on ``lower``, at x."""
    port.add(body, (x, 0.0, (level - 0.5) * EDGE))
    port.lay(body, lower, (x - HALF, x + HALF), (-HALF, HALF), (level - 1) * EDGE, friction=MU)


def run(extension, frames: int) -> list:
    return [extension.update(DT) for _ in range(frames)]


def test_it_sleeps_below_the_roof_and_not_above(port):
    """On a floor of 7 x 7 cubes the roof is mu * 0.35 m = 0.16 m high in the middle: a cube on the floor lies below
    it, one upon that does not; nor does one on the floor's border, where the roof begins."""
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    upon(port, 101, 100, 0.0, level=3)
    upon(port, 102, 45, 3 * EDGE, level=2)
    run(StabilityExtension(port, "pile"), 4 * DWELL)
    assert port.frozen == {*range(49), 100}


@pytest.mark.parametrize(("mu", "sleeps"), [(0.99 / 3.5, False), (1.01 / 3.5, True)])
def test_the_angle_of_repose_is_that_of_friction(port, mu, sleeps):
    """Its foot is 0.1 m up and 0.35 m from the border: the slope is 1 / 3.5."""
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    port.touches[-1].friction = mu
    run(StabilityExtension(port, "pile"), 3 * DWELL)
    assert (100 in port.frozen) == sleeps


@pytest.mark.parametrize(("slope", "sleeps"), [(0.99 / 3.5, False), (1.01 / 3.5, True)])
@pytest.mark.parametrize("mu", [0.1, 0.9])
def test_the_user_sets_the_angle_of_repose_at_any_friction(port, mu, slope, sleeps):
    """The slope from the border to the foot of the cube is 1 / 3.5, as above."""
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    port.touches[-1].friction = mu
    settings = Settings(repose=float(np.arctan(slope)))
    run(StabilityExtension(port, "pile", settings=settings), 3 * DWELL)
    assert (100 in port.frozen) == sleeps


def test_an_angle_of_repose_in_degrees_is_refused_with_the_unit():
    with pytest.raises(ValueError, match=r"repose must be below pi/2 rad, got 35.0 rad: pass the angle in radians"):
        Settings(repose=35.0)


def test_a_tower_is_no_pile(port):
    port.add(0, (0.0, 0.0, 0.005))
    port.lay(0, GROUND, (-0.05, 0.05), (-0.01, 0.01), 0.0)
    for body in (1, 2):
        port.add(body, (0.0, 0.0, 0.01 * body + 0.005))
        port.lay(body, body - 1, (-0.05, 0.05), (-0.01, 0.01), 0.01 * body)
    run(StabilityExtension(port, "pile"), 5 * DWELL)
    assert port.frozen == {0}


def test_another_pile_is_no_base(port):
    """Side by side, but not in touch: together their roof would carry the cube, alone it is 7 cm high."""
    floor(port, 3)
    floor(port, 3, aside=3.2 * EDGE, first=9)
    upon(port, 100, 4, 0.0, level=2)
    run(StabilityExtension(port, "pile"), 4 * DWELL)
    assert port.frozen == set(range(18))


def test_what_moves_keeps_its_neighbours_awake(port):
    """A cube that slides along the floor's cubes; once it is still, they sleep."""
    floor(port, 3)
    start = port.center[0]
    extension = StabilityExtension(port, "pile")
    for frame in range(3 * DWELL):
        port.center[0] = tuple(np.add(start, (0.0, 3e-4 * (frame % 2), 0.0)))
        extension.update(DT)
    assert port.frozen == {2, 4, 5, 6, 7, 8}, "0 moves; 1 and 3 touch it"
    run(extension, 2 * DWELL)
    assert port.frozen == set(range(9))


def test_it_waits_for_all_that_it_stands_on(port):
    """A plank across two cubes, one of which a user holds: it sleeps when that sleeps, too."""
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    port.lay(100, 31, (HALF, HALF + 0.01), (-HALF, HALF), EDGE, friction=MU)
    extension = StabilityExtension(port, "pile")
    run(extension, 1)
    extension.disturb([31])
    run(extension, 3 * DWELL)
    assert port.frozen == set(range(49)) - {31}
    extension.release([31])
    run(extension, 3 * DWELL)
    assert port.frozen == {*range(49), 100}


def test_it_wakes_when_one_of_its_supports_goes_and_only_then(port):
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    port.lay(100, 31, (HALF, HALF + 0.01), (-HALF, HALF), EDGE, friction=MU)
    extension = StabilityExtension(port, "pile")
    run(extension, 3 * DWELL)
    assert port.frozen == {*range(49), 100}
    port.remove(0)
    assert run(extension, 1)[0].woken == ()
    port.remove(31)
    change = run(extension, 1)[0]
    assert change.woken == (100,)
    assert change.reasons[100] == "unbalanced"


def test_it_wakes_by_an_impact_with_what_rests_on_it(port):
    floor(port, 7)
    upon(port, 100, 24, 0.0, level=2)
    extension = StabilityExtension(port, "pile")
    run(extension, 3 * DWELL)
    port.add(200, (0.0, 0.0, 0.15))
    port.touch(200, 24, [(0.0, 0.0, 0.1)], velocity=(0.0, 0.0, -2.0))
    change = run(extension, 1)[0]
    assert change.reasons[24] == "struck"
    assert change.reasons[100] == "rested on what was struck"
