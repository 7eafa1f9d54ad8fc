"""The page of a history, one file without scripts: the figure, the steps with quoted changelogs, and the versions."""

from __future__ import annotations

import io
from pathlib import Path

import jinja2
import matplotlib as mpl

from reports.figures.history import display, history_figure
from reports.figures.style import STYLE, for_page
from reports.records.atomic import write_atomic
from reports.records.history import History, Step
from reports.tables.table import NOTHING, Table

_TEMPLATES = Path(__file__).with_name("templates")
UNEXPLAINED = "unexplained"
"""Text in place of a quote for a step that no line of a changelog explains."""


def write_history_page(path: Path, history: History) -> None:
    """Write the page of a history as one HTML file, atomically."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    page = environment.get_template("history.html.j2").render(
        history=history,
        svg=_svg(history),
        style=(_TEMPLATES / "page.css").read_text(encoding="utf-8"),
        tables=history_tables(history),
        links={point.version: point.link for point in history.points if point.link.startswith("https://")},
    )
    write_atomic(path, page.encode())


def history_tables(history: History) -> list[Table]:
    """Return the table of steps and the table of versions."""
    return [steps_table(history), _versions(history)]


def failures_table(history: History) -> Table:
    """Return the table of versions without figures, each with its reason."""
    rows = tuple((point.version, point.message) for point in history.points if point.message)
    measured = len(history.points) - len(rows)
    return Table(
        "Versions without figures", ("version", "reason"), rows, (f"{measured} versions have figures.",), folds=True
    )


def steps_table(history: History) -> Table:
    """Return the table of steps with the quoted lines that explain the steps."""
    series = {one.name: one for one in history.series}
    rows = tuple(
        (
            step.version,
            step.series,
            display(series[step.series], step.before),
            display(series[step.series], step.after),
            _quote(step),
        )
        for step in history.steps
    )
    notes = (
        "A step is the first version of a new level; before and after are medians between neighbouring steps.",
        "A quote is a line of the engine's changelog; its version is named where it is another one.",
    )
    return Table("Steps", ("version", "figure", "before", "after", "changelog"), rows, notes, folds=True)


def _quote(step: Step) -> str:
    if step.explanation is None:
        return UNEXPLAINED
    of = step.explanation.of
    return f'"{step.explanation.quote}"' + (f" ({of})" if of else "")


def _versions(history: History) -> Table:
    header = ("version", *(one.name for one in history.series), "notes")
    rows = tuple(
        (
            point.version,
            *(display(one, one.values[index]) for one in history.series),
            "; ".join([*([point.message] if point.message else []), *point.notes]) or NOTHING,
        )
        for index, point in enumerate(history.points)
    )
    suite = f" Suite: commit {history.commit}." if history.commit else ""
    notes = (f"Study {history.study}; {history.processor or 'unknown processor'}.{suite}",)
    return Table("Versions", header, rows, notes, folds=True)


def _svg(history: History) -> str:
    buffer = io.StringIO()
    with mpl.rc_context(STYLE):
        history_figure(history).savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
    return for_page(buffer.getvalue(), f"Figures of {history.subject} over its versions", ())
