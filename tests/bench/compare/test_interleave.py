"""Two versions run in turns: which runs when, and what becomes of the runs."""

import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from bench.cli.app import app
from bench.compare import checkouts
from bench.compare.checkouts import Checkout, CheckoutError, prepare
from bench.compare.comparison import compare_runs
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
            prepare(version, [], SILENT)


def test_a_folder_is_used_as_it_is(tmp_path) -> None:
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "__main__.py").touch()
    with pytest.raises(CheckoutError, match="run 'uv sync' there"):
        prepare(str(tmp_path), [], SILENT)
    with pytest.raises(CheckoutError, match=r"install x\.whl in its environment"):
        prepare(str(tmp_path), ["x.whl"], SILENT)


def test_a_version_that_cannot_run_the_study_is_reported_with_its_last_words(tmp_path) -> None:
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(sys.executable)
    with pytest.raises(CheckoutError, match="No module named"):
        Checkout("old", tmp_path).run(tmp_path / "study.toml", tmp_path / "out")


def test_a_bad_study_or_version_writes_nothing(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for arguments in (["no-such-branch", "HEAD"], ["HEAD", "HEAD", "--study", "smok"]):
        result = CliRunner().invoke(app, ["compare", "--run", *arguments])
        assert result.exit_code == 2, result.output
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not (checkouts.ROOT / ".git").exists(), reason="needs a git checkout")
def test_a_commit_gets_a_checkout_and_an_environment_of_its_own(tmp_path, monkeypatch) -> None:
    """Without a network: what would install it is only recorded."""
    real, asked = checkouts._call, []

    def call(version, command, folder):
        if command[0] == "git":
            return real(version, command, folder)
        asked.append([str(Path(command[0]).name), *command[1:3]])
        return ""

    monkeypatch.setattr(checkouts, "_call", call)
    monkeypatch.setattr(checkouts, "_HOME", tmp_path)
    try:
        plain, other = prepare("HEAD", [], SILENT), prepare("HEAD", ["mujoco==3.3.0"], SILENT)
        assert plain.folder != other.folder
        assert (plain.folder / "bench" / "__main__.py").is_file()
        assert [words[1] for words in asked] == ["sync", "sync", "pip"]
    finally:
        for folder in tmp_path.iterdir():
            subprocess.run(["git", "worktree", "remove", "--force", str(folder)], cwd=checkouts.ROOT, check=True)
