"""Publish a history: its data, page, figure and tables in a folder of its own, and the index of all histories."""

from __future__ import annotations

import shutil
from pathlib import Path

from bench.publishing.page_marks import NOT_USED, signed
from reports.figures.history import write_history_figure
from reports.page.history_page import history_tables, write_history_page
from reports.records.atomic import write_atomic
from reports.records.history import HISTORY, History, read_history, write_history
from reports.tables.table import Table, to_markdown

INDEX = "summary.md"
"""File name of the list of all published histories, in the folder ``all``."""
_EXPLANATIONS = "explanations.toml"
_HEAD = (
    "Histories of the engines' releases, each with the same commit of the suite, made by "
    "`uv run -m bench history --engine ENGINE --versions all` on the engine alone, profile `game`."
)


def publish_history(history: History, folder: Path, to: Path, explain: Path | None) -> Path:
    """Write a history below ``to``, in a folder named after its subject, and renew the index; return the folder.

    Raises:
        OSError: if ``folder``, the folder of the history, has no ``study.toml``, for example after ``--records``.
        HistoryError: if a published history is not readable.
    """
    target = to / history.subject
    target.mkdir(parents=True, exist_ok=True)
    write_history(target / HISTORY, history)
    write_history_page(target / "index.html", history)
    write_history_figure(target / "figure.svg", history)
    shutil.copyfile(folder / "study.toml", target / "study.toml")
    if explain is not None and explain.resolve() != (target / _EXPLANATIONS).resolve():
        shutil.copyfile(explain, target / _EXPLANATIONS)
    title = f"# {history.subject}: {len(history.points)} releases\n\n![figure](figure.svg)\n\n"
    text = title + to_markdown(history_tables(history))
    write_atomic(target / "tables.md", signed(text, NOT_USED).encode())
    _write_index(to)
    return target


def _write_index(folder: Path) -> None:
    histories = [read_history(path) for path in sorted(folder.glob(f"*/{HISTORY}"))]
    text = f"# Histories of releases\n\n{_HEAD}\n\n" + to_markdown([_overview(histories)])
    (folder / "all").mkdir(exist_ok=True)
    write_atomic(folder / "all" / INDEX, signed(text, NOT_USED).encode())


def _overview(histories: list[History]) -> Table:
    rows = []
    for one in histories:
        measured = [point.version for point in one.points if not point.message]
        explained = sum(step.explanation is not None for step in one.steps)
        rows.append(
            (
                one.subject,
                f"{measured[0]} to {measured[-1]}" if measured else "-",
                str(len(measured)),
                str(len(one.points) - len(measured)),
                str(len(one.steps)),
                str(explained),
                f"[tables](../{one.subject}/tables.md), [page](../{one.subject}/index.html)",
            )
        )
    header = ("engine", "releases", "measured", "without figures", "steps", "explained", "pages")
    return Table("Published histories", header, tuple(rows))
