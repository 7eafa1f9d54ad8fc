"""The command line: bad input ends with status 2 and its fix, and writes nothing; a run keeps what it has finished."""

import json
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from adapters import registry
from bench.cli.app import app
from bench.machine.core_digest import present_core
from bench.studies.plan import Trial, plan_trials
from bench.studies.schema import check_study
from bench.trial.run_trial import bare_record
from reports.records.frames import read_frames
from reports.records.trial import read_records
from scenarios.registry import build

ROOT = Path(__file__).parents[3]
STUDY = """
name = "tiny"
engines = ["bullet"]
policies = ["none", "paper"]

[[scenario]]
name = "four_stack"
parameters = { levels = 2 }
"""


def call(*arguments: str, status: int) -> str:
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == status, result.output
    return " ".join(result.output.split())


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["run", "smok"], "unknown study 'smok'; did you mean 'smoke'?"),
        (["run", "--engine", "bulet"], "unknown engine 'bulet'; did you mean 'bullet'?"),
        (["run", "--scenario", "four_stak"], "unknown scenario 'four_stak'; did you mean 'four_stack'?"),
        (["run", "--policy", "papr"], "unknown policy 'papr'; did you mean 'paper'?"),
        (["run", "--profile", "gam"], "unknown profile of engine bullet 'gam'; did you mean 'game'?"),
        (["run", "--seeds", "0"], "greater than or equal to 1"),
        (["run", "--jobs", "0"], "greater than or equal to 1"),
        (["run", "--jobs", "2", "--dask", "tcp://10.0.0.1:8786"], "--jobs and --dask exclude each other"),
        (["run", "--watch", "--dask", "tcp://10.0.0.1:8786"], "--watch applies to trials on this machine only"),
        (["run", "missing.toml"], "missing.toml: cannot read this file"),
        (["report", "missing"], "trials.jsonl: cannot read this file"),
        (["check", "bulet"], "unknown engine 'bulet'; did you mean 'bullet'?"),
    ],
)
def test_bad_input_names_the_fix_and_writes_nothing(arguments, complaint, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert complaint in call(*arguments, status=2)
    assert not list(tmp_path.iterdir())


def test_a_report_of_no_trial_is_refused_and_a_torn_line_reported(tmp_path) -> None:
    path = tmp_path / "trials.jsonl"
    path.touch()
    assert "needs at least one trial" in call("report", str(tmp_path), status=2)
    study = check_study(tomllib.loads(STUDY), "")
    trial = plan_trials(study)[0]
    record = bare_record(trial, trial.build_scene(), "abc", "completed", "").model_dump_json()
    path.write_text(f"{record}\n{record[:50]}")
    printed = call("report", str(tmp_path), status=0)
    assert "warning:" in printed
    assert "trials.jsonl:2: the last line is incomplete; the reader skips it" in printed


def test_a_replay_names_the_trials_that_there_are_and_what_was_not_recorded(tmp_path) -> None:
    trial = plan_trials(check_study(tomllib.loads(STUDY), ""))[0]
    record = bare_record(trial, trial.build_scene(), "abc", "completed", "").model_dump_json()
    (tmp_path / "trials.jsonl").write_text(record + "\n")
    printed = call("replay", str(tmp_path), trial.id.replace("bullet", "bulet"), status=2)
    assert f"unknown trial '{trial.id.replace('bullet', 'bulet')}'; did you mean '{trial.id}'?" in printed
    assert "this recording does not exist; run the trial again" in call(
        "replay", str(tmp_path), trial.id, "--no-open", status=2
    )
    picture = ["replay", str(tmp_path), trial.id, "--still", "300x200"]
    assert "unknown camera 'frnt'; did you mean 'front'?" in call(*picture, "--camera", "frnt", status=2)
    assert "unknown policy of a recorded trial of this stack 'paper'" in call(*picture, "--beside", "paper", status=2)
    assert "this recording does not exist; run the trial again" in call(*picture, status=2)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('{"format": 99}', "a record of format 99, newer than this suite's 3: update the suite"),
        ('{"name": "somebody else"}', "not a trial record"),
    ],
)
def test_a_newer_or_foreign_folder_is_refused_and_left_as_it_is(tmp_path, line, complaint) -> None:
    (tmp_path / "trials.jsonl").write_text(line + "\n")
    assert complaint in call("report", str(tmp_path), status=2)
    assert [path.name for path in tmp_path.iterdir()] == ["trials.jsonl"]


def test_a_report_lists_which_planned_trials_are_missing(tmp_path) -> None:
    done, missing, *_ = plan_trials(check_study(tomllib.loads(STUDY), ""))
    record = bare_record(done, done.build_scene(), "abc", "completed", "").model_dump_json()
    (tmp_path / "trials.jsonl").write_text(record + "\n")
    (tmp_path / "study.toml").write_text(STUDY)
    call("report", str(tmp_path), status=0)
    assert f"1 planned trial has no record (not yet run, or interrupted): {missing.id}" in (
        tmp_path / "report" / "index.html"
    ).read_text(encoding="utf-8")


def test_a_folder_that_cannot_be_written_is_refused(tmp_path) -> None:
    file = tmp_path / "file"
    file.touch()
    assert "must be a folder, but is a file: choose another folder with --out" in call(
        "run", "ci", "--out", str(file / "x"), status=2
    )


def test_a_folder_that_holds_trials_of_another_run_is_refused_unless_they_are_to_be_replaced(tmp_path) -> None:
    (tmp_path / "trials.jsonl").touch()
    assert "holds trials of another run" in call("run", "ci", "--out", str(tmp_path), status=2)
    assert "18 trials" in call("run", "ci", "--out", str(tmp_path), "--fresh", "--dry-run", status=0)


def test_a_dry_run_lists_the_trials_and_writes_nothing(tmp_path) -> None:
    printed = call("run", "ci", "--policy", "paper", "--out", str(tmp_path / "x"), "--dry-run", status=0)
    assert printed.startswith("bullet.game.four_stack-3.paper.s0.r0 bullet.game.four_stack-3.paper.s0.r1")
    assert not (tmp_path / "x").exists()


def test_a_dry_run_leaves_out_what_is_already_there(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = build("four_stack", levels=3)
    one = Trial("bullet", "game", "four_stack", scene.variant, {"levels": 3}, "paper", 0, 0)
    record = bare_record(one, scene, "abc", "completed", "", wall_s=3.0)
    (tmp_path / "trials.jsonl").write_text(record.model_dump_json() + "\n")
    printed = call("run", "ci", "--out", str(tmp_path), "--dry-run", status=0)
    assert one.id not in printed
    assert re.search(r"17 trials: about \S+ \S+ \(.*from the same trials, .*from other trials", printed)
    assert "1 more trials are already in the folder" in printed


def test_a_scene_is_exported_and_read_again(tmp_path):
    file = tmp_path / "tower.xml"
    assert "13 bricks" in call("export", "leaning_tower", "--mjcf", "--out", str(file), status=0)
    assert "falls at" in call("list", "--scenario", str(file), status=0)
    assert "expected exactly one format, got none: choose one of --mjcf" in call("export", "leaning_tower", status=2)
    assert "polyhedron" in call("export", "voussoir_arch", "--urdf", status=2)


def test_the_judge_answers_about_a_file():
    printed = call("list", "--scenario", "lintel.toml", "--truth", status=0)
    assert ": falls, 4 bricks in place at 6 s" in printed
    assert "Mechanism" in printed
    printed = call("list", "--scenario", "groove", "--truth", status=0)
    for part in (": stands", "Margins", "tilt of the ground", "friction", "Forces that hold it"):
        assert part in printed
    assert "add --scenario" in call("list", "--truth", status=2)


def test_the_list_shows_scenarios_with_theory_engines_policies_and_studies() -> None:
    printed = call("list", status=0)
    for word in ("four_stack", "falls at 9", "bullet", "contact points", "at_rest", "native", "smoke"):
        assert word in printed


def test_an_engine_that_is_not_installed_is_listed_so_and_the_others_as_ever(monkeypatch) -> None:
    missing = replace(registry.ENGINES["rapier"], module="adapters._missing", package="no-such-package")
    monkeypatch.setitem(registry.ENGINES, "rapier", missing)
    printed = call("list", status=0)
    assert "not installed:" in printed
    assert "uv sync --group engines" in printed
    assert "Engine capabilities" in printed


def test_the_version_names_the_release_and_the_core() -> None:
    assert re.fullmatch(rf"stillstack [\d.]+, core {present_core()}", call("--version", status=0))


def bench(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "bench", *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_a_tiny_study_leaves_records_frames_and_tables(tmp_path) -> None:
    """Two levels of a 4-stack on a real engine: both trials stand, and the steered one ends frozen."""
    study = tmp_path / "tiny.toml"
    study.write_text(STUDY)
    out = tmp_path / "out"
    process = bench("run", str(study), "--out", str(out))
    printed, errors = process.communicate(timeout=900)
    assert process.returncode == 0, errors
    assert "[2/2] bullet.game.four_stack-2.paper.s0.r0: completed, 2 of 2 levels" in errors
    assert "2 trials are kept in" in errors
    assert "2/2 ✓" in printed
    last = printed.rstrip().splitlines()[-1]
    assert last.startswith("Cheapest set-up that is right in the only scene, which must stand: bullet game")

    plain, steered = read_records(out / "trials.jsonl")
    assert [one.verdict for one in (plain, steered)] == ["right", "right"]
    assert plain.core_ms is None
    assert steered.core_ms is not None
    assert steered.frame_ratio_level == 2
    assert steered.frame_ratio is not None
    for one in (plain, steered):
        rows = read_frames(out / "frames" / f"{one.trial}.parquet")
        assert len(rows) == round(one.simulated_s * 60)
        assert rows[-1].live == (8 if one is plain else 0)
    environment = json.loads((out / "environment.json").read_text())
    assert environment["engines"]["bullet"]["capabilities"]["planar"] is False
    tables = (out / "report" / "tables.md").read_text()
    assert "four_stack-2" in tables
    assert len((out / "report" / "trials.csv").read_text().splitlines()) == 3

    (out / "report" / "tables.md").unlink()
    call("report", str(out), status=0)
    assert (out / "report" / "tables.md").read_text() == tables
