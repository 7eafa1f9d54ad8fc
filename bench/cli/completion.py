"""Shell completion: the command ``bench`` with the names of studies, engines, scenes, profiles and policies.

A shell completes the arguments of a command whose name is one word, but ``uv run -m bench`` consists of several words.
Therefore the installed script defines ``bench`` as a shell function that runs ``uv run -m bench``, and registers a
completion for the arguments of ``bench``.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path

import typer

from adapters import ENGINES
from adapters.profile_files import FOLDER
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import study_names
from scenarios.registry import SCENARIOS

COMPLETE = "_BENCH_COMPLETE"
"""Name of the environment variable that a shell sets to request completions."""
_BASH = f"""\
bench() {{ uv run -m bench "$@"; }}
_bench_names() {{
    local IFS=$'\\n'
    COMPREPLY=($(env COMP_WORDS="${{COMP_WORDS[*]}}" COMP_CWORD=$COMP_CWORD {COMPLETE}=complete_bash \
        uv run -m bench 2>/dev/null))
}}
complete -o default -F _bench_names bench
"""
_ZSH = f"""\
autoload -Uz compinit && compinit
bench() {{ uv run -m bench "$@" }}
_bench_names() {{
    eval "$(_TYPER_COMPLETE_ARGS="${{words[1,$CURRENT]}}" {COMPLETE}=complete_zsh uv run -m bench 2>/dev/null)"
}}
compdef _bench_names bench
"""
_FISH = f"""\
function bench; uv run -m bench $argv; end
function _bench_names
    set -lx {COMPLETE} complete_fish
    set -lx _TYPER_COMPLETE_FISH_ACTION $argv[1]
    set -lx _TYPER_COMPLETE_ARGS (commandline -cp)
    uv run -m bench 2>/dev/null
end
complete --command bench --no-files --arguments "(_bench_names get-args)" --condition "_bench_names is-args"
"""
SCRIPTS = {"bash": _BASH, "zsh": _ZSH, "fish": _FISH}
"""Script of each supported shell."""


def completing(names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return a function that lists the names in ``names()`` with a typed text at their start."""

    def complete(incomplete: str) -> list[str]:
        return sorted(name for name in names() if name.startswith(incomplete))

    return complete


def profile_names() -> set[str]:
    """Return the names of all profiles, from the profile files, because engines take seconds to load."""
    files = (tomllib.loads(file.read_text(encoding="utf-8")) for file in FOLDER.glob("*.toml"))
    return {name for content in files for name in content.get("profiles", ())}


STUDY = completing(study_names)
ENGINE = completing(lambda: ENGINES)
SCENARIO = completing(lambda: SCENARIOS)
POLICY = completing(lambda: BENCH_POLICIES)
PROFILE = completing(profile_names)


def show_completion(wanted: bool) -> None:
    """Print the completion script of the present shell and exit, if ``wanted`` is True.

    Raises:
        BadParameter: if SHELL names no supported shell.
    """
    if wanted:
        typer.echo(SCRIPTS[_shell()], nl=False)
        raise typer.Exit


def install_completion(wanted: bool) -> None:
    """Write the completion script of the present shell, make new shells load it, and exit, if ``wanted`` is True.

    Raises:
        BadParameter: if SHELL names no supported shell.
    """
    if not wanted:
        return
    shell = _shell()
    script = _write_script(shell, Path.home())
    typer.echo(
        f"completion for {shell}: {script}; in a new terminal, in the folder of the checkout, type bench run and Tab"
    )
    raise typer.Exit


def complete_if_asked(app: typer.Typer) -> None:
    """Print completions and exit if the environment contains ``COMPLETE``; else return."""
    if COMPLETE in os.environ:
        # typer registers the shells itself only if it has its own options for completion
        from typer.completion import completion_init  # type: ignore[attr-defined]

        completion_init()
        app(complete_var=COMPLETE)


def _write_script(shell: str, home: Path) -> Path:
    """Write the script of a shell below the home folder; return the script's path.

    For bash and zsh, also add a line that loads the script to the shell's settings, unless the line exists.
    """
    if shell == "fish":
        script = home / ".config" / "fish" / "conf.d" / "stillstack.fish"  # fish loads every file of this folder
    else:
        script = home / ".config" / "stillstack" / f"completion.{shell}"
    script.parent.mkdir(parents=True, exist_ok=True)
    script.write_text(SCRIPTS[shell], encoding="utf-8")
    if shell != "fish":
        settings, line = home / f".{shell}rc", f"source '{script}'"
        text = settings.read_text(encoding="utf-8") if settings.exists() else ""
        if line not in text:
            separator = "" if not text or text.endswith("\n") else "\n"
            settings.write_text(f"{text}{separator}{line}\n", encoding="utf-8")
    return script


def _shell() -> str:
    shell = os.environ.get("SHELL", "")
    name = Path(shell).name
    if name not in SCRIPTS:
        got = repr(shell) if shell else "no path"
        raise typer.BadParameter(
            f"the environment variable SHELL must be the path of bash, zsh or fish, got {got}: give such "
            "a path, for example SHELL=/bin/bash"
        )
    return name
