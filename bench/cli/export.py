"""``bench export``: write a scene as a file of another simulator."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.completion import SCENARIO
from bench.cli.console import input_errors, note
from bench.studies.schema import StudyError
from bench.studies.selection import is_file
from reports.records.atomic import write_atomic
from scenarios.formats.write import FORMATS, scene_text
from scenarios.registry import build


def export(
    scene: Annotated[str, typer.Argument(help="A scenario, or a FILE with your own bricks.", autocompletion=SCENARIO)],
    mjcf: Annotated[bool, typer.Option("--mjcf", help="Write MJCF (MuJoCo), FILE.xml.")] = False,
    urdf: Annotated[bool, typer.Option("--urdf", help="Write URDF, FILE.urdf.")] = False,
    usd: Annotated[bool, typer.Option("--usd", help="Write OpenUSD, FILE.usda.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="The file to write; by default SCENE with the format's suffix.")
    ] = None,
) -> None:
    """Write a scene as MJCF, URDF or USD: bricks and fixed bodies; in MJCF and USD also gravity and friction."""
    wanted = [name for name, chosen in (("mjcf", mjcf), ("urdf", urdf), ("usd", usd)) if chosen]
    if len(wanted) != 1:
        got = ", ".join(f"--{name}" for name in wanted) or "none"
        raise typer.BadParameter(f"expected exactly one format, got {got}: choose one of --mjcf, --urdf or --usd")
    with input_errors():
        try:
            built = build("own_scene", file=scene) if is_file(scene) else build(scene)
            text = scene_text(built, wanted[0])
        except ValueError as error:
            raise StudyError(str(error)) from error
        path = out or Path(f"{built.variant}{FORMATS[wanted[0]]}")
        write_atomic(path, text.encode())
    note(f"{path}: {len(built.bricks)} bricks, {len(built.world.fixed)} fixed bodies")
