"""``bench replay``: show a trial in the browser, or export it as glTF."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import input_errors, read_folder, relative, tell
from bench.publishing.replays import export_gltf, replay_trial


def replay(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    trial: Annotated[str, typer.Argument(help="Id of one of its trials.")],
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open it in the browser.")] = True,
    gltf: Annotated[
        Path | None, typer.Option(metavar="FILE.glb", help="Write the trial as animated glTF in place of a replay.")
    ] = None,
) -> None:
    """Show a trial in the browser, side by side with the other policies on the same stack."""
    with input_errors():
        if gltf is not None:
            export_gltf(folder, read_folder(folder), trial, gltf)
            tell(f"the animation is {relative(gltf)}")
            return
        page = replay_trial(folder, read_folder(folder), trial)
    tell(f"the replay is {relative(page)}")
    if show and not webbrowser.open(page.resolve().as_uri()):
        tell("no browser could be opened: open that file in one")
