"""What ``attach`` costs, against the suite's adapter: run by hand with ``uv run pytest -m slow``."""

from __future__ import annotations

import pytest

from tests.benchmarks.attach_cost import SUITE, measure

MOST = 1.10
"""Greatest ratio of a frame's CPU time with ``attach`` to the time with the suite's adapter."""


@pytest.mark.slow
@pytest.mark.parametrize("engine", SUITE)
def test_a_frame_costs_at_most_a_tenth_more_than_with_the_suites_adapter(engine: str) -> None:
    """The ratio of medians in one run, frame by frame in turns; the best of three runs, because others use the CPU."""
    runs = [measure(engine) for _ in range(3)]
    ratios = {kind: min(run[kind].ratio for run in runs) for kind in runs[0]}
    assert max(ratios.values()) <= MOST, ratios
