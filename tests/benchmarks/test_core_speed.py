"""What the core costs: run with ``uv run pytest --benchmark-only``.

The clock is the thread's own: on a machine that others share, the wall clock measures their load. The targets are
those of ``tests.benchmarks.core_speed``, which writes the published page.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

from stability_core import StabilityExtension
from tests.benchmarks.worlds import (
    DT,
    CarpetPort,
    FacePort,
    GrowingStack,
    coming_to_rest,
    plank_of_four_stack,
    plank_of_wall,
    quiet,
)
from tests.stability_core.dwell import REST_FRAMES

pytestmark = pytest.mark.benchmark(group="the core", timer=time.thread_time, disable_gc=True)
POLICIES = ["paper", "equilibrium"]


@pytest.mark.parametrize("frozen", [10, 100, 1000, 10_000])
@pytest.mark.parametrize("policy", POLICIES)
def test_quiet_frame(benchmark, policy, frozen):
    """One live brick that touches the stack, nothing to decide. Target: 30 us, the same for any number frozen."""
    extension = quiet(frozen, policy)
    change = benchmark(extension.update, DT)
    assert not change.frozen
    assert not change.woken
    assert len(extension.frozen) == frozen


@pytest.mark.parametrize("plank", [plank_of_four_stack, plank_of_wall])
@pytest.mark.parametrize(
    ("policy", "n"),
    [
        *(("equilibrium", n) for n in (12, 100, 1000)),
        *(("paper", n) for n in (12, 100)),
        pytest.param("paper", 1000, marks=pytest.mark.slow),  # to build it takes seconds
    ],
)
def test_one_plank_more(benchmark, policy, plank, n):
    """The frame in which a plank joins. Targets for ``equilibrium``: see the page.

    There a safe region decides, O(1). ``paper`` has carried the plank's weight down to the ground some frames before,
    when it came to lie on the stack: O(cone below) in that frame.
    """
    stack = GrowingStack(plank, n, policy)
    benchmark.pedantic(stack.frame, setup=stack.until_it_joins, rounds=300)
    if benchmark.stats:
        benchmark.extra_info["p99 [us]"] = 1e6 * np.percentile(benchmark.stats.stats.data, 99)
    stack.check()


@pytest.mark.parametrize("policy", POLICIES)
def test_a_hundred_moving_bricks(benchmark, policy):
    """All are tracked and their 400 contacts filtered. Target: 0.4 ms."""
    extension = StabilityExtension(CarpetPort(100, is_moving=True), policy)
    assert not benchmark(extension.update, DT).frozen


@pytest.mark.parametrize("policy", POLICIES)
def test_a_hundred_bricks_come_to_rest_at_once(benchmark, policy):
    """The worst frame for them: each is decided, on the contacts of six frames. Target: 0.4 ms."""
    change = benchmark.pedantic(
        lambda extension: extension.update(DT), setup=lambda: ((coming_to_rest(100, policy),), {}), rounds=50
    )
    assert len(change.frozen) == 100


@pytest.mark.parametrize("points", [100, 1000, 10_000])
def test_a_face_of_many_points(benchmark, points):
    """The dearest frame of a plate that comes to rest on so many points. Target: 5 ms for 10,000."""

    def come_to_rest() -> StabilityExtension:
        extension = StabilityExtension(FacePort(points), "equilibrium")
        for _ in range(REST_FRAMES):
            assert not extension.update(DT).frozen
        return extension

    change = benchmark.pedantic(
        lambda extension: extension.update(DT), setup=lambda: ((come_to_rest(),), {}), rounds=20
    )
    assert change.frozen == (0,)
