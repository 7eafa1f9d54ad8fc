"""The command line: ``uv run -m bench COMMAND``.

The exit status is:

- 0 for success;
- 1 if a gate or a check failed;
- 2 for bad usage or input;
- 128 plus the number of the signal, if a signal interrupted a run.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from adapters import register_external
from bench.cli.baseline import baseline
from bench.cli.check import check
from bench.cli.compare import compare
from bench.cli.completion import install_completion, show_completion
from bench.cli.console import input_errors
from bench.cli.export import export
from bench.cli.history import history
from bench.cli.list import list_
from bench.cli.replay import replay
from bench.cli.report import report
from bench.cli.run import run
from bench.machine.core_digest import present_core

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"stillstack {version('stability-core')}, core {present_core()}")
        raise typer.Exit


@app.callback(help="Do your engine's bricks stand when they should, and fall when they should?")
def add_external_engines(
    _: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
    _install: Annotated[
        bool,
        typer.Option(
            "--install-completion",
            callback=install_completion,
            is_eager=True,
            help="Install the command 'bench' with completion for your shell (bash, zsh or fish) and exit.",
        ),
    ] = False,
    _show: Annotated[
        bool,
        typer.Option(
            "--show-completion", callback=show_completion, is_eager=True, help="Print what would be installed and exit."
        ),
    ] = False,
) -> None:
    """Register the engines outside this repository before any command runs."""
    with input_errors():
        register_external()


for _verb in (run, report, replay, baseline, compare, export, history):
    app.command()(_verb)
app.command(name="list")(list_)
app.command()(check)
