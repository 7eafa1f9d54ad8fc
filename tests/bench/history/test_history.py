"""``bench history`` without a network: versions, resumption, kept records, explanations and the page."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.version import Version
from rich.console import Console

from bench.cli.history import _show
from bench.compare.commands import CheckoutError, call
from bench.history import measure, versions
from bench.history.build import build_history, read_explanations
from bench.history.figures import Figure, as_series, figures_of, first_failure
from bench.history.measure import Measured, _plain, read_measured, write_study
from bench.history.publish import publish_history
from bench.history.tracking import tracked_versions
from bench.history.versions import VersionsError, kept_records, released, within
from bench.studies.schema import load_study
from reports.page.history_page import write_history_page
from reports.records.history import HistoryError, read_history, write_history
from reports.records.trial import TrialRecord

SILENT = Console(quiet=True)
STANDS = {
    "trial": "bullet.game.four_stack-3.none.s0.r0",
    "engine": "bullet",
    "engine_version": "1.0",
    "profile": "game",
    "scenario": "four_stack",
    "scene": "four_stack-3",
    "parameters": {"levels": 3},
    "policy": "none",
    "seed": 0,
    "repeat": 0,
    "status": "completed",
    "height_levels": 3,
    "sink_m": 1e-4,
    "creep_m_s": 4e-6,
    "frame_ms_p50": 0.4,
    "calibration_ms": 0.2,
    "expectation": {"outcome": "stand", "theory": "a column"},
    "verdict": "right",
    "environment": "here",
    "levels_planned": 3,
}


def record(**changes) -> TrialRecord:
    return TrialRecord.model_validate_json(json.dumps(STANDS | changes))


def measured(version: str, *records: TrialRecord) -> Measured:
    return Measured(version, tuple(figures_of(records or [record()])))


def test_a_range_of_releases_includes_what_begins_with_its_upper_end() -> None:
    known = [Version(text) for text in ("2.3.7", "3.0.0", "3.9.1", "3.10.0", "4.0.0", "4.0.1", "4.1.0")]
    assert [str(one) for one in within(known, "3.0..4.0")] == ["3.0.0", "3.9.1", "3.10.0", "4.0.0", "4.0.1"]
    assert [str(one) for one in within(known, "3.10..")] == ["3.10.0", "4.0.0", "4.0.1", "4.1.0"]
    assert released("any", "4.0.0,3.3.0") == ["3.3.0", "4.0.0"]
    with pytest.raises(VersionsError, match=r"^--versions 5\.\.6 must .*: choose a range within 2\.3\.7\.\.4\.1\.0$"):
        within(known, "5..6")
    with pytest.raises(VersionsError, match="is not a version"):
        released("any", "newest")


def test_figures_of_a_version() -> None:
    found = {figure.name: figure.value for figure in figures_of([record()])}
    assert found == {
        "levels of four_stack-3": 3.0,
        "creep of four_stack-3": 4e-6,
        "sink of four_stack-3": 1e-4,
        "frame time of four_stack-3": pytest.approx(2.0),
    }
    late = {figure.name: figure.value for figure in figures_of([record(status="timeout", height_levels=1)])}
    assert late["levels of four_stack-3"] is None, "a time-out is censored, never a height"
    assert late["frame time of four_stack-3"] is None, "fewer bricks were in its frames"
    assert first_failure([record(status="error", message="no knob")]) == (
        "none of the 1 trials has figures, for example: error: no knob"
    )


def test_a_series_has_a_place_for_each_version() -> None:
    table = [[Figure("a", "levels", "levels", 1.0)], [], [Figure("a", "levels", "levels", 2.0)]]
    assert [one.values for one in as_series(table)] == [[1.0, None, 2.0]]


def test_a_step_is_explained_by_the_line_of_its_version_and_a_page_is_written(tmp_path) -> None:
    quotes = tmp_path / "quotes.toml"
    quotes.write_text(
        '[[explanation]]\nversion = "3.0"\nquote = "Softer <contacts>."\nlink = "https://example.org/changes"\n'
    )
    points = [measured("1.0"), measured("2.0"), measured("3.0", record(height_levels=2)), Measured("4.0", message="x")]
    built = build_history(
        points, subject="bullet", package="pybullet", study="s", commit="c", explanations=read_explanations(quotes)
    )
    (step,) = built.steps
    assert (step.version, step.previous, step.before, step.after) == ("3.0", "2.0", 3.0, 2.0)
    assert step.explanation is not None
    write_history(tmp_path / "history.json", built)
    assert read_history(tmp_path / "history.json") == built
    write_history_page(tmp_path / "index.html", built)
    page = (tmp_path / "index.html").read_text()
    assert "Softer &lt;contacts&gt;." in page
    assert "<svg" in page
    unexplained = build_history(points, subject="bullet", package="", study="s", commit="c")
    write_history_page(tmp_path / "index.html", unexplained)
    assert "unexplained" in (tmp_path / "index.html").read_text()
    assert [one["version"] for one in tracked_versions(built)] == ["1.0", "2.0", "3.0"]


def test_a_published_history_has_its_data_page_and_tables(tmp_path) -> None:
    write_study(load_study("history"), tmp_path / "run")
    built = build_history([measured("1.0"), measured("2.0")], subject="bullet", package="", study="s", commit="c")
    folder = publish_history(built, tmp_path / "run", tmp_path / "history", None)
    assert {path.name for path in folder.iterdir()} == {
        "history.json", "index.html", "figure.svg", "tables.md", "study.toml",
    }  # fmt: skip
    assert "| bullet | 1.0 to 2.0 | 2 |" in (tmp_path / "history" / "all" / "summary.md").read_text()


def test_a_history_continues_and_keeps_the_reason_of_a_version_that_fails(tmp_path) -> None:
    ran: list[str] = []

    def run(folder: Path) -> None:
        ran.append(folder.name)
        if folder.name == "2.0":
            raise CheckoutError(f"no wheel in {Path.home()}/x")
        (folder / "trials.jsonl").write_text(record().model_dump_json() + "\n")
        (folder / "environment.json").write_text(json.dumps({"engines": {}, "processor": "P"}))

    for version in ("1.0", "2.0", "1.0", "2.0"):
        measure._measure(version, tmp_path, run, SILENT)
    assert ran == ["1.0", "2.0"]
    assert read_measured("1.0", tmp_path).figures
    assert read_measured("2.0", tmp_path).message == "no wheel in .../x"
    measure.forget_failed(tmp_path)
    measure._measure("2.0", tmp_path, run, SILENT)
    assert ran == ["1.0", "2.0", "2.0"]


def test_another_study_needs_another_folder(tmp_path) -> None:
    write_study(load_study("history"), tmp_path)
    write_study(load_study("history"), tmp_path)
    with pytest.raises(CheckoutError, match="another study"):
        write_study(load_study("ci"), tmp_path)


def test_bad_explanations_are_reported(tmp_path) -> None:
    path = tmp_path / "quotes.toml"
    for text, reason in (
        ("[[explanation", "cannot read this file"),
        (
            '[[explanation]]\nversion = "1"',
            r"quotes\.toml: \[\[explanation\]\] 1: field 'quote': Field required; correct the table",
        ),
        ("explanation = 3", "must be tables, got 3: write"),
    ):
        path.write_text(text)
        with pytest.raises(HistoryError, match=reason):
            read_explanations(path)


def test_records_that_a_branch_kept_are_read_in_their_order(tmp_path, monkeypatch) -> None:
    def git(*words: str) -> None:
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a", *words], cwd=tmp_path, check=True)

    git("init", "-q", "-b", "records")
    for number in (1, 2):
        (tmp_path / "kept.json").write_text(str(number))
        git("add", "kept.json")
        git("commit", "-q", "-m", "nightly")
    monkeypatch.setattr(versions, "ROOT", tmp_path)
    assert [content for _, content in kept_records("records:kept.json")] == [b"1", b"2"]
    for wanted, reason in (("records", "BRANCH:PATH"), ("records:none.json", "no commit")):
        with pytest.raises(VersionsError, match=reason):
            kept_records(wanted)


def test_a_message_is_the_error_of_the_command_without_warnings_and_files() -> None:
    output = "UserWarning: odd\nerror: engine 'e' cannot be loaded (cannot\nimport name 'n' from 'p' (/home/me/p.py))"
    with pytest.raises(CheckoutError) as caught:
        call("1.0", [sys.executable, "-c", f"import sys; sys.exit({output!r})"], Path.cwd())
    assert str(caught.value).endswith(
        "failed; correct this error: engine 'e' cannot be loaded (cannot import name 'n' from 'p' (/home/me/p.py))"
    )
    assert _plain(str(caught.value), [Path("/home/me")]).endswith("(cannot import name 'n' from 'p')")


def test_the_terminal_shows_steps_and_the_versions_that_failed(capsys) -> None:
    points = [measured("1.0"), measured("2.0", record(height_levels=2)), Measured("3.0", message="no such file")]
    _show(build_history(points, subject="bullet", package="", study="s", commit="c"), as_json=False)
    lines = capsys.readouterr().out.splitlines()
    assert any(line.split() == ["3.0", "no", "such", "file"] for line in lines)
    assert any(line.split()[:4] == ["2.0", "levels", "of", "four_stack-3"] for line in lines), "a step is one line"
    assert "2 versions have figures." in lines
