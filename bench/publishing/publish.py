"""``uv run python -m bench.publishing NAME [DIR]``: publish a study in ``docs/results/NAME``.

Without DIR the command first runs the study, into ``results/published-NAME``, where an interrupted run continues. The
command then copies tables, figures and trials. It also fills the generated blocks of the documents, so that the blocks
agree with the tables.

``uv run python -m bench.publishing --mark`` runs no study. It marks the pages that an earlier core made, and fills the
generated blocks. ``--round DATE`` freezes the published results, and ``--archive DATE`` packs a frozen round.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Annotated, Any

import typer

from bench.execution.results import missing_trials
from bench.machine.environment import describe
from bench.machine.source_digest import PUBLISHED, ROOT, ROUNDS
from bench.publishing import doc_blocks
from bench.publishing.archive import write_archive
from bench.publishing.catalogue import PUBLICATIONS, Gallery, Publication
from bench.publishing.page_marks import mark, mark_all
from bench.publishing.rounds import committed_results, freeze, require_clean
from bench.studies.schema import load_study
from reports.records.atomic import atomic_file, write_atomic
from reports.records.folder import ENVIRONMENT, PARQUET, STUDY, TRIALS, ResultsFolder
from reports.records.results import write_trials_parquet
from reports.records.trial import TrialRecord, read_records
from reports.replays.gallery_figure import gallery_figure
from reports.replays.stacks import first_stacks, read_stack
from reports.replays.stills import write_stills
from reports.report import OF_TIMES, tables_of
from reports.statistics.groups import groups_of
from reports.tables.table import to_markdown
from scenarios.lookup import UnknownNameError, look_up

PICTURE = "stills.png"
"""File name of the published picture of stills."""
WITHOUT_TIMES = (
    "This page shows no times, because trials of this study may be run several at a time, which disturbs times."
)
FIGURE = "figure.svg"
"""File name of the published figure."""
_FIGURES = {"cost.svg": True, "figures/pairs.svg": False, "figures/speed.svg": True}
"""Candidates for the figure of a publication without a picture, in order of preference; the value is True for a figure
that shows times."""
_EARLIER = ("trials.csv", "comparison.csv", "tables.tex", "pairs.csv", "pairs.tex", "cost.svg", "figures")
"""Files of earlier versions to remove, because "bench report" makes them from the published folder."""
_STILL_PIXELS, _PICTURE_DPI = 480, 120
"""Edge of a still [pixels], and resolution of the picture [dots per inch]."""


class PublishError(ValueError):
    """Results unfit for publication; the message names the reason and the fix."""


def publish(name: str, folder: Path, to: Path = PUBLISHED) -> Path:
    """Copy the published part of a results folder and its report into ``to / name``; return ``to / name``.

    Raises:
        UnknownNameError: if no publication has this name.
        PublishError: if the folder contains another study, lacks trials, or comes from uncommitted sources.
        StudyError: if the study in the folder is unreadable or invalid.
        EngineNotInstalledError: if the package of an engine of the study is missing.
        RecordError: if the records are unreadable.
        StillsError: if the renderer cannot draw the picture of the publication.
        OSError: if the environment file, or a recording for the picture, is missing.
    """
    publication, records = look_up("publication", name, PUBLICATIONS), read_records(folder / TRIALS)
    _check(publication, folder, records)
    target = to / name
    target.mkdir(parents=True, exist_ok=True)
    _remove_earlier(target)
    write_trials_parquet(target / PARQUET, records)
    report = folder / "report"
    for part in (report / "tables.md", folder / STUDY, folder / ENVIRONMENT):
        if part.exists():
            shutil.copyfile(part, target / part.name)
    if not publication.is_timed:
        _write_without_times(folder, target / "tables.md")
        environment = {**ResultsFolder(folder).environment, "timed": False}
        write_atomic(target / ENVIRONMENT, (json.dumps(environment, indent=2) + "\n").encode())
    if (target / "tables.md").exists():
        mark(target / "tables.md")
    if publication.gallery is not None:
        _draw(publication.gallery, folder, records, target / PICTURE)
    else:
        _copy_figure(report, target / FIGURE, is_timed=publication.is_timed)
    return target


def _write_without_times(folder: Path, page: Path) -> None:
    """Write the tables without times; leave out the verdict, because the verdict ranks set-ups by their times."""
    tables = chain.from_iterable(tables_of(ResultsFolder(folder)).values())
    content = to_markdown([table for table in tables if table.id not in OF_TIMES])
    page.write_text(f"{content}\n{WITHOUT_TIMES}\n", encoding="utf-8")


def _check(publication: Publication, folder: Path, records: Sequence[TrialRecord]) -> None:
    if not load_study(str(folder / STUDY)).has_same_plan(publication.resolved()):
        raise PublishError(
            f"{folder} must contain the study '{publication.study}' with the publication's selection, but contains "
            f"another study: run {publication.command}"
        )
    missing = missing_trials(folder, records)
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise PublishError(
            f"{folder} must contain all trials of the study, but lacks {missing[0]}{more}: run "
            f"{publication.command} --out {folder}"
        )
    _check_sources(json.loads((folder / ENVIRONMENT).read_text(encoding="utf-8")), str(folder))


def _check_sources(environment: Mapping[str, Any], where: str) -> None:
    if environment.get("modified") is not False or not environment.get("commit"):
        raise PublishError(
            f"{where}: a run to publish must use committed sources, got modified = {environment.get('modified')!r} and "
            f"commit = {environment.get('commit')!r}; commit the changes in a git checkout, and run the study again"
        )


def _remove_earlier(target: Path) -> None:
    """Remove the files that an earlier publication left: files of earlier versions, the figure and the picture."""
    for name in (*_EARLIER, FIGURE, PICTURE):
        if (target / name).is_dir():
            shutil.rmtree(target / name)
        else:
            (target / name).unlink(missing_ok=True)


def _copy_figure(report: Path, target: Path, *, is_timed: bool) -> None:
    """Copy the first existing figure of ``_FIGURES`` to ``target``; skip figures of times unless ``is_timed``."""
    names = (name for name, shows_times in _FIGURES.items() if is_timed or not shows_times)
    figure = next((report / name for name in names if (report / name).exists()), None)
    if figure is not None:
        shutil.copyfile(figure, target)


def _draw(gallery: Gallery, folder: Path, records: Sequence[TrialRecord], picture: Path) -> None:
    """Draw the stills of ``gallery`` into one picture."""
    wanted = (gallery.engine, gallery.profile)
    stacks = [
        read_stack(folder, those)
        for those in first_stacks(folder, records)
        if (those[0].engine, those[0].profile) == wanted and those[0].scene in gallery.scenes
    ]
    stills = folder / "report" / "gallery"
    write_stills(stills, stacks, _STILL_PIXELS)
    figure = gallery_figure(stills, groups_of(records), *wanted, gallery.scenes)
    with atomic_file(picture) as draft:
        figure.savefig(draft, format="png", dpi=_PICTURE_DPI)


def main(
    name: Annotated[str | None, typer.Argument(help=f"One of {', '.join(PUBLICATIONS)}.")] = None,
    folder: Annotated[Path | None, typer.Argument(metavar="[DIR]", help="A results folder of this study.")] = None,
    is_mark: Annotated[bool, typer.Option("--mark", help="Only mark the pages that an earlier core made.")] = False,
    frozen: Annotated[
        str | None, typer.Option("--round", metavar="DATE", help="Freeze the published results as a round.")
    ] = None,
    archived: Annotated[
        str | None, typer.Option("--archive", metavar="DATE", help="Write a frozen round into a zip file to deposit.")
    ] = None,
) -> None:
    """Publish a study in docs/results, mark the published pages, or freeze or pack a round."""
    if sum((name is not None, is_mark, frozen is not None, archived is not None)) != 1:
        got = ["NAME"] * (name is not None) + ["--mark"] * is_mark
        got += ["--round"] * (frozen is not None) + ["--archive"] * (archived is not None)
        raise typer.BadParameter(
            "expected exactly one of NAME (a publication), --mark, --round or --archive, got "
            f"{', '.join(got) or 'none'}: give one of the four"
        )
    try:
        if name is not None:
            done = f"published in {_publish(name, folder).relative_to(ROOT)}"
        elif frozen is not None:
            done = f"frozen in {freeze(frozen, committed_results()).relative_to(ROOT)}: commit it"
        elif archived is not None:
            require_clean()
            typer.echo(f"the archive: {write_archive(ROUNDS / archived, ROOT / 'results').relative_to(ROOT)}")
            return
        else:
            done = f"pages of an earlier core: {mark_all(PUBLISHED)}"
    except (UnknownNameError, ValueError, OSError, RuntimeError) as error:
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(2) from error
    doc_blocks.main()
    typer.echo(f"{done}; filled the generated blocks of the documents")


def _publish(name: str, folder: Path | None) -> Path:
    """Publish a study from ``folder`` with a new report, or from a new run if ``folder`` is None.

    Returns:
        The published folder.
    """
    publication = look_up("publication", name, PUBLICATIONS)
    if folder is None:
        folder = ROOT / "results" / f"published-{name}"
        _check_sources(describe(()), "this checkout")  # before a run that may take hours
        _bench("run", *publication.arguments, "--out", str(folder))
    else:
        _bench("report", str(folder))
    return publish(name, folder)


def _bench(*arguments: str) -> None:
    """Run a ``bench`` command in its own process, and discard the standard output.

    Raises:
        typer.Exit: with the status of the command, if the command fails.
    """
    done = subprocess.run([sys.executable, "-m", "bench", *arguments], cwd=ROOT, stdout=subprocess.DEVNULL, check=False)
    if done.returncode:
        raise typer.Exit(done.returncode)
