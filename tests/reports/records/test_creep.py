"""Records from before creep counted: what their recorded poses prove is added, nothing else."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from bench.compare.baseline import read_baseline
from reports.records.creep import with_creep
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord, read_records

FORMAT_2 = Path(__file__).parents[2] / "fixtures" / "format_2"
SLIDES, STANDS, FROZEN, FELL = (
    "bullet.game.own_scene-issue_jolt_1390_100-375d26b6.none.s0.r0",
    "bullet.game.four_stack-1.none.s0.r0",
    "bullet.game.four_stack-1.paper.s0.r0",
    "bullet.game.plank_tower-10.none.s0.r0",
)


def old() -> dict[str, dict[str, object]]:
    lines = (FORMAT_2 / "trials.jsonl").read_text(encoding="utf-8").splitlines()
    return {one["trial"]: one for one in map(json.loads, lines)}


def of(records: list[TrialRecord]) -> dict[str, TrialRecord]:
    return {record.trial: record for record in records}


def test_the_fixture_is_of_format_2() -> None:
    assert {one["format"] for one in old().values()} == {2}
    assert [one["verdict"] for one in old().values()] == ["right", "right", "right", "false_collapse"]


def test_without_poses_the_creep_is_missing_and_every_verdict_stays(tmp_path) -> None:
    shutil.copy(FORMAT_2 / "trials.jsonl", tmp_path)
    for records in (read_records(FORMAT_2 / "trials.jsonl"), ResultsFolder(tmp_path).records):
        for record in records:
            before = old()[record.trial]
            assert record.format == 3
            assert (record.creep_m_s, record.mean_motion_m_s) == (None, before["creep_m_s"])
            assert record.verdict == before["verdict"]
            assert record.height_levels == before["height_levels"]


def test_poses_prove_that_frozen_bricks_do_not_creep_and_that_a_fast_one_does() -> None:
    records = of(ResultsFolder(FORMAT_2).records)
    assert (records[FROZEN].creep_m_s, records[FROZEN].creep_error_m_s, records[FROZEN].verdict) == (0.0, 0.0, "right")
    slides = records[SLIDES]
    assert slides.verdict == "creeps"
    # a cube of 1 m slid at 48 mm/s in the mean of the whole watch; measured in its last half it is 57.083 mm/s
    assert slides.mean_motion_m_s == pytest.approx(0.048, rel=0.01)
    assert slides.creep_m_s == pytest.approx(0.057083, abs=1e-4)
    assert slides.creep_error_m_s is not None
    assert slides.creep_error_m_s < 2e-4
    assert slides.creep_limit_m_s == pytest.approx(0.01 / 60)


def test_what_poses_kept_to_a_twentieth_of_a_millimetre_do_not_prove_stays_missing() -> None:
    records = of(ResultsFolder(FORMAT_2).records)
    for name, verdict in ((STANDS, "right"), (FELL, "false_collapse")):
        assert (records[name].creep_m_s, records[name].verdict) == (None, verdict)


def test_a_torn_recording_proves_nothing(tmp_path) -> None:
    shutil.copytree(FORMAT_2, tmp_path / "old")
    file = tmp_path / "old" / "recordings" / f"{SLIDES}.parquet"
    file.write_bytes(file.read_bytes()[:100])
    assert of(ResultsFolder(tmp_path / "old").records)[SLIDES].verdict == "right"


def test_a_record_that_knows_its_creep_is_not_measured_again() -> None:
    folder = ResultsFolder(FORMAT_2)
    known = of(folder.records)[FROZEN].model_copy(update={"creep_m_s": 5e-6})
    assert with_creep(known, folder.recording(FROZEN)) is known


def test_a_baseline_of_format_2_is_converted() -> None:
    baseline = read_baseline(FORMAT_2 / "baseline.json")
    assert [one.format for one in baseline.trials] == [3] * 4
    assert [one.verdict for one in baseline.trials] == [one["verdict"] for one in old().values()]
    assert all(one.creep_m_s is None for one in baseline.trials)
