"""Creep: a slope of the position, with an interval that trembling cannot make certain."""

from dataclasses import replace

import numpy as np
import pytest

from adapters import open_engine
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import run_trial as trials
from bench.trial.creep import LEAST_FRAMES, QUANTILE, CreepMeter, creep_of
from reports.records.creep import CREEP_LIMIT_PER_MIN, creep_limit_m_s, is_creeping
from scenarios.planks import THICKNESS
from scenarios.registry import build

FRAME_S = 1 / 60
LIMIT_M_S = creep_limit_m_s(THICKNESS)


def times(seconds: float) -> np.ndarray:
    return np.arange(1, round(seconds / FRAME_S) + 1) * FRAME_S


def moving(seconds: float, *velocities) -> np.ndarray:
    """Bricks that stand a brick's height above each other and move evenly, shape (m, n, 3)."""
    start = np.arange(1, len(velocities) + 1)[:, None] * [0.1, -0.2, THICKNESS]
    return start + times(seconds)[:, None, None] * np.array(velocities)


def trembling(seconds: float, amplitude: float, period_s: float, seed: int = 0) -> np.ndarray:
    """A brick that sways at about a period: a damped oscillator that noise drives, shape (m, 3)."""
    rng = np.random.default_rng(seed)
    count, settle = round(seconds / FRAME_S), 2000
    pull, damping = (2 * np.pi / period_s) ** 2, 0.5
    place, speed, kept = 0.0, 0.0, []
    for kick in rng.standard_normal(count + settle):
        speed += FRAME_S * (-pull * place - damping * speed) + np.sqrt(FRAME_S) * kick
        place += FRAME_S * speed
        kept.append(place)
    sway = np.array(kept[settle:])
    return np.outer(amplitude * sway / np.std(kept), [1.0, 0.0, 0.0])


def test_an_even_motion_is_its_own_slope_and_has_no_error() -> None:
    bricks = moving(2.5, (3e-6, 4e-6, 0), (0, 0, -7e-6), (0, 0, 0))
    creep = creep_of(times(2.5), bricks, np.full(3, THICKNESS))
    assert (creep.speed_m_s, creep.sliding_m_s, creep.sinking_m_s) == pytest.approx((7e-6, 5e-6, 7e-6))
    assert creep.error_m_s < 1e-12
    assert creep.thickness_m == THICKNESS


def test_what_never_moves_has_a_creep_of_exactly_zero() -> None:
    """As a frozen stack: its positions are the same numbers in every frame."""
    creep = creep_of(times(2.5), moving(2.5, (0, 0, 0), (0, 0, 0)), np.array([THICKNESS, 1.0]))
    assert (creep.speed_m_s, creep.error_m_s, creep.sliding_m_s, creep.sinking_m_s) == (0.0, 0.0, 0.0, 0.0)


def test_the_brick_that_counts_is_the_fastest_for_its_thickness() -> None:
    """A cube of a metre may creep 128 times as fast as a plank of 7.8 mm."""
    creep = creep_of(times(2.5), moving(2.5, (2e-6, 0, 0), (100e-6, 0, 0)), np.array([THICKNESS, 1.0]))
    assert (creep.speed_m_s, creep.thickness_m) == (pytest.approx(2e-6), THICKNESS)
    assert creep.sliding_m_s == pytest.approx(100e-6)
    assert is_creeping(creep.speed_m_s, creep.error_m_s, LIMIT_M_S)


def test_the_limit_is_one_percent_of_a_thickness_a_minute() -> None:
    assert CREEP_LIMIT_PER_MIN == 0.01
    assert pytest.approx(0.01 * THICKNESS / 60) == LIMIT_M_S
    assert not is_creeping(LIMIT_M_S, 0.0, LIMIT_M_S)
    assert not is_creeping(2 * LIMIT_M_S, 1.1 * LIMIT_M_S, LIMIT_M_S)


def test_the_quantile_is_that_of_series_without_a_slope() -> None:
    """20,000 series of 150 independent numbers: the 95 % point of the ratio is then known to 2 %."""
    rng, time = np.random.default_rng(1), np.arange(150) - 74.5
    noise = rng.standard_normal((20_000, 150))
    slope = noise @ time / (time @ time)
    residual = noise - noise.mean(1)[:, None] - np.outer(slope, time)
    partial = np.cumsum(residual * time, axis=1)
    error = np.sqrt(2 / 150 * (partial**2).sum(1)) / (time @ time)
    assert np.quantile(np.abs(slope) / error, 0.95) == pytest.approx(QUANTILE, rel=0.02)


def test_a_stack_that_sways_does_not_creep() -> None:
    """It sways by 20 um, once in 0.8 s, as PhysX's tower of ten planks does: a bare slope exceeds the limit often."""
    measured = [
        creep_of(times(2.5), trembling(2.5, 20e-6, 0.8, seed)[:, None], np.array([THICKNESS])) for seed in range(40)
    ]
    assert sum(creep.speed_m_s > LIMIT_M_S for creep in measured) > 20
    assert sum(is_creeping(creep.speed_m_s, creep.error_m_s, LIMIT_M_S) for creep in measured) <= 4


def test_a_stack_that_sways_and_creeps_is_found() -> None:
    sway = trembling(30.0, 20e-6, 0.8)[:, None]
    creep = creep_of(times(30.0), moving(30.0, (5e-6, 0, 0)) + sway, np.array([THICKNESS]))
    assert creep.speed_m_s == pytest.approx(5e-6, abs=creep.error_m_s)
    assert is_creeping(creep.speed_m_s, creep.error_m_s, LIMIT_M_S)


def test_a_stack_that_has_settled_before_the_last_half_does_not_creep() -> None:
    """It settles by 0.1 mm with a time constant of 0.4 s; 2.5 s after its last brick 0.2 um are left."""
    time = times(5.0)
    position = np.outer(1e-4 * np.exp(-time / 0.4), [0.0, 0.0, 1.0])[:, None]
    meter = CreepMeter(2.5)
    for now, place in zip(time, position, strict=True):
        meter.see(now, place)
    creep = meter.measure(np.array([THICKNESS]))
    assert creep is not None
    assert not is_creeping(creep.speed_m_s, creep.error_m_s, LIMIT_M_S)


def test_only_the_last_half_is_measured_and_too_few_frames_are_none() -> None:
    meter = CreepMeter(2.5)
    time, bricks = times(5.0), moving(5.0, (1e-3, 0, 0))
    bricks[time > 2.5] = bricks[-1]
    for frame in range(150 + LEAST_FRAMES - 1):
        meter.see(time[frame], bricks[frame])
    assert meter.measure(np.array([THICKNESS])) is None
    meter.see(time[150 + LEAST_FRAMES - 1], bricks[-1])
    creep = meter.measure(np.array([THICKNESS]))
    assert creep is not None
    assert creep.speed_m_s == 0.0


@pytest.mark.parametrize("planted_m_s", [0.0, 1e-6])
def test_a_planted_creep_of_a_micrometre_a_second_is_found(monkeypatch, planted_m_s: float) -> None:
    """In an adapter that moves its topmost brick by 60 um in 60 s; the solver moves it by less than a tenth of that."""

    def open_mutant(*arguments, **options):
        simulation = open_engine(*arguments, **options)
        poses, frames = simulation.poses, [0]

        def crept():
            bodies, position, quaternion = poses()
            frames[0] += 1
            position = np.array(position)
            position[-1:, 0] += planted_m_s * frames[0] * simulation.info.frame_s
            return bodies, position, quaternion

        simulation.poses = crept
        return simulation

    scene = replace(build("plank_tower", levels=2), watch_s=60.0)
    monkeypatch.setattr(trials, "open_engine", open_mutant)
    monkeypatch.setattr(Trial, "build_scene", lambda _: scene)
    trial = Trial("mujoco", "game", "plank_tower", "plank_tower-2", {"levels": 2}, "none", 0, 0)
    record = trials.run_trial(trial, Limits(trial_wall_s=600, creep_per_min=0.005), "abc", lambda _: None).record
    assert record.creep_m_s is not None
    assert record.creep_error_m_s is not None
    assert record.creep_m_s == pytest.approx(planted_m_s, abs=0.1e-6)
    assert (record.creep_m_s > record.creep_error_m_s) == (planted_m_s > 0) or record.creep_m_s < 0.1e-6
    assert record.verdict == ("creeps" if planted_m_s else "right")


@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_a_frozen_stack_has_a_creep_of_zero(policy: str) -> None:
    trial = Trial("bullet", "game", "plank_tower", "plank_tower-2", {"levels": 2}, policy, 0, 0)
    record = trials.run_trial(trial, Limits(ratio=False), "abc", lambda _: None).record
    assert (record.live_last, record.creep_m_s, record.creep_error_m_s) == (0, 0.0, 0.0)
    assert record.verdict == "right"
