"""The results folder: what a cut leaves is gone on with, and nothing of another run is mixed in unasked."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bench.execution.results import Results, ResultsError
from bench.machine.environment import digest
from bench.studies.plan import plan_trials
from bench.studies.schema import check_study
from bench.trial.run_trial import Outcome, bare_record
from reports.records.frames import FrameRow, read_frames
from reports.records.trial import read_records

CONTENT = {
    "name": "test",
    "engines": ["bullet"],
    "policies": ["none"],
    "seeds": 3,
    "scenario": [{"name": "leaning_tower", "parameters": {"levels": 2}}],
}
STUDY = check_study(CONTENT, "test")
ENVIRONMENT = {"commit": "c0ffee", "lock_sha256": "1", "sources": "2", "engines": {"bullet": {"version": "3"}}}
TRIALS = plan_trials(STUDY)


def outcome(index: int, environment: str = "abc") -> Outcome:
    trial = TRIALS[index]
    record = bare_record(trial, trial.build_scene(), environment, "completed", "")
    return Outcome(record, [FrameRow(0, 1 / 60, 1, 1, 1, 0.5, 0.5)])


def write(folder: Path, *indices: int, study=STUDY, environment=ENVIRONMENT, **options) -> Results:
    results = Results(folder, study, environment, **options)
    for index in indices:
        results.keep(outcome(index, digest(environment)))
    results.close()
    return results


def kept(folder: Path) -> list[str]:
    return [record.trial for record in read_records(folder / "trials.jsonl")]


def test_a_folder_is_gone_on_with_and_knows_what_is_finished(tmp_path) -> None:
    write(tmp_path, 0, 2)
    again = write(tmp_path)
    assert again.finished == {TRIALS[0].id, TRIALS[2].id}
    write(tmp_path, 1)
    assert kept(tmp_path) == [TRIALS[0].id, TRIALS[2].id, TRIALS[1].id]
    for trial in TRIALS:
        assert len(read_frames(tmp_path / "frames" / f"{trial.id}.parquet")) == 1
    environment = json.loads((tmp_path / "environment.json").read_text())
    assert len(environment.pop("sessions")) == 3
    assert environment == ENVIRONMENT


def test_fresh_starts_over(tmp_path) -> None:
    write(tmp_path, 0, 1)
    assert write(tmp_path, 2, fresh=True).finished == {TRIALS[2].id}
    assert kept(tmp_path) == [TRIALS[2].id]
    assert len(list((tmp_path / "frames").iterdir())) == 1


def test_the_trial_of_a_torn_line_is_run_again(tmp_path) -> None:
    write(tmp_path, 0, 1)
    path = tmp_path / "trials.jsonl"
    path.write_bytes(path.read_bytes()[:-40])
    results = write(tmp_path, 1)
    assert results.torn
    assert kept(tmp_path) == [TRIALS[0].id, TRIALS[1].id]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"environment": ENVIRONMENT | {"commit": "decaf"}}, "commit"),
        ({"environment": ENVIRONMENT | {"lock_sha256": "9"}}, "uv.lock"),
        ({"environment": ENVIRONMENT | {"sources": "9"}}, "sources"),
        ({"study": check_study(CONTENT | {"seeds": 4}, "test")}, "study"),
    ],
)
def test_another_commit_lock_file_source_or_study_is_refused_unless_accepted(tmp_path, change, named) -> None:
    write(tmp_path, 0)
    before = {path: path.read_bytes() for path in tmp_path.glob("*.*")}
    with pytest.raises(ResultsError, match=f"changed since: {named}.*--fresh.*--accept-changes"):
        write(tmp_path, **change)
    assert {path: path.read_bytes() for path in tmp_path.glob("*.*")} == before
    write(tmp_path, 1, accept_changes=True, **change)
    assert kept(tmp_path) == [TRIALS[0].id, TRIALS[1].id]


def test_each_record_names_an_environment_that_is_there(tmp_path) -> None:
    write(tmp_path, 0)
    write(tmp_path, 1, environment=ENVIRONMENT | {"commit": "decaf"}, accept_changes=True)
    first, second = read_records(tmp_path / "trials.jsonl")
    now = json.loads((tmp_path / "environment.json").read_text())
    assert now.pop("sessions")
    assert digest(now) == second.environment
    earlier = json.loads((tmp_path / f"environment-{first.environment}.json").read_text())
    assert earlier["commit"] == "c0ffee"


def test_two_runs_in_one_folder_are_refused_until_the_first_is_dead(tmp_path) -> None:
    """The lock is the system's: also a process that was killed lets go of it."""
    code = f"""
import sys, time
sys.path.insert(0, {str(Path(__file__).parents[3])!r})
from pathlib import Path
from filelock import FileLock
lock = FileLock(Path({str(tmp_path)!r}) / ".lock")
lock.acquire()
print("locked", flush=True)
time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(ResultsError, match=r"another run uses .*: wait for the end of that run"):
            write(tmp_path)
        os.kill(other.pid, signal.SIGKILL)
    assert write(tmp_path, 0).finished == {TRIALS[0].id}


def test_frames_come_whole_or_not_at_all_and_before_their_record(tmp_path, monkeypatch) -> None:
    def break_off(_, path: Path) -> None:
        path.write_bytes(b"half")
        raise KeyboardInterrupt

    results = Results(tmp_path, STUDY, ENVIRONMENT)
    monkeypatch.setattr("reports.records.frames.pq.write_table", break_off)
    with pytest.raises(KeyboardInterrupt):
        results.keep(outcome(0))
    results.close()
    assert not list((tmp_path / "frames").iterdir())
    assert kept(tmp_path) == []
