"""Shared by all tests."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import settings
from pytest_benchmark.utils import get_tag

import bench  # noqa: F401 - chooses where kernels are cached, before a test imports the core
from bench.compare.benchmarks import FORMAT

COLUMNS = ("median", "mean", "min", "max", "stddev", "rounds")
"""Of the tables of benchmarks: what fits a line."""

# No deadline: the first example of a kernel compiles it, and these machines are noisy.
# Derandomised: a run of CI must not fail by the luck of the draw.
settings.register_profile("stillstack", deadline=None, derandomize=True)
settings.load_profile("stillstack")


@pytest.hookimpl(tryfirst=True)  # pytest-benchmark reads its options in a hook of this name that comes last
def pytest_configure(config: pytest.Config) -> None:
    """Run each benchmark once, as a test, unless they are asked for; those are saved with all of their rounds."""
    option = config.option
    if not (option.benchmark_only or option.benchmark_enable):
        option.benchmark_disable = True
        return
    if not (option.benchmark_save or option.benchmark_autosave or option.benchmark_json):
        option.benchmark_autosave = get_tag()
    option.benchmark_save_data = True
    option.benchmark_columns = option.benchmark_columns or list(COLUMNS)


def pytest_benchmark_update_json(config: pytest.Config, output_json: dict[str, Any]) -> None:
    """Keep of a saved run the rounds of frames alone: those of kernels are a hundred thousand, never read."""
    if config.option.benchmark_json:
        return  # which stands for all of the data
    for one in output_json["benchmarks"]:
        if one["extra_info"].get("format") != FORMAT:
            one["stats"].pop("data", None)
