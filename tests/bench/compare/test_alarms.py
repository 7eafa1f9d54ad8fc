"""Does ``bench compare`` alarm when it should, and only then? Whole runs of the study ``ci``, on this machine.

The regressions are real: the suite is changed (``tests/bench/plants``) and run. With SHOW=1 the times are printed.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bench.compare.baseline import read_baseline
from bench.compare.comparison import compare_runs
from bench.compare.findings import Finding
from bench.compare.side import Baseline

ROOT = Path(__file__).parents[3]
PLANTS = Path(__file__).parents[1] / "plants"
COMPARISONS = int(os.environ.get("COMPARISONS", "50"))
"""Of the same code; and of a slower core two for five of these."""
pytestmark = pytest.mark.slow


@pytest.fixture
def run(tmp_path):
    """Runs the study, with a plant if one is named."""
    folders = (tmp_path / str(number) for number in range(10_000))

    def run(plant: str = "", *options: str) -> Baseline:
        out = next(folders)
        environment = os.environ | {"PLANT": plant, "PYTHONPATH": os.pathsep.join([str(ROOT), str(PLANTS)])}
        command = [sys.executable, str(PLANTS / "planted_bench.py"), "run", "ci", "--out", str(out), *options]
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=True)
        return read_baseline(out)

    return run


def alarms(base: Baseline, head: Baseline) -> list[Finding]:
    found = compare_runs(base, head, ("base", "head"))
    if "SHOW" in os.environ:
        times = [f"{one.trial}: {one.judgement} {one.message}" for one in found.findings if one.gate == "time"]
        print(f"{len(found.alarms())} alarms;", *times, sep="  ", flush=True)  # noqa: T201 - asked for
    return found.alarms()


def test_the_same_code_raises_no_alarm_but_once_in_fifty(run) -> None:
    """Each run is compared with the one before it."""
    base, found = run(), 0
    for _ in range(COMPARISONS):
        head = run()
        found += bool(alarms(base, head))
        base = head
    assert found <= 1


@pytest.mark.parametrize(("plant", "gate"), [("one_level_less", "outcome"), ("another_trajectory", "hash")])
def test_a_planted_change_of_the_outcome_is_always_found(run, plant, gate) -> None:
    """Always: both runs repeat themselves to the last bit."""
    found = {(alarm.gate, alarm.trial) for alarm in alarms(run(), run(plant))}
    assert (gate, "bullet.game.four_stack-3.none.s0.r0") in found


def test_a_nanometre_is_no_worse_outcome(run) -> None:
    found = alarms(run(), run("another_trajectory"))
    assert {alarm.gate for alarm in found} == {"hash"}
    assert all("first in frame 0: body 0, x = " in alarm.message for alarm in found), "where it was planted"


def test_doubled_creep_is_always_found(run) -> None:
    """Of an inverted V, which creeps at some micrometres a second; that of the 4-stack is below what is tolerated."""
    scene = ("--scenario", "card_house", "--policy", "none")
    found = alarms(run("", *scene), run("doubled_creep", *scene))
    assert [alarm.trial for alarm in found] == [f"bullet.game.card_house.none.s0.r{repeat}" for repeat in range(3)]
    assert all(alarm.gate == "outcome" and "creeps" in alarm.message for alarm in found)


def test_a_core_slower_by_a_fifth_is_found_nineteen_times_in_twenty(run) -> None:
    """And nothing else is."""
    planted = 2 * COMPARISONS // 5
    found = 0
    for _ in range(planted):
        raised = [alarm.trial for alarm in alarms(run(), run("slower_core"))]
        assert set(raised) <= {"bullet.game.core / engine"}
        found += bool(raised)
    assert found >= 0.95 * planted


def test_two_checkouts_of_the_same_code_raise_no_alarm(tmp_path) -> None:
    command = [sys.executable, "-m", "bench", "compare", "--run", str(ROOT), str(ROOT), "--study", "ci"]
    done = subprocess.run([*command, "--out", str(tmp_path / "out")], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "base-1", "base-2", "head-1", "head-2", "study.toml",
    ]  # fmt: skip
