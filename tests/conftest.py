"""Shared by all tests."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from pytest_benchmark.utils import get_tag

import bench  # noqa: F401 - chooses where kernels are cached, before a test imports the core
import tests.bytecode  # noqa: F401 - before the first long import
from adapters import ENGINES, EngineNotInstalledError, check_installed
from adapters.engines import LibraryEntry, WasmEntry
from bench.compare.benchmarks import FORMAT

COLUMNS = ("median", "mean", "min", "max", "stddev", "rounds")
"""Of the tables of benchmarks: what fits a line."""

OPTIONAL = [name for name, entry in ENGINES.items() if isinstance(entry, WasmEntry | LibraryEntry)]
"""Engines of dependency groups that are not installed by default."""
MOST_WORKERS = 4
"""Processes that share the tests: each may run a study of its own, of two processes more."""
WARM_UP = "import bench; from stability_core import POLICIES, warm_up; [warm_up(policy) for policy in POLICIES]"

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


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip the tests of engines that no default group installs, where they are missing."""
    missing = {engine: why for engine in OPTIONAL if (why := _missing(engine))}
    for item in items:
        callspec = getattr(item, "callspec", None)
        for value in callspec.params.values() if callspec else ():
            if isinstance(value, str) and value in missing:
                item.add_marker(pytest.mark.skip(reason=missing[value]))


def _missing(engine: str) -> str:
    """Return why an engine cannot be opened here, with the command that installs it; empty if it can."""
    try:
        check_installed(engine)
    except EngineNotInstalledError as error:
        return str(error)
    return ""


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return the number of worker processes: several for the whole suite, none for a part of it or for benchmarks."""
    is_timed = config.option.benchmark_only or config.option.benchmark_enable
    is_whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS and not config.option.keyword
    return min(len(os.sched_getaffinity(0)), MOST_WORKERS) if is_whole and not is_timed else 0


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the core's kernels once, before worker processes would each compile their own."""
    if session.config.pluginmanager.hasplugin("dsession"):  # in the process that has workers, and in no worker
        subprocess.run([sys.executable, "-c", WARM_UP], cwd=Path(__file__).parents[1], check=True)


def pytest_benchmark_update_json(config: pytest.Config, output_json: dict[str, Any]) -> None:
    """Keep of a saved run the rounds of frames alone: those of kernels are a hundred thousand, never read."""
    if config.option.benchmark_json:
        return  # which stands for all of the data
    for one in output_json["benchmarks"]:
        if one["extra_info"].get("format") != FORMAT:
            one["stats"].pop("data", None)
