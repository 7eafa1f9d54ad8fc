"""``bench baseline``: write a results folder into one small file, for later comparisons."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import input_errors, note, relative
from bench.compare.baseline import read_baseline, write_baseline
from bench.compare.tracking import tracked
from reports.records.atomic import write_atomic


def baseline(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="The baseline to write, or to replace.")],
    track: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write figures for benchmark-tracking actions.")
    ] = None,
) -> None:
    """Write a results folder into one small file that later comparisons use as their base."""
    with input_errors():
        side = read_baseline(folder)
        write_baseline(side, out)
        if track is not None:
            write_atomic(track, (json.dumps(tracked(side), indent=1) + "\n").encode())
    note(f"{len(side.trials)} trials are kept in {relative(out)}")
