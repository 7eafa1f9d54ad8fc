"""Tables of formatted text, for the terminal, Markdown and CSV."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.cells import cell_len
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

if TYPE_CHECKING:
    import pandas as pd

NOTHING = "-"
"""Text of an entry without a value."""
_REST = " ... (the rest: report/tables.md)"
"""End of a shortened note."""
_KEYS = frozenset({"thread", "scene", "family", "engine", "profile", "policy", "method", "machine"})
"""Names of the columns that identify a row, which each part of a wide table repeats."""
_GAP = 2
"""Distance of columns on the terminal [characters]."""
_COLOURS = {"✓": "green", "✗": "red", "~": "yellow"}
"""Colours of entries on the terminal, by the mark in the entry."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table of formatted text."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    folds: bool = False
    """True if entries may take several lines, except in the first column."""
    id: str = ""
    """Name of the table's files, unique within a report; empty for a table without files."""

    @classmethod
    def of(cls, title: str, frame: pd.DataFrame, notes: Sequence[str] = (), *, id: str = "") -> Table:  # noqa: A002
        """Return a table with the text of a data frame, without the index of the data frame."""
        rows = tuple(tuple(row) for row in frame.to_numpy().tolist())
        return cls(title, tuple(frame.columns), rows, tuple(notes), id=id)

    @property
    def frame(self) -> pd.DataFrame:
        """Text of the table as a data frame, without the notes."""
        import pandas as pd  # its import takes 0.5 s, and most commands do not need it

        return pd.DataFrame(list(self.rows), columns=list(self.header), dtype=str)


def first_rows(table: Table, most: int) -> Table:
    """Return a table of the first ``most`` rows, with a note that names the file of the remaining rows, if any."""
    more = len(table.rows) - most
    if more <= 0:
        return table
    note = f"{more} more row{'s' * (more > 1)}: report/tables/{table.id}.csv."
    return replace(table, rows=table.rows[:most], notes=(note, *table.notes))


def with_short_notes(table: Table, most: int) -> Table:
    """Return a table with notes of at most ``most`` characters; a shortened note names the file with the full note."""
    notes = (note if len(note) <= most else textwrap.shorten(note, most, placeholder=_REST) for note in table.notes)
    return replace(table, notes=tuple(notes))


def render(table: Table, console: Console) -> None:
    """Print a table, followed by its notes; split a table that is too wide into parts."""
    for part in _parts(table, console.width):
        _render_part(part, console)
    for note in table.notes:
        console.print(note, style="dim", markup=False, highlight=False)
    console.print()


def _parts(table: Table, width: int) -> list[Table]:
    """Return the table in parts that fit into ``width`` [characters] if possible.

    Each part has the columns of ``_KEYS``. A table whose entries may take several lines stays whole.
    """
    widths = [max(map(cell_len, column)) + _GAP for column in zip(table.header, *table.rows, strict=True)]
    if table.folds or sum(widths) - _GAP <= width:
        return [table]
    keys = [column for column, name in enumerate(table.header) if name in _KEYS]
    parts: list[list[int]] = [list(keys)]
    for column in (column for column in range(len(widths)) if column not in keys):
        is_full = sum(widths[other] for other in (*parts[-1], column)) - _GAP > width
        if is_full and len(parts[-1]) > len(keys):
            parts.append(list(keys))
        parts[-1].append(column)
    return [_part(table, columns, number) for number, columns in enumerate(parts)]


def _part(table: Table, columns: Sequence[int], number: int) -> Table:
    """Return some columns of a table as part ``number``, counted from zero."""
    title = f"{table.title}, continued" if number else table.title
    header, *rows = (tuple(line[column] for column in columns) for line in (table.header, *table.rows))
    return replace(table, title=title, header=header, rows=tuple(rows))


def _render_part(table: Table, console: Console) -> None:
    title = Text(table.title, style="table.title")  # Rich would read "[ms]" in a string as markup
    text = RichTable(title=title, title_justify="left", pad_edge=False, box=None, header_style="bold")
    figures = sum(map(_is_figures, zip(*table.rows, strict=True))) if table.rows and not table.folds else 0
    first_figure = len(table.header) - figures
    for column, name in enumerate(table.header):
        text.add_column(
            Text(name),
            justify="right" if column >= first_figure else "left",
            overflow="fold",
            no_wrap=column == 0 if table.folds else column >= first_figure,  # a broken number is misread
        )
    previous: tuple[str, ...] = ()
    for row in table.rows:
        text.add_row(*map(_coloured, _unless_said(row, previous)))
        previous = row
    console.print(text)


def to_markdown(tables: Iterable[Table]) -> str:
    """Return the tables with their notes in GitHub's Markdown."""
    parts = []
    for table in tables:
        lines = [f"## {table.title}", "", _line(table.header), _line(["---"] * len(table.header))]
        lines += [_line(row) for row in table.rows]
        lines += [line for note in table.notes for line in ("", note)]
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def write_table_csv(path: Path, table: Table) -> None:
    """Write a table as CSV, without its notes."""
    table.frame.to_csv(path, index=False, lineterminator="\n")


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _is_figures(column: Sequence[str]) -> bool:
    return all(cell == NOTHING or cell[:1].isdigit() for cell in column)


def _coloured(cell: str) -> Text:
    """Return an entry in the colour of its mark, or without a colour if the entry has no mark."""
    return Text(cell, next((colour for mark, colour in _COLOURS.items() if mark in cell), ""))


def _unless_said(row: tuple[str, ...], previous: tuple[str, ...]) -> list[str]:
    """Return the entries of a row, with blanks for leading entries that repeat the row above, except the last entry."""
    cells, same = [], True
    for index, cell in enumerate(row):
        same = same and index < len(row) - 1 and previous[index : index + 1] == (cell,)
        cells.append("" if same else cell)
    return cells
