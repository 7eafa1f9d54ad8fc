"""``bench baseline``: write a results folder into one small file, for later comparisons."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import input_errors, note, relative
from bench.compare.baseline import read_baseline, replaced_baseline, write_baseline
from bench.compare.findings import plain
from bench.compare.renewal import renewed
from bench.compare.tracking import tracked
from reports.records.atomic import write_atomic


def baseline(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="The baseline to write, or to replace.")],
    track: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write figures for benchmark-tracking actions.")
    ] = None,
) -> None:
    """Write a results folder into one small file that later comparisons use as their base.

    If FILE exists, the new baseline keeps the pose hashes of other processors from FILE, unless poses may have changed.
    """
    with input_errors():
        side = read_baseline(folder)
        former = replaced_baseline(out)
        renewal = None if former is None else renewed(side, former)
        write_baseline(side if renewal is None else renewal.baseline, out)
        if track is not None:
            write_atomic(track, (json.dumps(tracked(side), indent=1) + "\n").encode())
    note(f"{len(side.trials)} trials are kept in {relative(out)}")
    if renewal is not None:
        for processor, count in renewal.kept.items():
            note(f"{count} pose hashes of {plain(processor)} are kept beside those of this run")
        for processor, count in renewal.dropped.items():
            note(
                f"{count} pose hashes of {plain(processor)} are dropped, because poses or code changed: write the "
                "baseline there again"
            )
