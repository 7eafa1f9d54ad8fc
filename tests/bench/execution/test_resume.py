"""A study that is killed goes on with the same command: nothing finished is run again, nothing is lost or doubled."""

import random
import time

import pytest

from reports.records.frames import read_frames
from reports.records.trial import TrialRecord, read_records


def kill_after(suite, more_trials: int, pause_s: float) -> int:
    """Kill a run once it has kept some more trials, and a moment later; how many are kept then."""
    path = suite.out / "trials.jsonl"

    def count() -> int:
        return path.read_bytes().count(b"\n") if path.exists() else 0

    enough = count() + more_trials
    with suite.start("--jobs", "2") as process:
        deadline = time.monotonic() + 600
        while count() < enough and process.poll() is None:
            assert time.monotonic() < deadline
            time.sleep(0.005)
        time.sleep(pause_s)
        process.kill()
    return count()


def check_kills(suite, seeds: int, kills: int) -> list[TrialRecord]:
    """Kill a study some times, let it end, and return its records."""
    draw = random.Random(0)
    suite.write_study(seeds=seeds)
    before: list[TrialRecord] = []
    for _ in range(kills):
        kill_after(suite, draw.randint(1, seeds // (kills + 1)), draw.uniform(0, 0.2))
        now = read_records(suite.out / "trials.jsonl")
        assert now[: len(before)] == before
        before = now
    output = suite.run("--jobs", "2")
    assert f"continuing: {len(before)} of {seeds} trials are already in the folder" in output
    records = read_records(suite.out / "trials.jsonl")
    assert records[: len(before)] == before
    assert len(records) == len({record.trial for record in records}) == seeds
    for record in records:
        assert read_frames(suite.out / "frames" / f"{record.trial}.parquet")
    return records


# a kill may tear the line that is being written
@pytest.mark.filterwarnings("ignore::reports.records.trial.RecordWarning")
def test_a_study_that_was_killed_goes_on(rogue_suite) -> None:
    assert {record.status for record in check_kills(rogue_suite, seeds=20, kills=1)} == {"completed"}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::reports.records.trial.RecordWarning")
def test_a_study_killed_twenty_times_ends_as_if_it_had_not_been(rogue_suite, untimed) -> None:
    records = check_kills(rogue_suite, seeds=200, kills=20)
    rogue_suite.run("--fresh", "--jobs", "2")
    assert untimed(records) == untimed(read_records(rogue_suite.out / "trials.jsonl"))
