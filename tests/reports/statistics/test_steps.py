"""Steps of synthetic histories: planted steps are found at their version, and flat histories have none."""

import numpy as np
import pytest

from reports.statistics.steps import find_steps

SEED = 24
"""Named before the first run: the number of the issue that asks for these histories."""
VERSIONS, PLANTED, FLAT = 40, 20, 50
LEVELS, CREEP, TIME = 9.0, 5e-6, 0.8
TIME_NOISE = 0.01
"""Noise of frame times from version to version on a quiet machine, as a share."""
CREEP_NOISE = 0.1
"""Noise of the creep of an engine that does not repeat itself, as a share."""
LOUD_TIME = 0.12
"""Noise of frame times on a machine that runs other work, as a share: five releases of SAPIEN with the same poses
differed by 12 % beside six other jobs."""


def levels(random: np.random.Generator) -> np.ndarray:
    return np.full(VERSIONS, LEVELS)


def creep(random: np.random.Generator) -> np.ndarray:
    return CREEP * np.exp(random.normal(0, CREEP_NOISE, VERSIONS))


def time(random: np.random.Generator, noise: float = TIME_NOISE) -> np.ndarray:
    return TIME * np.exp(random.normal(0, noise, VERSIONS))


def less_a_level(values: np.ndarray) -> np.ndarray:
    return values - 1


def doubled(values: np.ndarray) -> np.ndarray:
    return 2 * values


def slower(values: np.ndarray) -> np.ndarray:
    return 1.05 * values


KINDS = {"levels": (levels, less_a_level), "creep": (creep, doubled), "time": (time, slower)}


@pytest.mark.parametrize("kind", KINDS)
def test_a_planted_step_is_found_at_its_version_in_19_of_20(kind) -> None:
    make, changed = KINDS[kind]
    random, found = np.random.default_rng(SEED), 0
    for _ in range(PLANTED):
        values, at = make(random), int(random.integers(5, VERSIONS - 5))
        values[at:] = changed(values[at:])
        found += find_steps(values.tolist(), kind) == [at]
    assert found >= 19


@pytest.mark.parametrize("kind", KINDS)
def test_flat_histories_have_no_step(kind) -> None:
    random = np.random.default_rng(SEED)
    assert not [steps for _ in range(FLAT) if (steps := find_steps(KINDS[kind][0](random).tolist(), kind))]


def test_times_of_a_busy_machine_have_no_step_either() -> None:
    random = np.random.default_rng(SEED)
    assert not [steps for _ in range(FLAT) if (steps := find_steps(time(random, LOUD_TIME).tolist(), "time"))]


def test_a_step_of_a_time_with_too_few_versions_before_it_is_not_moved_to_another_version() -> None:
    assert find_steps([0.48, 0.48, 0.31, 0.31, 0.32, 0.31, 0.31, 0.31], "time") == []
    assert find_steps([0.48, 0.48, 0.48, 0.31, 0.32, 0.31, 0.31, 0.31], "time") == [3]


def test_versions_without_a_value_are_skipped_and_keep_their_places() -> None:
    values = [9.0, None, 9.0, 9.0, None, None, 8.0, 8.0]
    assert find_steps(values, "levels") == [6]


def test_two_versions_suffice_for_figures_without_noise_but_not_for_times() -> None:
    assert find_steps([9.0, 8.0], "levels") == [1]
    assert find_steps([1e-6, 1e-5], "creep") == [1]
    assert find_steps([1.0, 2.0], "time") == []
    assert find_steps([9.0], "levels") == []


def test_creep_of_rounding_errors_is_no_step() -> None:
    assert find_steps([1e-17, 1e-17, 1e-12, 1e-9, 1e-16, 1e-17], "creep") == []


def test_a_level_that_changes_and_returns_has_two_steps() -> None:
    assert find_steps([9.0, 9.0, 9.0, 5.0, 9.0, 9.0, 9.0], "levels") == [3, 4]
