"""Repeats of a trial: best times only of those that went the same way; those that did not are flagged."""

from reports.records.frames import UNTIMED_FRAMES, FrameRow, write_frames
from reports.records.trial import TrialRecord
from reports.tables.repeatability import best_times, repeat_tables
from tests.reports.studies import record


def repeated(repeat: int, pose_hash: str = "same", **fields) -> TrialRecord:
    output = {"trial": f"t.r{repeat}", "repeat": repeat, "pose_hash": pose_hash, "frame_ms_p50": 1.0 + repeat, **fields}
    return record(**{"timed_frames": 3, **output})


def write_times(folder, repeat: int, *times_ms: float) -> None:
    (folder / "frames").mkdir(exist_ok=True)
    times = [99.0] * UNTIMED_FRAMES + [*times_ms, 99.0]  # the first are not timed, nor what comes after a collapse
    rows = [FrameRow(i, i / 60, 1, 1, 1, ms, ms) for i, ms in enumerate(times)]
    write_frames(folder / "frames" / f"t.r{repeat}.parquet", rows)


def test_the_best_times_are_percentiles_of_each_frames_least_time(tmp_path) -> None:
    write_times(tmp_path, 0, 1.0, 9.0, 3.0)
    write_times(tmp_path, 1, 8.0, 2.0, 4.0)
    best = best_times(tmp_path, [repeated(0), repeated(1)])  # least times 1, 2, 3
    assert [round(value, 6) for value in best or ()] == [2.0, 2.9, 2.98]
    assert best_times(tmp_path, [repeated(0), repeated(1, "other")]) is None
    assert best_times(tmp_path, [repeated(0), repeated(1, timed_frames=2)]) is None
    assert best_times(tmp_path, [repeated(0), repeated(1, host="another")]) is None


def test_repeats_that_differ_are_flagged_and_have_median_and_mad_alone(tmp_path) -> None:
    [table] = repeat_tables(tmp_path, [repeated(0), repeated(1, "other"), repeated(2, "third")])
    assert table.rows == (("four_stack", "bullet game", "none", "0/1 DIFFER", "2.000 ± 1.000", "-", "-", "-"),)


def test_times_of_several_machines_are_not_put_together_but_their_poses_are_compared(tmp_path) -> None:
    [table] = repeat_tables(tmp_path, [repeated(0), repeated(1, host="another")])
    assert table.rows == (("four_stack", "bullet game", "none", "1/1", "-", "-", "-", "-"),)


def test_a_study_without_repeats_has_no_such_table(tmp_path) -> None:
    assert repeat_tables(tmp_path, [repeated(0), repeated(0, seed=1)]) == []


def test_a_noisy_machine_is_reported_and_a_calm_one_is_not(tmp_path) -> None:
    [calm] = repeat_tables(tmp_path, [repeated(0, calibration_ms=1.0), repeated(0, seed=1, calibration_ms=1.02)])
    assert "NOISY" not in " ".join(calm.notes)
    # the percentiles 5 and 95 of 1 and 1.5 are 1.025 and 1.475
    [noisy] = repeat_tables(tmp_path, [repeated(0, calibration_ms=1.0), repeated(0, seed=1, calibration_ms=1.5)])
    assert "NOISY: the only one varied by 44%" in noisy.notes[0]


def test_machines_are_distinguished(tmp_path) -> None:
    records = [repeated(0, calibration_ms=1.0, host="a"), repeated(0, seed=1, calibration_ms=2.0, host="b")]
    [table] = repeat_tables(tmp_path, records)
    assert [row[0] for row in table.rows] == ["a", "b"]
    assert "compare times of the same machine only" in table.notes[0]
