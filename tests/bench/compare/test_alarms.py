"""Does ``bench compare`` alarm when it should, and only then? Whole runs of the study ``ci``, on this machine.

The regressions are real: a copy of the suite is changed (``plants/``) and run. With SHOW=1 each comparison is printed.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bench.compare.baseline import Baseline, read_baseline
from bench.compare.checkouts import Checkout
from bench.compare.comparison import compare_runs
from bench.compare.findings import Finding

ROOT = Path(__file__).parents[3]
PLANTS = Path(__file__).parent / "plants"
COMPARISONS = int(os.environ.get("COMPARISONS", "50"))
"""Of the same code."""
PLANTED = 20
"""Runs of a slower core."""
pytestmark = pytest.mark.slow


class Copy:
    """A copy of the suite that may be changed, in the environment of this one."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._runs = folder, 0
        for part in ("stability_core", "scenarios", "adapters", "reports", "bench", "uv.lock"):
            copy = shutil.copytree if (ROOT / part).is_dir() else shutil.copy2
            copy(ROOT / part, folder / part)
        (folder / ".venv").symlink_to(Path(sys.prefix))

    def plant(self, name: str) -> None:
        source = (ROOT / "bench" / "trial.py").read_text()
        (self.folder / "bench" / "trial.py").write_text(source + "\n\n" + (PLANTS / f"{name}.py").read_text())

    def run(self) -> Baseline:
        self._runs += 1
        out = self.folder / f"run-{self._runs}"
        Checkout("copy", self.folder).run(ROOT / "bench" / "studies" / "ci.toml", out)
        return read_baseline(out)


@pytest.fixture(scope="module")
def suite(tmp_path_factory) -> Copy:
    return Copy(tmp_path_factory.mktemp("suite"))


@pytest.fixture(scope="module")
def changed(tmp_path_factory) -> Copy:
    return Copy(tmp_path_factory.mktemp("changed"))


def alarms(base: Baseline, head: Baseline) -> list[Finding]:
    found = compare_runs(base, head, ("base", "head"))
    if "SHOW" in os.environ:
        told = [(one.trial, one.judgement, one.told) for one in found.findings if one.gate == "time" or one.is_alarm]
        print(json.dumps(told), flush=True)  # noqa: T201 - asked for
    return found.alarms()


def test_the_same_code_raises_no_alarm_but_once_in_fifty(suite) -> None:
    """Each run is held against the one before it."""
    base, found = suite.run(), 0
    for _ in range(COMPARISONS):
        head = suite.run()
        found += bool(alarms(base, head))
        base = head
    assert found <= 1


@pytest.mark.parametrize("plant", ["one_level_less", "doubled_creep", "another_trajectory"])
def test_a_planted_change_of_the_outcome_is_always_found(suite, changed, plant) -> None:
    base = suite.run()
    changed.plant(plant)
    found = {(alarm.gate, alarm.trial.split(".")[2]) for alarm in alarms(base, changed.run())}
    expected = ("hash", "four_stack-3") if plant == "another_trajectory" else ("outcome", "four_stack-3")
    assert expected in found


def test_a_core_slower_by_a_fifth_is_found_nineteen_times_in_twenty(suite, changed) -> None:
    changed.plant("slower_core")
    found = 0
    for _ in range(PLANTED):
        raised = alarms(suite.run(), changed.run())
        assert {alarm.gate for alarm in raised} <= {"time"}
        found += "bullet.game.core / engine" in {alarm.trial for alarm in raised}
    assert found >= PLANTED - 1


def test_the_command_line_does_all_of_it(suite, changed, tmp_path) -> None:
    """One round of both sides, then status 1 for the plant."""
    changed.plant("one_level_less")
    command = [sys.executable, "-m", "bench", "compare", "--run", str(suite.folder), str(changed.folder)]
    options = ["--study", "ci", "--rounds", "1", "--out", str(tmp_path / "out"), "--markdown", str(tmp_path / "m.md")]
    done = subprocess.run([*command, *options], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    assert "2 of 3 levels, 3 before" in (tmp_path / "m.md").read_text()
