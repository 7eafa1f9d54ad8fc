"""Two versions run in turns: which runs when, and what becomes of the runs."""

import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from bench.cli.app import app
from bench.compare import checkouts, environments, requirements
from bench.compare.checkouts import Checkout, named_by_difference, prepare
from bench.compare.commands import CheckoutError
from bench.compare.comparison import compare_runs
from bench.compare.failures import SideFailedError
from bench.compare.interleave import as_repeats, run_interleaved
from bench.studies.schema import check_study, load_study
from bench.studies.tolerance import Tolerance

SILENT = Console(quiet=True)
STUDY = {
    "name": "tiny",
    "engines": ["bullet"],
    "policies": ["paper"],
    "scenario": [{"name": "four_stack", "parameters": {"levels": 3}, "tolerance": {"levels": 1}}],
}


class Written:
    """A checkout whose runs leave a record made by hand."""

    def __init__(self, name, record, ran) -> None:
        self.name, self._record, self._ran = name, record, ran

    def run(self, study: Path, out: Path) -> None:
        assert load_study(str(study)).scenario[0].tolerance == Tolerance()  # an older version does not know them
        self._ran.append(out.name)
        out.mkdir(parents=True)
        (out / "trials.jsonl").write_text(self._record.model_dump_json() + "\n")
        (out / "study.toml").write_text(study.read_text())


def test_sides_take_turns_in_alternating_order_and_tolerances_are_the_studys(make, tmp_path) -> None:
    ran: list[str] = []
    base, head = Written("a", make.record(), ran), Written("b", make.record(height_levels=2), ran)
    sides = run_interleaved((base, head), check_study(STUDY, ""), 3, tmp_path / "out", SILENT)
    assert ran == ["base-1", "head-1", "head-2", "base-2", "base-3", "head-3"]
    assert not compare_runs(*sides, ("a", "b")).alarms()
    assert [record.repeat for record in sides[1].trials] == [0, 1, 2]


def test_runs_become_repeats_of_one_run(make) -> None:
    first = "bullet.game.four_stack-3.paper.s0.r"
    times = {"engine": 1.0, "readback": 0.3, "core": 0.5}
    run = make.side(
        *(make.record(trial=f"{first}{repeat}", repeat=repeat) for repeat in range(2)),
        shares={f"{first}1": times},
    )
    together = as_repeats([run, run], repeats=2)
    assert [record.trial for record in together.trials] == [f"{first}{repeat}" for repeat in range(4)]
    assert together.shares == {f"{first}1": times, f"{first}3": times}


def test_a_version_that_does_not_exist_is_reported() -> None:
    for version in ("no-such-branch", "--upload-pack=x"):
        with pytest.raises(CheckoutError, match="git rev-parse"):
            prepare(version, [], SILENT, engines=[])


def test_a_folder_is_used_as_it_is(tmp_path) -> None:
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "__main__.py").touch()
    with pytest.raises(CheckoutError, match="run 'uv sync' in the folder"):
        prepare(str(tmp_path), [], SILENT, engines=[])
    with pytest.raises(CheckoutError, match=r"install x\.whl in the environment of the folder"):
        prepare(str(tmp_path), ["x.whl"], SILENT, engines=[])


def test_a_version_that_cannot_run_the_study_is_reported_with_its_last_words(tmp_path) -> None:
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(sys.executable)
    (tmp_path / "bench" / "cli").mkdir(parents=True)
    (tmp_path / "bench" / "cli" / "run.py").touch()
    with pytest.raises(CheckoutError, match="failed; correct this error"):
        Checkout("old", tmp_path, python).run(tmp_path / "study.toml", tmp_path / "out")


def test_a_bad_study_or_version_writes_nothing(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for arguments in (["no-such-branch", "HEAD"], ["HEAD", "HEAD", "--study", "smok"]):
        result = CliRunner().invoke(app, ["compare", "--run", *arguments])
        assert result.exit_code == 2, result.output
    assert not list(tmp_path.iterdir())


class Asked:
    """Records the calls of git and uv; git and the resolver answer as they would, and nothing is installed."""

    def __init__(self, monkeypatch, tmp_path) -> None:
        self.commands: list[list[str]] = []
        self.demands: list[str] = []
        self.overrides: list[str] = []
        self._git = checkouts.call
        monkeypatch.setattr(checkouts, "call", self)
        monkeypatch.setattr(requirements, "call", self)
        monkeypatch.setattr(environments, "call", self)
        monkeypatch.setattr(checkouts, "CACHE", tmp_path)
        monkeypatch.setattr(environments, "CACHE", tmp_path)

    def __call__(self, name, command, folder, fix="") -> str:
        self.commands.append(command)
        if command[0] == "git":
            return self._git(name, command, folder, fix)
        if command[1] == "export":
            return "mujoco==4.0.0\nmujoco-core==4.0.0\nnumpy==2.4.0\nanyio==4.0 ; sys_platform == 'never'\n"
        if command[1:3] == ["pip", "compile"]:
            self.demands = Path(command[3]).read_text().splitlines()
            self.overrides = Path(command[5]).read_text().splitlines()
            out = Path(command[7])
            assert "anyio==4.0" not in out.read_text()  # what this machine does not install is no preference
            chosen = [line for line in self.overrides if "==" in line and ";" not in line]
            out.write_text("".join(f"{pin}\n" for pin in (*chosen, "numpy==2.4.0")))
        return ""


@pytest.mark.skipif(not (checkouts.ROOT / ".git").exists(), reason="needs a git checkout")
def test_a_commit_gets_a_checkout_and_each_set_of_packages_an_environment(tmp_path, monkeypatch) -> None:
    """Without a network: what would install it is only recorded."""
    asked = Asked(monkeypatch, tmp_path)
    try:
        old, new = (
            prepare("HEAD", [f"mujoco=={version}"], SILENT, engines=["mujoco"], allow_dirty=True)
            for version in ("3.3.0", "4.0.0")
        )
        assert old.folder == new.folder
        assert old.python != new.python
        assert (old.folder / "bench" / "__main__.py").is_file()
        assert not any(demand.startswith("pybullet") for demand in asked.demands), "of another engine"
        again = prepare("HEAD", ["mujoco==3.3.0"], SILENT, engines=["mujoco"], allow_dirty=True)
        installed = [command for command in asked.commands if command[1:3] == ["pip", "sync"]]
        assert again == old
        assert len(installed) == 2, "an environment is shared by all comparisons with its packages"
        chosen = (("mujoco==3.3.0",), ("mujoco==4.0.0",))
        assert named_by_difference((old, new), chosen) == ["mujoco 3.3.0", "mujoco 4.0.0"]
    finally:
        for folder in (tmp_path / "checkouts").iterdir():
            subprocess.run(["git", "worktree", "remove", "--force", str(folder)], cwd=checkouts.ROOT, check=True)


def test_releases_get_the_packages_that_their_metadata_forgets(tmp_path, monkeypatch) -> None:
    asked = Asked(monkeypatch, tmp_path)
    requirements.pinned("old", checkouts.ROOT, ["bullet", "physx"], ["pybullet==3.2.6", "sapien==3.0.2"])
    assert {"numpy<2", "setuptools<81"} <= set(asked.overrides)
    requirements.pinned("new", checkouts.ROOT, ["bullet"], ["pybullet==3.2.7"])
    assert "numpy<2" not in asked.overrides


def test_uncommitted_changes_are_refused(tmp_path) -> None:
    for command in (
        ["init", "-q"],
        ["-c", "user.name=a", "-c", "user.email=a", "commit", "-q", "--allow-empty", "-m", "a"],
    ):
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "__main__.py").touch()
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(sys.executable)
    prepare(str(tmp_path), [], SILENT, engines=[])
    subprocess.run(["git", "add", "bench"], cwd=tmp_path, check=True)
    with pytest.raises(CheckoutError, match=r"1 file with uncommitted changes, .*, or give --allow-dirty$"):
        prepare(str(tmp_path), [], SILENT, engines=[], option="--allow-dirty")
    with pytest.raises(CheckoutError, match=r"'git stash' in the folder$"):
        prepare(str(tmp_path), [], SILENT, engines=[])
    assert prepare(str(tmp_path), [], SILENT, engines=[], allow_dirty=True).folder == tmp_path


def test_a_side_whose_trials_all_fail_ends_the_comparison_with_its_first_message(make, tmp_path) -> None:
    ran: list[str] = []
    broken = make.record(status="error", message="no such knob", verdict="failed")
    sides = Written("old", broken, ran), Written("new", make.record(), ran)
    with pytest.raises(SideFailedError, match=r"old: the only trial has no result.*no such knob"):
        run_interleaved(sides, check_study(STUDY, ""), 2, tmp_path / "out", SILENT)
    assert ran == ["base-1"], "the other side need not run"
