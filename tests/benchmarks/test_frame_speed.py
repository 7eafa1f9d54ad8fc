"""What a frame costs, with and without the extension: run with ``uv run pytest --benchmark-only``.

A frame is the engine's step and, with the extension, its update: reading contacts and masses, the core, freezing and
waking. Not included: placing planks, reading poses, drawing. The clock is the wall's.

With the extension a round is a frame of a second in which the topmost plank of a tower lands, comes to rest and
freezes. Without it a round is a frame of the same tower at the same poses, all awake, while it stands. So the ratio of
both means is ``frame_ratio``, as ``bench.trial.awake_baseline`` defines it. Both are also played in turns: ``alone_ms``
has the median time of a frame without the extension just before each second with it, so that a machine whose speed
changes from second to second does not change their ratio. ``bench compare`` compares these ratios.
"""

from __future__ import annotations

import statistics
from dataclasses import fields

import pytest

from adapters import ENGINES
from bench.compare.benchmarks import FORMAT
from bench.machine.environment import engine_version
from bench.trial.stepping import FrameTimes
from tests.benchmarks.towers import PROFILE, SCENE, AwakeTower, SteeredTower, Tower

pytestmark = pytest.mark.benchmark(disable_gc=True)
LEVELS = (5, 10, 25)
POLICIES = ("none", "equilibrium")
SECONDS = {"none": 5, "equilibrium": 20}
"""Each second with the extension gives a frame ratio, from whose spread ``bench compare`` makes its interval."""


def open_tower(engine: str, levels: int, policy: str) -> Tower:
    return AwakeTower(engine, levels) if policy == "none" else SteeredTower(engine, levels, policy)


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("engine", ENGINES)
def test_a_frame(benchmark, engine, levels, policy) -> None:
    """Targets of the ratio at 25 levels: 0.05 on Bullet, MuJoCo and DART, 0.06 on PhysX, 0.2 on Rapier."""
    if not benchmark.enabled and levels > LEVELS[0]:
        pytest.skip("taller towers are built only to be timed: --benchmark-only")
    tower = open_tower(engine, levels, policy)
    try:
        if not tower.stands:
            pytest.skip(f"{levels} planks fall at once without the extension")
        benchmark.group = f"a frame of {engine}, {levels:2d} levels"
        benchmark.extra_info |= {
            "format": FORMAT,
            "engine": engine,
            "version": engine_version(engine),
            "profile": PROFILE,
            "scene": SCENE,
            "levels": levels,
            "policy": policy,
            "frames_per_second": tower.frames_per_second,
        }
        benchmark.pedantic(tower.frame, setup=tower.begin, rounds=SECONDS[policy] * tower.frames_per_second)
        benchmark.extra_info["calibration_ms"] = tower.calibration_ms
        benchmark.extra_info["mean_ms"] = mean_ms(tower.times)
        if isinstance(tower, SteeredTower):
            benchmark.extra_info["alone_ms"] = tower.alone_ms
        assert tower.stands or policy == "none"
    finally:
        tower.close()


def mean_ms(times: list[FrameTimes]) -> dict[str, float]:
    """Mean time [ms] of each part of a frame that was timed: a bridge is not where there is none."""
    parts = {part.name: [getattr(frame, part.name) for frame in times] for part in fields(FrameTimes)}
    return {name: statistics.fmean(seconds) * 1e3 for name, seconds in parts.items() if None not in seconds}
