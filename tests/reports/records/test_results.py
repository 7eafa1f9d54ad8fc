"""Results as data frames: nothing is lost or changed on the way from the records, whatever file holds them."""

import json
import math

import numpy as np
import pandas as pd
import pytest

import reports
from reports.records.flat import flat_columns, to_flat
from reports.records.folder import ResultsFolder
from reports.records.recording import Recorder, write_recording
from reports.records.results import write_trials_csv, write_trials_parquet
from reports.records.trial import RecordError
from scenarios.model import Brick
from tests.reports.studies import FALLS, failed, fallen, record, write_study

RECORDS = [
    record(parameters={"levels": 30, "gap": 0.1 + 0.2, "name": 'a, "b"'}, creep_m_s=1e-17, host="vm"),
    fallen(9, seed=1, expectation=FALLS, verdict="right", collapse_s=9.5),
    failed("crashed", seed=2, message="first line\nsecond line"),
]
WRITERS = {"trials.csv": write_trials_csv, "trials.parquet": write_trials_parquet}


@pytest.mark.parametrize("name", WRITERS)
def test_what_is_published_gives_the_same_records_again(name: str, tmp_path) -> None:
    WRITERS[name](tmp_path / name, RECORDS)
    assert ResultsFolder(tmp_path).records == RECORDS


def test_the_csv_of_earlier_versions_can_be_read(tmp_path) -> None:
    rows = []
    for one in RECORDS:
        fields = one.model_dump(mode="json")
        rows.append({key: json.dumps(value) if isinstance(value, dict) else value for key, value in fields.items()})
    pd.DataFrame(rows, dtype=object).to_csv(tmp_path / "trials.csv", index=False)
    assert ResultsFolder(tmp_path).records == RECORDS


@pytest.mark.parametrize("content", ["", "trial,engine\na,b\n", "format,parameters\n1,{\n"])
def test_a_file_that_is_no_table_of_trials_is_named(content: str, tmp_path) -> None:
    (tmp_path / "trials.csv").write_text(content)
    if content:
        with pytest.raises(RecordError, match=r"trials\.csv: row 1: trial .*: field '\w+': .*: correct this field"):
            _ = ResultsFolder(tmp_path).records
    else:
        assert ResultsFolder(tmp_path).records == []


def test_trials_are_rows_with_a_type_for_each_column(tmp_path) -> None:
    trials = reports.load(write_study(tmp_path / "study", RECORDS)).trials
    assert list(trials.columns) == flat_columns()
    assert trials["parameters"][0] == RECORDS[0].parameters
    assert trials["collapse_level"].tolist() == [pd.NA, 9, pd.NA]
    assert trials["collapse_level"].dtype == "Int64"
    assert math.isnan(trials["collapse_s"][0])
    assert trials["expectation_outcome"].tolist() == ["stand", "fall", "stand"]
    for column in trials.columns:
        for value, one in zip(trials[column], RECORDS, strict=True):
            expected = to_flat(one)[column] if column != "parameters" else one.parameters
            assert value == expected if expected is not None else pd.isna(value)


def test_frames_environment_and_study_come_with_them(tmp_path) -> None:
    results = reports.load(write_study(tmp_path / "study", RECORDS))
    frames = results.frames(RECORDS[0].trial)
    assert len(frames) == 105
    assert frames["time_s"].is_monotonic_increasing
    assert results.study["name"] == "made-up"
    assert results.environment["commit"] == "c0ffee"
    assert reports.load(tmp_path).environment == {}


def test_poses_are_in_metres_and_say_since_when_they_hold(tmp_path) -> None:
    folder = write_study(tmp_path / "study", RECORDS)
    brick = Brick((0.1, 0.02, 0.008), 0.1, (0.0, 0.0, 0.004))
    recorder, upright = Recorder(1 / 60), np.array([[1.0, 0.0, 0.0, 0.0]])
    for height in (0.1, 0.1, 0.05):
        recorder.see(np.array([4]), np.array([[0.0, -0.02, height]]), upright, (), {4: brick})
    (folder / "recordings").mkdir()
    write_recording(folder / "recordings" / f"{RECORDS[0].trial}.parquet", recorder.finish())
    poses = reports.load(folder).poses(RECORDS[0].trial)
    assert poses["body"].tolist() == [4, 4]
    assert poses["frame"].tolist() == [0, 2]
    assert poses["time_s"].tolist() == pytest.approx([1 / 60, 3 / 60])
    assert poses["z_m"].tolist() == pytest.approx([0.1, 0.05])
    assert poses["y_m"].tolist() == pytest.approx([-0.02, -0.02])
    assert poses["qw"].tolist() == [1.0, 1.0]
    assert poses["state"].tolist() == ["live", "live"]
