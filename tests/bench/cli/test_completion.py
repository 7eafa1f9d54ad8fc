"""Shells complete the names of studies, engines, scenes, profiles and policies."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner

from adapters import ENGINES
from bench.cli import completion
from bench.cli.app import app
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import study_names
from scenarios.registry import SCENARIOS

RUNNER = CliRunner()


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("bench run tr", [name for name in study_names() if name.startswith("tr")]),
        ("bench run --engine ", sorted(ENGINES)),
        ("bench run --scenario leaning", [name for name in SCENARIOS if name.startswith("leaning")]),
        ("bench run --policy ", sorted(BENCH_POLICIES)),
        ("bench run --profile ga", ["game"]),
        ("bench check bu", ["bullet"]),
        ("bench compare a b --run --study smo", ["smoke"]),
        ("bench rep", ["report", "replay"]),
    ],
)
def test_names_are_completed(words: str, names: list[str], monkeypatch, capsys) -> None:
    """What bash is offered for the last word."""
    assert names, "the suite has such names"
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
    monkeypatch.setenv(completion.COMPLETE, "complete_bash")
    with pytest.raises(SystemExit) as ended:
        completion.complete_if_asked(app)
    assert ended.value.code == 0
    assert sorted(capsys.readouterr().out.split()) == sorted(names)


@pytest.mark.parametrize("shell", completion.SCRIPTS)
def test_the_script_of_a_shell_is_printed_and_is_one_that_the_shell_reads(shell: str, monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("SHELL", f"/usr/bin/{shell}")
    shown = RUNNER.invoke(app, ["--show-completion"])
    assert shown.exit_code == 0
    assert "uv run -m bench" in shown.stdout
    if shutil.which(shell):
        (tmp_path / "script").write_text(shown.stdout)
        subprocess.run([shell, "-n", str(tmp_path / "script")], check=True)


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_offers_what_the_suite_answers(tmp_path) -> None:
    """The function of the script, with a stand-in for ``uv run -m bench`` that reports what it is asked."""
    (tmp_path / "uv").write_text(
        '#!/bin/sh\necho "$*"\necho "$_BENCH_COMPLETE"\necho "$COMP_WORDS"\necho "$COMP_CWORD"\n'
    )
    (tmp_path / "uv").chmod(0o755)
    lines = [
        f'PATH="{tmp_path}:$PATH"',
        completion.SCRIPTS["bash"],
        "COMP_WORDS=(bench run tr); COMP_CWORD=2; _bench_names",
        r'printf "%s\n" "${COMPREPLY[@]}"; complete -p bench',
    ]
    done = subprocess.run(["bash", "-c", "\n".join(lines)], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [
        "run -m bench", "complete_bash", "bench", "run", "tr", "2", "complete -o default -F _bench_names bench"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("shell", "script", "settings"),
    [
        ("bash", ".config/stillstack/completion.bash", ".bashrc"),
        ("zsh", ".config/stillstack/completion.zsh", ".zshrc"),
        ("fish", ".config/fish/conf.d/stillstack.fish", None),
    ],
)
def test_installing_twice_loads_the_script_once(shell: str, script: str, settings, monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("SHELL", f"/bin/{shell}")
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    if settings:
        (tmp_path / settings).write_text("alias ll='ls -l'")
    for _ in range(2):
        done = RUNNER.invoke(app, ["--install-completion"])
        assert done.exit_code == 0
        assert script in done.stdout.replace("\n", "")
    assert (tmp_path / script).read_text() == completion.SCRIPTS[shell]
    if settings:
        assert (tmp_path / settings).read_text() == f"alias ll='ls -l'\nsource '{tmp_path / script}'\n"


def test_another_shell_is_refused_with_the_ones_that_there_are(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("SHELL", "/bin/csh")
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    refused = RUNNER.invoke(app, ["--install-completion"])
    assert refused.exit_code == 2
    assert "bash, zsh or fish, got '/bin/csh': give such a path" in " ".join(refused.output.replace("│", " ").split())
    assert list(tmp_path.iterdir()) == []
