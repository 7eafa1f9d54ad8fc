"""``bench list``: print the registries of scenarios, engines, policies and studies."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from adapters import ENGINES, EngineNotInstalledError, Profile, check_installed, profiles
from bench.cli.completion import SCENARIO
from bench.cli.console import OUT, input_errors, note
from bench.cli.judgement import print_judgement
from bench.machine.environment import describe_engine
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import StudyError, load_study, study_names
from bench.studies.selection import is_file
from reports.tables.capabilities import capability_table
from reports.tables.table import render
from scenarios.model import Scene
from scenarios.parameters import Range, Value
from scenarios.registry import SCENARIOS, build
from scenarios.scenario import OF_STATICS


def list_(
    pictures: Annotated[bool, typer.Option("--pictures", help="Draw all scenes into one picture instead.")] = False,
    out: Annotated[Path, typer.Option(help="With --pictures: the file to write, .png, .svg or .pdf.")] = Path(
        "scenes.png"
    ),
    scenario: Annotated[
        str | None,
        typer.Option(help="Only this scenario, or a FILE with your own bricks.", autocompletion=SCENARIO),
    ] = None,
    truth: Annotated[
        bool,
        typer.Option("--truth", help="With --scenario: judge the scene by exact statics, with margins and proof."),
    ] = False,
) -> None:
    """List scenarios, engines, profiles, policies and studies."""
    if truth and scenario is None:
        raise typer.BadParameter("--truth needs one scene, got none: add --scenario NAME or --scenario FILE")
    if scenario is not None:
        with input_errors():
            _print_scene(scenario, is_judged=truth)
        return
    if not pictures:
        print_catalogue(OUT)
        return
    from bench.cli.contact_sheet import draw_contact_sheet  # its imports take a second and only this option needs them

    draw_contact_sheet(out, [build(name) for name in SCENARIOS])
    note(f"{len(SCENARIOS)} scenes drawn in {out}")


def _print_scene(name: str, *, is_judged: bool) -> None:
    """Print the row of one scene, or the judge's answer about the scene.

    Raises:
        UnknownNameError: if no scenario has this name.
        StudyError: if the suite cannot build or judge the scene.
    """
    try:
        scene = build("own_scene", file=name) if is_file(name) else build(name)
        if is_judged:
            print_judgement(scene, OUT)
        else:
            OUT.print(_scenarios({scene.scenario: scene}))
    except ValueError as error:
        raise StudyError(str(error)) from error


def print_catalogue(console: Console) -> None:
    """Print tables of the scenarios, profiles, engine capabilities, policies and studies."""
    for table in (_scenarios({name: build(name) for name in SCENARIOS}), _engines()):
        console.print(table)
        console.print()
    render(capability_table(_descriptors()), console)
    for table in (_policies(), _studies()):
        console.print(table)
        console.print()


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for column in columns:
        table.add_column(column, overflow="fold")
    return table


def _scenarios(scenes: Mapping[str, Scene]) -> Table:
    """Return the table of scenarios; ``scenes`` are their default scenes, by name of the scenario."""
    table = _table("Scenarios", "name", "must, by theory", "theory", "look for")
    for name, scene in scenes.items():
        scenario = SCENARIOS[name]
        lines = [_parameter(key, default, scenario.ranges.get(key)) for key, default in scenario.defaults.items()]
        shared = [", ".join(OF_STATICS)] if scenario.is_static else []
        named = "\n  ".join([name, *lines, *shared])
        table.add_row(named, str(scene.expectation), scene.expectation.theory, scene.look_for)
    table.caption = "; ".join(_parameter(key, default, allowed) for key, (default, allowed) in OF_STATICS.items())
    table.caption_justify = "left"
    return table


def _parameter(name: str, default: Value, allowed: Range | None) -> str:
    """Return the name and default of a parameter and, in brackets, the allowed range."""
    return f"{name}={default}" + (f" ({allowed})" if allowed else "")


def _engines() -> Table:
    table = _table("Engines", "name", "profiles")
    for name in ENGINES:
        try:
            check_installed(name)
            listed = "\n".join(_profile(profile) for profile in profiles(name).values())
        except EngineNotInstalledError as error:
            listed = f"not installed: {error}"
        table.add_row(name, listed)
    table.caption = "Any profile can be varied by name: game@scale=10, tuned@substeps=8,iterations=200, game@hz=240."
    table.caption_justify = "left"
    return table


def _descriptors() -> dict[str, dict[str, Any]]:
    """Return the description of each installed engine, by name, as in the environment of a run."""
    found = {}
    for name in ENGINES:
        try:
            check_installed(name)
            found[name] = describe_engine(name)
        except EngineNotInstalledError:
            continue
    return found


def _profile(profile: Profile) -> str:
    """Return a line with the profile's name, its description and its author."""
    return f"{profile.name}: {profile.description} ({profile.tuned_by})"


def _policies() -> Table:
    table = _table("Policies", "name", "what it is")
    for name, policy in BENCH_POLICIES.items():
        table.add_row(name, policy.description)
    return table


def _studies() -> Table:
    table = _table("Studies", "name", "what it is")
    for name in study_names():
        try:
            table.add_row(name, load_study(name).description)
        except EngineNotInstalledError as error:
            table.add_row(name, f"cannot be run: {error}")
    return table
