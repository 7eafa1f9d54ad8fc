"""Publishing copies what a run left, and refuses what readers must not be shown."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from bench.machine.core_digest import present_core
from bench.publishing.catalogue import PUBLICATIONS, Publication
from bench.publishing.publish import WITHOUT_TIMES, PublishError, main, publish
from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from bench.studies.selection import Selection
from bench.studies.toml_text import to_toml
from reports.records.folder import ResultsFolder
from reports.records.trial import RecordWriter
from scenarios.lookup import UnknownNameError
from tests.reports.studies import record

STUDY = """
name = "made-up"
engines = ["bullet"]
policies = ["none", "paper"]

[[scenario]]
name = "leaning_tower"
"""


@pytest.fixture
def run(tmp_path, monkeypatch) -> Path:
    """A whole results folder of a study that is to be published as "made-up"."""
    file = tmp_path / "made-up.toml"
    file.write_text(STUDY)
    monkeypatch.setitem(PUBLICATIONS, "made-up", Publication("something", str(file)))
    folder = tmp_path / "results"
    figures = folder / "report" / "figures"
    figures.mkdir(parents=True)
    study = load_study(str(file))
    (folder / "study.toml").write_text(to_toml(study))
    writer = RecordWriter(folder / "trials.jsonl")
    for trial in plan_trials(study):
        writer.append(record(scene=trial.scene, policy=trial.policy, trial=trial.id))
    writer.close()
    figures = ("figures/speed.svg", "figures/speed.pdf", "figures/pairs.svg")
    for name in ("tables.md", "trials.csv", "tables.tex", "index.html", *figures):
        (folder / "report" / name).write_text(name)
    write_environment(folder, modified=False)
    return folder


def write_environment(folder: Path, **changed) -> None:
    environment = {"commit": "c0ffee", "modified": False, "core": present_core(), **changed}
    (folder / "environment.json").write_text(json.dumps(environment))


def test_tables_trials_figures_and_where_they_come_from_are_copied(run, tmp_path) -> None:
    target = publish("made-up", run, tmp_path / "docs")
    found = {str(path.relative_to(target)) for path in target.rglob("*") if path.is_file()}
    assert found == {
        "tables.md", "trials.parquet", "figure.svg", "study.toml", "environment.json"
    }  # fmt: skip
    assert ResultsFolder(target).records == ResultsFolder(run).records
    assert (target / "figure.svg").read_text() == "figures/pairs.svg", "it shows more than the speed"
    assert (target / "tables.md").read_text() == f"tables.md\n\ncore: {present_core()}\n"


def test_a_study_that_is_not_about_cost_shows_no_times(run, tmp_path, monkeypatch) -> None:
    """Its trials may have been run several at a time: neither tables nor figure of times, and no ranking by them."""
    monkeypatch.setitem(PUBLICATIONS, "made-up", replace(PUBLICATIONS["made-up"], is_timed=False))
    (run / "report" / "figures" / "pairs.svg").unlink()
    target = publish("made-up", run, tmp_path / "docs")
    text = (target / "tables.md").read_text()
    assert WITHOUT_TIMES in text
    assert "## Outcomes" in text
    assert "## Frame time" not in text
    assert "## Comparison" not in text
    assert not (target / "figure.svg").exists()


def test_results_of_an_earlier_core_are_marked_as_such(run, tmp_path) -> None:
    """It ran before the core changed: a folder that is published late."""
    write_environment(run, core="0123456789ab")
    text = (publish("made-up", run, tmp_path / "docs") / "tables.md").read_text()
    assert text.startswith("> **Made with an earlier core (digest `0123456789ab`); not yet made again")
    assert text.endswith("\n\ntables.md\n\ncore: 0123456789ab\n")


@pytest.mark.parametrize(
    ("arguments", "got"),
    [
        ([], "none"),
        (["paper", "--mark"], "NAME, --mark"),
        (["--round", "2026-01-01", "--archive", "2026-01-01"], "--round, --archive"),
    ],
)
def test_exactly_one_job_is_asked_for(arguments: list[str], got: str) -> None:
    app = typer.Typer()
    app.command()(main)
    text = CliRunner().invoke(app, arguments)
    assert text.exit_code == 2
    message = f"expected exactly one of NAME (a publication), --mark, --round or --archive, got {got}: give one"
    assert message in " ".join(text.output.replace("│", "").split())


def test_figures_of_before_are_gone_and_what_others_published_stays(run, tmp_path) -> None:
    target = tmp_path / "docs" / "made-up"
    (target / "figures").mkdir(parents=True)
    (target / "figures" / "old.svg").touch()
    (target / "trials.csv").touch()
    (target / "decisions.md").touch()
    publish("made-up", run, tmp_path / "docs")
    assert not (target / "figures").exists()
    assert not (target / "trials.csv").exists()
    assert (target / "decisions.md").exists()


def test_half_a_study_is_refused_with_the_command_that_goes_on(run, tmp_path) -> None:
    lines = (run / "trials.jsonl").read_text().splitlines(keepends=True)
    (run / "trials.jsonl").write_text(lines[0])
    with pytest.raises(PublishError, match=rf"lacks \S+: run uv run -m bench run \S+ --out {run}"):
        publish("made-up", run, tmp_path / "docs")
    assert not (tmp_path / "docs").exists()


@pytest.mark.parametrize("changed", [{"modified": True}, {"commit": None}])
def test_what_no_commit_holds_is_refused(run, tmp_path, changed) -> None:
    write_environment(run, **changed)
    with pytest.raises(PublishError, match=r"must use committed sources, got modified = .*; commit the changes"):
        publish("made-up", run, tmp_path / "docs")


def test_another_study_and_an_unknown_name_are_refused(run, tmp_path) -> None:
    with pytest.raises(
        PublishError,
        match=r"the study 'paper' with .*, but contains another study: run uv run -m bench run paper --engine physx",
    ):
        publish("claims", run, tmp_path / "docs")
    with pytest.raises(UnknownNameError, match="did you mean 'paper'"):
        publish("papper", run, tmp_path / "docs")


def test_the_command_of_a_publication_says_all_that_was_chosen() -> None:
    chosen = Selection(engines=("physx",), policies=("none", "paper"), seeds=3)
    arguments = ["paper", "--engine", "physx", "--policy", "none", "--policy", "paper", "--seeds", "3"]
    assert Publication("", "paper", chosen).arguments == arguments


@pytest.mark.parametrize("name", PUBLICATIONS)
def test_every_publication_can_be_planned_and_has_the_scenes_of_its_picture(name: str) -> None:
    publication = PUBLICATIONS[name]
    trials = plan_trials(publication.resolved())
    assert trials
    if publication.gallery is not None:
        shown = {trial.scene for trial in trials if trial.engine == publication.gallery.engine}
        assert shown >= set(publication.gallery.scenes)
    assert re.fullmatch(r"[a-z0-9_]+", name)
