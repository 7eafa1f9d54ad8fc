"""``bench check``: run the conformance checks on the adapter of one engine and print each result."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from adapters import open_engine, profile_named, register_command
from adapters.conformance import CHECKS
from bench.cli.completion import ENGINE, PROFILE
from bench.cli.console import OUT, input_errors
from scenarios.model import Brick


def check(
    engine: Annotated[
        str, typer.Argument(help="Name of an engine; omit it with --bridge.", autocompletion=ENGINE)
    ] = "",
    profile: Annotated[str, typer.Option(help="Profile of the engine.", autocompletion=PROFILE)] = "game",
    bridge: Annotated[str, typer.Option(help="Command that starts an engine behind the bridge.")] = "",
    profiles: Annotated[
        Path | None, typer.Option(help="With --bridge: TOML file with the profiles of that engine.")
    ] = None,
) -> None:
    """Check the adapter of an engine against the contract of the core."""
    if bool(engine) == bool(bridge):
        got = f"both '{engine}' and --bridge '{bridge}': leave out" if engine else "neither: give"
        raise typer.BadParameter(
            f"expected either the name of an engine or --bridge COMMAND, got {got} the name or --bridge"
        )
    with input_errors():
        if bridge:
            engine = register_command(shlex.split(bridge), profiles)
        failed = check_engine(engine, profile, OUT)
    raise typer.Exit(1 if failed else 0)


def _knobs(engine: str, profile: str) -> Iterator[str]:
    """Yield one line per knob of the profile: the value that the engine reports, or a note that the value is absent.

    Yield only the reason if the engine fails.
    """
    plank = Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.0, 0.0039))
    try:
        simulation = open_engine(engine, profile, expected=[plank])
        simulation.spawn(plank)
        read, wanted = simulation.read_knobs(), simulation.info.profile.values
        simulation.close()
    except Exception as error:  # the checks have already reported it
        yield f"knobs   not read back, because the engine failed: {error}"
        return
    for name, value in wanted.items():
        shown = f"read back {read[name]!r}" if name in read else "not shown by the engine"
        yield f"knob    {name} = {value!r}: {shown}"


def check_engine(engine: str, profile: str, console: Console) -> int:
    """Run all applicable checks, print the result of each check, and return the number of failures.

    Raises:
        UnknownNameError: if no engine, no profile of the engine or no variation has the name.
        ProfileError: if the value of a variation is invalid.
        EngineNotInstalledError: if the engine does not load.
    """
    profile_named(engine, profile)  # report a wrong name once, not in every check
    counts = {"ok": 0, "n/a": 0, "FAILED": 0}
    for check in CHECKS:
        promise = check.name.replace("_", " ")
        if not check.applies(engine, profile):
            counts["n/a"] += 1
            console.print(f"n/a     {promise}", markup=False, highlight=False)
            continue
        try:
            check.run(engine, profile)
        except Exception as error:  # an engine may fail a check in any way, and the other checks still run
            counts["FAILED"] += 1
            console.print(f"FAILED  {promise}: {error}", markup=False, highlight=False, soft_wrap=True)
        else:
            counts["ok"] += 1
            console.print(f"ok      {promise}", markup=False, highlight=False)
    for line in _knobs(engine, profile):
        console.print(line, markup=False, highlight=False)
    summary = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    console.print(
        f"{engine} with profile {profile}: {summary}; check another profile with --profile",
        markup=False,
        highlight=False,
    )
    return counts["FAILED"]
