"""A comparison draws what fell, once for all repeats, and its Markdown shows the picture at the address it is given."""

from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from bench.cli import alarm_pictures
from bench.cli.app import app
from reports.records.trial import TrialRecord
from reports.replays.errors import ExportError
from tests.reports.replays.test_stills import recording
from tests.reports.studies import record

STUDY = 'name = "ours"\n[limits]\ntrial_wall_s = 60\n[[scenario]]\nname = "four_stack"\n'
FELL = {"status": "collapsed", "height_levels": 1, "collapse_level": 2, "verdict": "false_collapse"}


def run(folder: Path, **changes: object) -> Path:
    """Five repeats of a trial in a results folder without an environment: so many decide, whatever the engine."""
    folder.mkdir()
    (folder / "study.toml").write_text(STUDY)
    records = [record(trial=f"the/trial.r{repeat}", repeat=repeat, **changes) for repeat in range(5)]
    lines = [TrialRecord.model_validate(one.model_dump()).model_dump_json() for one in records]
    (folder / "trials.jsonl").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture
def sides(tmp_path, monkeypatch) -> tuple[str, str]:
    """A run that stands and one that falls; the recordings are made up, because the trials are."""
    shown = replace(recording(apart=0.05), frames=60)
    monkeypatch.setattr("reports.records.folder.read_recording", lambda _: shown)
    return str(run(tmp_path / "base")), str(run(tmp_path / "head", **FELL))


def compare(*arguments: object, status: int) -> str:
    result = CliRunner().invoke(app, ["compare", *map(str, arguments)])
    assert result.exit_code == status, result.output
    return " ".join(result.output.split())


def test_what_fell_is_drawn_once_and_shown_at_its_address(sides, tmp_path) -> None:
    page, pictures = tmp_path / "m.md", tmp_path / "pictures"
    output = compare(*sides, "--markdown", page, "--pictures", pictures, "--pictures-at", "https://host/run", status=1)
    if "no renderer" in output:
        pytest.skip(output)
    assert [path.name for path in pictures.iterdir()] == ["1.png"]
    with Image.open(pictures / "1.png") as picture:
        assert picture.size == (960, 540)
    assert page.read_text().count("](https://host/run/1.png)") == 1


def test_without_an_alarm_there_is_no_picture(sides, tmp_path) -> None:
    for heads in ((sides[0], sides[0]), (sides[0], sides[1], "--fail-on", "time")):
        compare(*heads, "--pictures", tmp_path / "pictures", status=0)
    assert not (tmp_path / "pictures").exists()


def test_a_picture_that_cannot_be_drawn_leaves_the_verdict(sides, tmp_path, monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise ExportError("no renderer here: install one")

    monkeypatch.setattr(alarm_pictures, "write_still", refuse)
    page = tmp_path / "m.md"
    output = compare(*sides, "--markdown", page, "--pictures", tmp_path / "pictures", status=1)
    assert "no picture of the/trial.r0: no renderer here" in output
    assert "![" not in page.read_text()


def test_pictures_need_the_recordings_of_the_head(sides, tmp_path) -> None:
    assert "needs a results folder as HEAD" in compare(
        sides[0], tmp_path / "head.json", "--pictures", tmp_path / "p", status=2
    )
