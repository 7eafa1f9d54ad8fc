"""The sleep audit counts the time in which a brick that must move keeps its pose, and no other."""

import math

import numpy as np
import pytest

from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial
from bench.trial.sleep_audit import SleepAudit
from reports.records.trial import TrialRecord
from reports.tables.sleep_audit import sleep_tables
from scenarios.model import MustMove
from scenarios.registry import build

FRAME_S = 1 / 60


def audited(heights: list[float], due: MustMove) -> SleepAudit:
    """One brick at these heights [m], a frame each."""
    audit = SleepAudit([due])
    for frame, height in enumerate(heights):
        pose = np.array([0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0])
        audit.see(frame * FRAME_S, (frame + 1) * FRAME_S, {due.brick: pose})
    return audit


def test_a_brick_that_keeps_its_pose_sleeps_until_it_has_gone_its_way() -> None:
    heights = [1.0] * 10 + [1.0 - 0.01 * step for step in range(1, 21)] + [0.8] * 30
    audit = audited(heights, MustMove(0, 5 * FRAME_S, 0.0999, None))
    assert audit.asleep_s == pytest.approx(5 * FRAME_S), "frames 5 to 9; neither before nor after"
    assert audit.moved_after_s == pytest.approx(15 * FRAME_S)


def test_a_brick_that_never_moves_sleeps_to_the_end_and_one_that_creeps_by_a_bit_does_not() -> None:
    still = audited([1.0] * 61, MustMove(0, 0.0, 0.1, None))
    assert still.asleep_s == pytest.approx(1.0), "of the first frame nothing is known"
    assert still.moved_after_s is None
    creeping = [1.0]
    for _ in range(60):
        creeping.append(math.nextafter(creeping[-1], 0.0))
    assert audited(creeping, MustMove(0, 0.0, 0.1, None)).asleep_s == 0.0


def played(policy: str, scenario: str, **parameters) -> TrialRecord:
    variant = build(scenario, **parameters).variant
    trial = Trial("physx", "game", scenario, variant, parameters, policy, 0, 0)
    return run_trial(trial, Limits(trial_wall_s=600), "abc", lambda _: None).record


def test_a_slow_post_sleeps_by_physx_own_rule_and_not_without_it() -> None:
    """The post is slower than its threshold for longer than its rule waits."""
    records = [played(policy, "tipping_post", beyond=0.05) for policy in ("none", "native")]
    alone, native = records
    assert alone.asleep_s == 0.0
    assert alone.moved_after_s == pytest.approx(1.673, abs=0.03)
    assert native.asleep_s is not None
    assert native.asleep_s > 4.0
    assert native.moved_after_s is None
    assert native.verdict == "false_stand"
    (table,) = sleep_tables(records)
    assert table.rows == (
        ("tipping_post-0.05", "physx", "game", "1.67", "0.00, 1.67", f"{native.asleep_s:.2f}, never"),
    )
