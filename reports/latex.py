"""The comparison as a LaTeX table for papers: booktabs, siunitx, and a caption with n, seeds, versions, date."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

import jinja2

from reports.cells import Cell
from reports.intervals import deviation
from reports.matrix import COLUMNS, MatrixRow
from reports.tables import NOTHING

_TEMPLATES = Path(__file__).parent / "templates"
_SPECIAL = {
    "\\": r"\textbackslash{}",
    **{letter: f"\\{letter}" for letter in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "≥": r"$\geq$",
    ">": "$>$",
    "<": "$<$",
    "±": r"$\pm$",
}
_DECIMALS = 3


def to_latex(rows: Sequence[MatrixRow], caption: str, label: str) -> str:
    """The table, to be read in by a paper.

    Args:
        rows: of the comparison.
        caption: what it is of; further words explain the columns.
        label: it is referred to as ``tab:LABEL``.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=False,  # LaTeX is no HTML: it has an escape of its own
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
    )
    environment.filters["tex"] = escape
    return environment.get_template("tables.tex.j2").render(
        caption=caption, label=re.sub(r"[^A-Za-z0-9-]", "-", label), rows=[_cells(row) for row in rows]
    )


def escape(text: str) -> str:
    """Text as LaTeX prints it."""
    return "".join(_SPECIAL.get(letter, letter) for letter in text)


def with_uncertainty(value: float, uncertainty: float | None) -> str:
    """A number with its uncertainty in units of its last digit, as siunitx reads it: ``1.234(12)``."""
    text = f"{value:.{_DECIMALS}f}"
    return text if uncertainty is None else f"{text}({math.ceil(uncertainty * 10**_DECIMALS)})"


def _cells(row: MatrixRow) -> list[str]:
    key = row.cell.key
    told = {column.title: figure.text for column, figure in zip(COLUMNS, row.figures, strict=True)}
    times = [_time(row.cell, field) for field in ("frame_ms_p50", "frame_ms_p99")]
    return [
        *map(escape, key),
        told["seeds"],
        *(escape(_dash(told[name])) for name in ("levels", "right")),
        *times,
        escape(_dash(told["ratio"])),
    ]


def _time(cell: Cell, field: str) -> str:
    estimate = cell.estimate(field)
    return "{--}" if estimate is None else with_uncertainty(estimate.value, deviation(cell.values(field)))


def _dash(text: str) -> str:
    return "--" if text == NOTHING else text
