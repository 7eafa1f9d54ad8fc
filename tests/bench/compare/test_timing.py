"""The timing gate: shares of a frame that a machine's speed cannot change, and an interval that says how sure it is."""

import numpy as np
import pytest

from bench.compare.timing import LEAST_PAIRS, interval, judge_times, shares
from reports.records.frames import FrameRow

LEAST = 0.1


def rows(count: int, speed, core_ms: float = 0.05, engine_ms: float = 0.1) -> list[FrameRow]:
    """Frames of a machine that takes ``speed(frame)`` times as long."""
    return [
        FrameRow(
            frame, frame / 60, 1, 4, 1, engine_ms * speed(frame), 0.2 * speed(frame), 8, 0.03 * speed(frame),
            core_ms * speed(frame), 0.0, 0, 0, "",
        )
        for frame in range(count)
    ]  # fmt: skip


def test_a_share_does_not_depend_on_how_fast_the_machine_is_from_frame_to_frame() -> None:
    draw = np.random.default_rng(0).lognormal(sigma=1, size=500)
    found = shares(rows(500, lambda frame: draw[frame]), 495)
    assert found == pytest.approx({"engine": 1.0, "readback": 0.3, "core": 0.5})


def test_interruptions_of_every_third_frame_leave_the_share_as_it_was() -> None:
    """An interruption falls into one part of a frame; the median passes over such frames."""
    disturbed = [
        row._replace(core_ms=9.0) if row.frame % 6 == 0 else row._replace(engine_ms=9.0) if row.frame % 6 == 3 else row
        for row in rows(500, lambda _: 1.0)
    ]
    assert shares(disturbed, 495)["core"] == pytest.approx(0.5)


def test_too_few_frames_and_trials_without_an_extension_have_no_share() -> None:
    assert shares(rows(30, lambda _: 1.0), 25) == {}
    plain = [row._replace(core_ms=None, readback_ms=None) for row in rows(500, lambda _: 1.0)]
    assert shares(plain, 495) == {}


def test_the_interval_holds_the_true_ratio_as_often_as_it_says() -> None:
    """Of 2,000 draws of 5 pairs with a spread of 5 %: 99 %, within three standard deviations (0.7 %)."""
    draw = np.random.default_rng(1)
    held = 0
    for _ in range(2000):
        base, head = np.exp(draw.normal(0, 0.05, 5)), 1.2 * np.exp(draw.normal(0, 0.05, 5))
        found = interval(list(zip(base.tolist(), head.tolist(), strict=True)))
        held += found.low <= 1.2 <= found.high
    assert held / 2000 == pytest.approx(0.99, abs=0.007)


@pytest.mark.parametrize(
    ("ratio", "spread", "judgement"),
    [
        (1.0, 0.01, "same"),
        (1.2, 0.01, "worse"),
        (0.8, 0.01, "better"),
        (1.05, 0.005, "same"),  # slower, but by less than counts
        (1.2, 0.2, "open"),  # undecided
        (1.0, 0.2, "open"),
    ],
)
def test_worse_is_only_what_is_surely_slower_by_more_than_the_least_effect(ratio, spread, judgement) -> None:
    pairs = [(1.0, ratio * (1 + sign * spread)) for sign in (-1, 1, -1, 1)]
    assert judge_times(pairs, LEAST)[0] == judgement


def test_too_few_pairs_decide_nothing() -> None:
    judgement, message = judge_times([(1.0, 2.0)] * (LEAST_PAIRS - 1), LEAST)
    assert judgement == "open"
    assert "undecided" in message
    with pytest.raises(ValueError, match="at least 3 pairs"):
        interval([(1.0, 2.0)])
