"""``bench replay``: show a trial in the browser, or export it as glTF."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import input_errors, note, read_folder, relative
from reports.records.atomic import write_atomic
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.replays.gltf import to_glb
from reports.replays.replay import Replayed
from reports.replays.stacks import read_stack, stack_of, write_stack_replay
from scenarios.lookup import look_up


def replay(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    trial: Annotated[str, typer.Argument(help="Id of a trial in that folder.")],
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open the replay in the browser.")] = True,
    gltf: Annotated[
        Path | None, typer.Option(metavar="FILE.glb", help="Write the trial as animated glTF instead of a replay.")
    ] = None,
) -> None:
    """Show a trial in the browser, side by side with the other policies on the same stack."""
    with input_errors():
        if gltf is not None:
            export_gltf(folder, read_folder(folder), trial, gltf)
            note(f"the animation is {relative(gltf)}")
            return
        page = replay_trial(folder, read_folder(folder), trial)
    note(f"the replay is {relative(page)}")
    if show and not webbrowser.open(page.resolve().as_uri()):
        note("no browser could be opened: open that file in a browser yourself")


def replay_trial(folder: Path, records: Sequence[TrialRecord], trial: str) -> Path:
    """Write the replay of a trial, side by side with the same stack under the other policies; return its path.

    Raises:
        UnknownNameError: if there is no such trial.
        RecordingError: if the trial was not recorded, or its recording is incomplete.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    shown = Replayed(wanted, ResultsFolder(folder).recording(wanted.trial))
    others = [record for record in records if stack_of(record) == stack_of(wanted) and record.trial != wanted.trial]
    return write_stack_replay(folder, [shown, *read_stack(folder, others)])


def export_gltf(folder: Path, records: Sequence[TrialRecord], trial: str, to: Path) -> None:
    """Write a trial's recording as an animated glTF file.

    Raises:
        UnknownNameError: if there is no such trial.
        RecordingError: if the trial was not recorded, or its recording is incomplete.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    write_atomic(to, to_glb(ResultsFolder(folder).recording(wanted.trial)))
