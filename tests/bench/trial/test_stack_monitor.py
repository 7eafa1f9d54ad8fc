"""The watch over a stack, fed with poses that are known."""

from dataclasses import replace

import numpy as np
import pytest

from bench.trial.measure import Plan
from bench.trial.stack_monitor import StackMonitor
from scenarios.planks import THICKNESS, box, lay

FRAME_S = 1 / 60
TOWER = [lay(0.0, level=level) for level in range(1, 11)]


def build(monitor: StackMonitor, levels: int, *, lean_rad_per_frame: float = 0.0, lean_from_level: int = 99) -> None:
    """One brick a second; from ``lean_from_level`` on all bricks turn about y, ever faster, as a falling tower does."""
    for level in range(1, levels + 1):
        plan = Plan.of(TOWER[:level])
        placed = {k: float(k - 1) for k in range(1, level + 1)}
        for frame in range(1, 61):
            angle = lean_rad_per_frame * frame if level >= lean_from_level else 0.0
            quaternion = np.tile([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0], (level, 1))
            monitor.see(level - 1 + frame * FRAME_S, plan, plan.position, quaternion, placed)


def test_a_tower_that_falls_when_its_ninth_brick_lands_has_stood_eight_levels_high() -> None:
    monitor = StackMonitor(creep_from_s=99)
    build(monitor, 9, lean_rad_per_frame=0.01, lean_from_level=9)
    assert monitor.collapse is not None
    assert (monitor.collapse.level, monitor.collapse.kind) == (9, "topple")
    assert monitor.standing is not None
    assert monitor.standing.level == 8
    assert monitor.creep is None


def test_a_level_counts_only_when_it_had_time_to_land() -> None:
    monitor = StackMonitor(creep_from_s=99)
    plan = Plan.of(TOWER[:1])
    monitor.see(0.5, plan, plan.position, plan.quaternion, {1: 0.0})
    assert monitor.standing is None
    monitor.see(1.0, plan, plan.position, plan.quaternion, {1: 0.0})
    assert monitor.standing is not None
    assert monitor.standing.height_m == pytest.approx(THICKNESS)


def test_a_level_is_measured_until_the_next_is_begun() -> None:
    monitor = StackMonitor(creep_from_s=99)
    build(monitor, 2)
    three = Plan.of(TOWER[:3])
    monitor.see(2 + FRAME_S, three, three.position + np.array([5e-3, 0, 0]), three.quaternion, {1: 0.0, 2: 1.0, 3: 2.0})
    assert monitor.standing is not None
    assert (monitor.standing.level, monitor.standing.drift_m) == (2, 0.0)


def test_a_sink_that_turns_into_a_topple_within_the_aftermath_is_a_topple() -> None:
    monitor = StackMonitor(creep_from_s=99)
    plan = Plan.of(TOWER[:2])
    sunk = plan.position - [0, 0, 0.6 * THICKNESS]
    monitor.see(2.0, plan, sunk, plan.quaternion, {1: 0.0, 2: 1.0})
    assert monitor.collapse is not None
    assert monitor.collapse.kind == "sink"
    tipped = np.tile([np.cos(0.2), np.sin(0.2), 0, 0], (2, 1))
    monitor.see(2.5, plan, sunk, tipped, {1: 0.0, 2: 1.0})
    assert (monitor.collapse.time, monitor.collapse.kind) == (2.0, "topple")
    assert not monitor.is_over
    monitor.see(3.0, plan, sunk, tipped, {1: 0.0, 2: 1.0})
    assert monitor.is_over


def test_a_drop_is_no_sink_however_its_aftermath_goes_on() -> None:
    """A brick that lost its support is first seen dropping; on the ground, where it ends, it may count as sunk."""
    monitor = StackMonitor(creep_from_s=99)
    whole = Plan.of(TOWER[1:2])
    plan = replace(whole, drop_below=whole.position[:, 2] - THICKNESS / 2)
    for time, fall in ((2.0, 0.6), (2.1, 1.0)):
        monitor.see(time, plan, plan.position - [0, 0, fall * THICKNESS], plan.quaternion, {1: 0.0, 2: 1.0})
    monitor.see(2.2, whole, whole.position - [0, 0, THICKNESS], whole.quaternion, {1: 0.0, 2: 1.0})
    assert monitor.collapse is not None
    assert (monitor.collapse.time, monitor.collapse.kind) == (2.0, "drop")


def test_large_bricks_are_given_time_to_fall() -> None:
    """A hundred times as large they fall ten times as slowly: times grow as the root of lengths (Froude)."""
    monitor = StackMonitor(creep_from_s=99)
    brick = box((11.7, 2.34, 100 * THICKNESS), 0.0, level=1)
    plan = Plan.of([brick])
    monitor.see(2.0, plan, plan.position - [0, 0, 60 * THICKNESS], plan.quaternion, {1: 0.0})
    monitor.see(11.9, plan, plan.position, plan.quaternion, {1: 0.0})
    assert not monitor.is_over
    monitor.see(12.0, plan, plan.position, plan.quaternion, {1: 0.0})
    assert monitor.is_over


def test_creep_is_measured_over_the_last_half_of_the_watch_only() -> None:
    monitor = StackMonitor(creep_from_s=2.0)
    plan = Plan.of(TOWER[:1])
    for frame in range(1, 241):
        time = frame * FRAME_S
        x = 0.5e-3 * (time - 2.0) if time > 2.0 else 2e-3 * time
        monitor.see(time, plan, plan.position + np.array([x, 0, 0]), plan.quaternion, {1: 0.0})
    assert monitor.creep is not None
    assert monitor.creep.speed_m_s == pytest.approx(0.5e-3)


def test_a_brick_that_goes_where_its_platform_brings_it_does_not_creep() -> None:
    monitor = StackMonitor(creep_from_s=0.0)
    plan = Plan.of(TOWER[:1])
    for frame in range(1, 61):
        carried = replace(plan, position=plan.position + np.array([0.0, 0.0, 0.1 * frame * FRAME_S]))
        monitor.see(frame * FRAME_S, carried, carried.position, plan.quaternion, {1: 0.0})
    assert monitor.creep is not None
    assert monitor.creep.speed_m_s == 0.0


def test_levels_of_a_larger_scene_land_at_its_pace() -> None:
    """A brick ten times as large is let go from ten times as high and lands later."""
    for pace in (1.0, 3.0):
        monitor = StackMonitor(99, pace)
        plan = Plan.of(TOWER[:1])
        monitor.see(0.89 * pace, plan, plan.position, plan.quaternion, {1: 0.0})
        assert monitor.standing is None
        monitor.see(0.91 * pace, plan, plan.position, plan.quaternion, {1: 0.0})
        assert monitor.standing is not None
