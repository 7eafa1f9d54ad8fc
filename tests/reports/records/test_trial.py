"""What a trial leaves behind can be read again, also after a cut."""

import json
import math
import re
from pathlib import Path

import pandas as pd
import pytest
from pydantic import ValidationError

from reports.records.folder import ResultsFolder
from reports.records.frames import FrameRow, read_frames, write_frames
from reports.records.trial import RecordError, RecordWarning, RecordWriter, TrialRecord, read_records
from tests.reports.studies import FALLS, record

FORMAT_1 = Path(__file__).parents[2] / "fixtures" / "format_1"
DESIGNED = re.findall(
    r"\w+",
    "format, trial, engine, engine_version, profile, unit_scale, scenario, scene, parameters, policy, seed, repeat, "
    "status, message, levels_placed, height_levels, height_m, collapse_level, sink_m, drift_m, creep_m_s, "
    "frame_ms_p50, frame_ms_p95, frame_ms_p99, frame_ms_max, engine_ms, readback_ms, core_ms, port_ms, frame_ratio, "
    "wakes, refreezes, longest_live_s, realtime_factor, pose_hash, expectation, verdict, environment",
)


def trial(**fields) -> TrialRecord:
    return record(**{"trial": "a", "expectation": FALLS, "parameters": {"levels": 30, "angle": 72.0}, **fields})


def write(path, *records: TrialRecord) -> None:
    writer = RecordWriter(path)
    for one in records:
        writer.append(one)
    writer.close()


def test_the_fields_are_those_of_the_design_in_its_order() -> None:
    assert list(TrialRecord.model_fields)[: len(DESIGNED)] == DESIGNED


def test_records_read_back_as_they_were(tmp_path) -> None:
    records = [trial(), trial(trial="b", status="collapsed", collapse_level=3, frame_ms_p50=0.1, message="ü\n")]
    write(tmp_path / "trials.jsonl", *records)
    again = read_records(tmp_path / "trials.jsonl")
    assert again == records
    assert isinstance(again[0].parameters["levels"], int)
    assert isinstance(again[0].parameters["angle"], float)


def test_a_record_from_before_there_were_prebuilt_stacks_still_reads(tmp_path) -> None:
    old = json.loads(trial().model_dump_json())
    del old["adopted"], old["expectation"]["within_s"]
    (tmp_path / "trials.jsonl").write_text(json.dumps(old) + "\n")
    [again] = read_records(tmp_path / "trials.jsonl")
    assert (again.adopted, again.expectation.within_s) == (None, None)
    assert again == trial()


def test_every_record_is_on_disk_before_the_next_trial_begins(tmp_path) -> None:
    writer = RecordWriter(tmp_path / "trials.jsonl")
    writer.append(trial())
    assert len(read_records(tmp_path / "trials.jsonl")) == 1
    writer.close()


def test_what_does_not_exist_is_null_and_nan_is_refused(tmp_path) -> None:
    assert json.loads(trial().model_dump_json())["collapse_level"] is None
    for value in (math.nan, math.inf):
        with pytest.raises(ValidationError, match="finite"):
            trial(sink_m=value)


def test_a_torn_last_line_is_left_out_with_a_warning_and_mended_when_the_file_is_continued(tmp_path) -> None:
    path = tmp_path / "trials.jsonl"
    write(path, trial(), trial(trial="b"))
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.warns(RecordWarning, match=r"trials\.jsonl:2: the last line is incomplete; the reader skips it"):
        assert [one.trial for one in read_records(path)] == ["a"]
    write(path, trial(trial="c"))
    assert [one.trial for one in read_records(path)] == ["a", "c"]


def test_a_last_line_that_lost_only_its_line_break_is_whole(tmp_path) -> None:
    path = tmp_path / "trials.jsonl"
    write(path, trial())
    path.write_bytes(path.read_bytes()[:-1])
    assert [one.trial for one in read_records(path)] == ["a"]
    write(path, trial(trial="b"))
    assert [one.trial for one in read_records(path)] == ["a", "b"]


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("not json", "not a line of JSON"),
        ('{"format": 99}', "a record of format 99, newer than this suite's 3: update the suite"),
        ('{"format": "x"}', "not a record of format 3"),
        ('{"format": 1, "hello": 2}', "not a trial record: field 'trial': Field required"),
    ],
)
def test_a_foreign_line_is_named_with_its_file_and_number(tmp_path, line: str, complaint: str) -> None:
    path = tmp_path / "trials.jsonl"
    write(path, trial())
    path.write_text(path.read_text() + line + "\n")
    with pytest.raises(RecordError, match=rf"trials\.jsonl:2: {complaint}"):
        read_records(path)


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(RecordError, match=r"trials\.jsonl: cannot read this file"):
        read_records(tmp_path / "trials.jsonl")


def test_frames_read_back_as_they_were(tmp_path) -> None:
    rows = [
        FrameRow(0, 1 / 60, 1, 1, 1, 0.5, 0.5),
        FrameRow(1, 2 / 60, 1, 4, 0, 0.5, 0.9, 12, 0.1, 0.2, 0.1, 4, 1, "1 struck"),
    ]
    write_frames(tmp_path / "a.parquet", rows)
    assert read_frames(tmp_path / "a.parquet") == rows
    write_frames(tmp_path / "none.parquet", [])
    assert read_frames(tmp_path / "none.parquet") == []


def test_a_trial_that_its_time_limit_stopped_was_called_failed_in_format_1(tmp_path) -> None:
    """It is undecided now, whatever file it was kept in; what sank has failed as before."""
    old = [json.loads(line) for line in (FORMAT_1 / "trials.jsonl").read_text(encoding="utf-8").splitlines()]
    assert [(one["format"], one["status"], one["verdict"]) for one in old] == [
        (1, "timeout", "failed"),
        (1, "completed", "right"),
        (1, "collapsed", "failed"),
    ]
    records = ResultsFolder(FORMAT_1).records
    assert [(one.format, one.verdict, one.is_judged) for one in records] == [
        (3, "undecided", False),
        (3, "right", True),
        (3, "failed", True),
    ]
    changed = ("format", "verdict", "creep_m_s")
    kept = [{name: one[name] for name in one if name not in changed} for one in old]
    again = [one.model_dump(mode="json") for one in records]
    assert [{name: new[name] for name in was} for new, was in zip(again, kept, strict=True)] == kept
    assert [(one.creep_m_s, one.mean_motion_m_s) for one in records] == [(None, one["creep_m_s"]) for one in old]
    for new, was in zip(again, kept, strict=True):
        later = new.keys() - was.keys() - {*changed, "mean_motion_m_s"}
        assert all(new[name] is None for name in later), "nobody measured what came later"
    pd.DataFrame(
        [{name: json.dumps(value) if isinstance(value, dict) else value for name, value in one.items()} for one in old],
        dtype=object,
    ).to_csv(tmp_path / "trials.csv", index=False)
    assert ResultsFolder(tmp_path).records == records


def test_a_record_of_the_present_format_is_not_changed() -> None:
    assert trial(status="timeout", verdict="failed").verdict == "failed"
