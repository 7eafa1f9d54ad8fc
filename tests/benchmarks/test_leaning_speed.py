"""What one plank more costs where planks lean: ``uv run pytest --benchmark-only -m slow``."""

from __future__ import annotations

import numpy as np
import pytest

from tests.benchmarks.leaning_worlds import MASS, Stopwatch, house_of, overload, pile_up, refuse_smooth_v

pytestmark = pytest.mark.slow


def report(watch: Stopwatch, benchmark) -> None:
    benchmark.extra_info["longest frame of a plank [ms of CPU], p50, p99, max"] = [
        round(1e3 * float(np.percentile(watch.longest, share)), 3) for share in (50, 99, 100)
    ]


def test_card_house(benchmark):
    """One V or roof more, up to 8 storeys of 100 planks; the time of a round is that of building all of it."""
    watches = []
    benchmark.pedantic(lambda: watches.append(house_of(8)), rounds=3, iterations=1)
    all_of_them = watches[0]
    for watch in watches[1:]:
        all_of_them.longest += watch.longest
    assert all_of_them.world.frozen == set(range(100)), "it stands"
    report(all_of_them, benchmark)


def test_a_refusal_on_a_card_house(benchmark):
    """A V that must slip, on a house of 7 storeys. Target: 20 ms."""
    watch = house_of(8, -1)
    watch.longest.clear()
    fresh = iter(range(200, 10_000, 2))
    benchmark.pedantic(lambda: refuse_smooth_v(watch, next(fresh)), rounds=20, iterations=1, warmup_rounds=2)
    report(watch, benchmark)


def test_an_overload_off_centre_on_a_card_house(benchmark):
    """The other card of the V slips, and the V wakes."""
    watch = house_of(8)
    watch.longest.clear()
    watch.world.mass[200] = 20 * MASS
    benchmark.pedantic(lambda: watch.grow(overload(200)), rounds=1, iterations=1)
    assert 200 not in watch.world.frozen
    assert watch.world.frozen < set(range(100))
    report(watch, benchmark)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_pile(benchmark, seed):
    """A hundred planks are let go, refusals included; the time of a round is that of building the whole pile.

    Target: 5 ms for the longest frame of 99 in 100 planks.
    """
    watches = []
    benchmark.pedantic(lambda: watches.append(pile_up(seed, 100)), rounds=1, iterations=1, warmup_rounds=1)
    report(watches[-1], benchmark)
    benchmark.extra_info["planks that stand"] = len(watches[-1].world.frozen)
