"""The list of published results says what each folder holds, and in what a run today would differ."""

import json
from pathlib import Path

import pytest

from bench.machine.environment import describe_engine
from bench.publishing.catalogue import Publication
from bench.publishing.holdings import differences, holdings
from bench.studies.plan import plan_trials
from reports.records.folder import ENVIRONMENT

STUDY = """
name = "small"
engines = ["bullet"]
profiles = ["game", "tuned"]
policies = ["none", "paper"]
repeats = 2
[[scenario]]
name = "card_house"
"""
FIELDS = ("trial", "engine", "profile", "policy", "seed", "repeat")


@pytest.fixture
def publication(tmp_path) -> Publication:
    (tmp_path / "small.toml").write_text(STUDY)
    return Publication("a card house", str(tmp_path / "small.toml"))


def published(folder: Path, publication: Publication, *, without: str = "", iterations: int = 0) -> Path:
    """Write a published folder, without the trials of a profile, or of a run with other iterations of ``tuned``."""
    trials = [trial for trial in plan_trials(publication.resolved()) if trial.profile != without]
    rows = [",".join(str(getattr(trial, "id" if name == "trial" else name)) for name in FIELDS) for trial in trials]
    (folder / "trials.csv").write_text("\n".join([",".join(FIELDS), *rows]) + "\n")
    engine = describe_engine("bullet")
    if iterations:
        engine["profiles"]["tuned"]["knobs"]["numSolverIterations"]["value"] = iterations
    (folder / ENVIRONMENT).write_text(json.dumps({"engines": {"bullet": engine}}))
    return folder


def test_a_folder_lists_what_it_holds(tmp_path, publication) -> None:
    folder = published(tmp_path, publication, without="tuned")
    assert holdings(folder) == "bullet; game; none, paper; 1 seed; 2 repeats; 4 trials"


def test_the_present_study_differs_in_nothing(tmp_path, publication) -> None:
    assert differences(published(tmp_path, publication), publication) == ""


def test_trials_that_the_study_has_now_are_counted(tmp_path, publication) -> None:
    assert differences(published(tmp_path, publication, without="tuned"), publication) == "4 more trials"


def test_a_profile_that_is_set_otherwise_now_is_named(tmp_path, publication) -> None:
    assert differences(published(tmp_path, publication, iterations=7), publication) == "other settings: bullet `tuned`"
    unused = published(tmp_path, publication, without="tuned", iterations=7)
    assert differences(unused, publication) == "4 more trials", "no trial of the folder used it"
