"""The GitHub action in ``action.yml``: its shell steps are run for real, with a study of the user's."""

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.composite_action import CompositeAction

ROOT = Path(__file__).parents[1]
STUDY = """
name = "ours"
description = "One stack that must stand."
engines = ["bullet"]
policies = ["none"]

[[scenario]]
name = "four_stack"
parameters = { levels = 3 }
"""


@pytest.fixture
def action(tmp_path) -> CompositeAction:
    workspace, temp = tmp_path / "workspace", tmp_path / "temp"
    workspace.mkdir()
    temp.mkdir()
    (workspace / "ours.toml").write_text(STUDY)
    return CompositeAction(ROOT, workspace, temp)


def test_every_shell_step_is_sound_bash_and_names_only_what_exists(action) -> None:
    inputs = {f"inputs.{name}" for name in action.definition["inputs"]}
    for step in action.steps:
        named = set(re.findall(r"\binputs\.[\w-]+", str(step)))
        assert named <= inputs, step
        if "run" in step:
            script = re.sub(r"\$\{\{.*?\}\}", "0", step["run"])
            subprocess.run(["bash", "-n"], input=script.encode(), check=True)


@pytest.mark.slow
def test_the_action_runs_a_study_keeps_its_baseline_and_fails_on_a_regression(action, tmp_path) -> None:
    """The cache between jobs is the runner's folder, which stays here; the regression is a plant in the second run."""
    results = tmp_path / "temp" / "stillstack"

    assert action.run(study="ours.toml") == 0
    assert "there is no baseline yet" in action.summary.read_text()
    assert (results / "baseline.json").exists()

    assert action.run(study="ours.toml") == 0
    assert "**Stacking: no alarm**" in action.summary.read_text()
    assert (results / "comparison.xml").exists()

    planted = tmp_path / "planted"
    planted.mkdir()
    (planted / "sitecustomize.py").write_text("import one_level_less\n")
    paths = os.pathsep.join(map(str, (planted, ROOT, ROOT / "tests/bench/plants")))
    assert action.run({"PYTHONPATH": paths}, study="ours.toml") == 1
    assert "four&#95;stack-3" in (results / "comparison.md").read_text()
    assert action.run(study="ours.toml") == 0, "the good baseline again"

    server = tmp_path / "server"
    subprocess.run(["git", "init", "--quiet", "--bare", server / "us" / "engine"], check=True)
    job = {"GITHUB_SERVER_URL": server.as_uri(), "GITHUB_REPOSITORY": "us/engine", "GITHUB_RUN_ATTEMPT": "1"}
    for run in ("7", "8"):
        assert (
            action.run(job | {"GITHUB_RUN_ID": run, "PYTHONPATH": paths}, study="ours.toml", pictures_branch="fell")
            == 1
        )
        assert f"/us/engine/raw/fell/{run}-1/1.png)" in (results / "comparison.md").read_text()
        assert action.run(study="ours.toml") == 0
    kept = ["git", "-C", server / "us" / "engine", "ls-tree", "-r", "--name-only", "fell"]
    assert subprocess.run(kept, capture_output=True, text=True, check=True).stdout.split() == ["7-1/1.png", "8-1/1.png"]
