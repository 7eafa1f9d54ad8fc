"""What a wall of 5,000 planks costs: ``uv run pytest --benchmark-only -m slow tests/benchmarks/test_wall_speed.py``."""

from __future__ import annotations

import pytest

from tests.benchmarks.large_wall import COURSES, FIRST, GAP, PLACES, FrozenWall

pytestmark = pytest.mark.slow
GAPS = {"tight": 0.0, "with gaps": GAP}


@pytest.fixture(scope="module", params=GAPS.values(), ids=GAPS)
def wall(request) -> FrozenWall:
    """A wall that has frozen in place."""
    frozen = FrozenWall(request.param)
    frozen.until_frozen()
    return frozen


@pytest.mark.parametrize("gap", GAPS.values(), ids=GAPS)
def test_spawn(benchmark, gap):
    """All planks are there from the first frame on. Target: 100 ms for the longest frame."""
    FrozenWall(gap).frame()  # warms up
    spawned = FrozenWall(gap)
    benchmark.pedantic(spawned.until_frozen, rounds=1, iterations=1)
    benchmark.extra_info["longest frame until all are frozen [ms of CPU]"] = round(max(spawned.times), 2)
    benchmark.extra_info["frames until all are frozen"] = len(spawned.times)


@pytest.mark.parametrize("course", [COURSES - 1, COURSES // 2, 0])
def test_a_plank_is_taken(wall, benchmark, course):
    """From the top, the middle and the lowest course. Target: 5 ms for the longest of the next twelve frames."""
    wall.port.remove(FIRST[course] + PLACES // 2)
    wall.times.clear()
    woken = []
    benchmark.pedantic(lambda: woken.extend(wall.frame().woken), rounds=12, iterations=1)
    benchmark.extra_info["longest frame [ms of CPU]"] = round(max(wall.times), 2)
    benchmark.extra_info["woken"] = len(woken)
    if course == COURSES - 1:
        assert not woken, "nothing rests on a plank of the top course"


def test_a_blow(wall, benchmark):
    """A cube strikes the wall's face at a third of its height, at 10 m/s. Target: 100 ms."""
    wall.port.blow = [(FIRST[COURSES // 3] + PLACES // 4, 10.0)]
    wall.times.clear()
    woken = []
    benchmark.pedantic(lambda: woken.extend(wall.frame().woken), rounds=1, iterations=1)
    wall.port.blow = []
    benchmark.extra_info["frame of the blow [ms of CPU]"] = round(wall.times[0], 2)
    benchmark.extra_info["woken"] = len(woken)
    assert woken
