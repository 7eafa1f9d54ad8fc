"""A report is built of a folder by one call; its sections are those of the registry."""

import pandas as pd
import pytest

from reports.records.folder import ResultsFolder
from reports.records.results import write_trials_parquet
from reports.records.trial import RecordError
from reports.report import SECTIONS, build_report
from tests.reports.studies import failed, fallen, record, write_study


def test_one_call_writes_tables_page_and_trials(tmp_path) -> None:
    records = [record(), fallen(9, policy="paper"), failed("crashed", policy="native")]
    folder = ResultsFolder(write_study(tmp_path / "study", records))
    made = build_report(folder, missing=["never.run"])
    assert made.page.exists()
    assert "never.run" in made.page.read_text(encoding="utf-8")
    written = (folder.report / "tables.md").read_text(encoding="utf-8")
    assert all(f"## {table.title}\n" in written for table in made.tables)
    for table in made.tables:
        rows = pd.read_csv(folder.report / "tables" / f"{table.id}.csv", dtype=str, keep_default_na=False)
        assert [tuple(row) for row in rows.to_numpy()] == list(table.rows)
        latex = (folder.report / "tables" / f"{table.id}.tex").read_text(encoding="utf-8")
        assert latex.startswith(r"\begin{longtable}")
    assert len((folder.report / "trials.csv").read_text(encoding="utf-8").splitlines()) == 4
    hidden = [table for section in SECTIONS if not section.is_printed for table in section.tables(folder)]
    assert hidden
    assert all(f"## {table.title}\n" in written and table not in made.tables for table in hidden)


def test_ids_of_sections_are_unique() -> None:
    assert len({section.id for section in SECTIONS}) == len(SECTIONS)


def test_a_folder_without_trials_has_no_report(tmp_path) -> None:
    (tmp_path / "trials.jsonl").touch()
    with pytest.raises(RecordError, match="needs at least one trial, but the file contains none"):
        build_report(ResultsFolder(tmp_path))


def test_a_published_study_has_a_report_without_its_frames(tmp_path) -> None:
    records = [record(pose_hash="a"), record(repeat=1, pose_hash="a", trial="again"), fallen(9, policy="paper")]
    write_trials_parquet(tmp_path / "trials.parquet", records)
    folder = ResultsFolder(tmp_path)
    made = build_report(folder)
    assert "Frames of 2 trials are missing" in made.page.read_text(encoding="utf-8")
    [repeats] = [table for table in made.tables if table.id == "repeatability"]
    assert repeats.rows[0][3] == "1/1"
    assert repeats.rows[0][5:] == ("-", "-", "-"), "the best time of each frame is not known without frames"
