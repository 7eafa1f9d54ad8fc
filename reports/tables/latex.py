"""Tables for papers in LaTeX, with the packages booktabs and siunitx."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

import jinja2

from reports.statistics.groups import Group, grouped
from reports.statistics.intervals import deviation
from reports.statistics.pairs import ALL, PairRow
from reports.statistics.success_rates import MISSES
from reports.tables.comparison import COLUMNS, ComparisonRow
from reports.tables.table import NOTHING, Table
from reports.tables.wording import percent

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
    "µ": r"$\mu$",
    "†": r"$\dagger$",
    "✓": r"$\checkmark$",
    "✗": r"$\times$",
    "“": "``",
    "”": "''",
}
"""Replacements for characters with a meaning in LaTeX, and for symbols."""
_DECIMALS = 3
"""Number of decimals of a time [ms]."""


def to_latex(rows: Sequence[ComparisonRow], caption: str, label: str) -> str:
    """Return the comparison as a table for a paper.

    Args:
        rows: rows of the comparison.
        caption: caption of the table; the function adds an explanation of the columns.
        label: name in the label ``tab:NAME`` of the table.
    """
    return _template("tables.tex.j2").render(caption=caption, label=_label(label), scenes=_by_scene(rows))


def pairs_to_latex(rows: Sequence[PairRow], caption: str, label: str) -> str:
    """Return two tables of pairs: of all pairs (``tab:LABEL-pairs``), and by family (``tab:LABEL-families``)."""
    whole = [
        (f"{row.set_up.engine}, {row.set_up.profile}", row.set_up.policy, row) for row in rows if row.family == ALL
    ]
    families = [(", ".join(row.set_up), row.family, row) for row in rows if row.family != ALL]
    tables = [
        {
            "label": "pairs",
            "title": "Pairs with both outcomes correct.",
            "name": "Engine, profile, policy",
            "groups": _groups(whole),
        },
        {
            "label": "families",
            "title": "Pairs with both outcomes correct, by family of scenes.",
            "name": "Engine, profile, policy, family",
            "groups": _groups(families),
        },
    ]
    return _template("pairs.tex.j2").render(caption=caption, label=_label(label), tables=tables)


def table_to_latex(table: Table) -> str:
    """Return a table as a ``longtable`` with the label ``tab:ID``, for the packages booktabs, longtable and amssymb."""
    frame = table.frame.map(escape).set_axis(map(escape, table.header), axis="columns")
    text: str = frame.to_latex(
        index=False, longtable=True, escape=False, caption=escape(table.title), label=f"tab:{_label(table.id)}"
    )
    return text


def _by_scene(rows: Sequence[ComparisonRow]) -> list[list[list[str]]]:
    return [[_entries(row) for row in of_scene] for of_scene in grouped(rows, "group.key.scene").values()]


def _template(name: str) -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=False,  # the filter "tex" escapes text for LaTeX
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
    return environment.get_template(name)


def _label(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9-]", "-", name)


def _groups(rows: Sequence[tuple[str, str, PairRow]]) -> dict[str, list[list[str]]]:
    """Return the lines of a table by heading; a line has a name and entries."""
    groups: dict[str, list[list[str]]] = {}
    for heading, name, row in rows:
        groups.setdefault(heading, []).append([escape(name), *_pair_entries(row)])
    return groups


def _pair_entries(row: PairRow) -> list[str]:
    if row.success_rates is None:
        return ["0", *["--"] * (1 + len(MISSES)), str(row.undecided)]
    rates = [percent(getattr(row.success_rates, name)).replace(" %", "") for name in ("right", *MISSES)]
    return [str(row.success_rates.n), *rates, str(row.undecided)]


def escape(text: str) -> str:
    """Return a text in which LaTeX commands replace the characters of ``_SPECIAL``."""
    return "".join(_SPECIAL.get(letter, letter) for letter in text)


def with_uncertainty(value: float, uncertainty: float | None) -> str:
    """Format a number with three decimals in the notation of siunitx, ``1.234(12)``.

    The uncertainty is in units of the last digit, rounded up; the text omits an uncertainty of None.
    """
    text = f"{value:.{_DECIMALS}f}"
    return text if uncertainty is None else f"{text}({math.ceil(uncertainty * 10**_DECIMALS)})"


def _entries(row: ComparisonRow) -> list[str]:
    key = row.group.key
    entries = {column.title: entry.text for column, entry in zip(COLUMNS, row.entries, strict=True)}
    times = [_time(row.group, field) for field in ("frame_ms_p50", "frame_ms_p99")]
    return [
        *map(escape, key),
        entries["seeds"],
        *(escape(_dash(entries[name])) for name in ("levels", "right")),
        *times,
        escape(_dash(entries["ratio"])),
    ]


def _time(group: Group, field: str) -> str:
    estimate = group.estimate(field)
    return "{--}" if estimate is None else with_uncertainty(estimate.value, deviation(group.values(field)))


def _dash(text: str) -> str:
    return "--" if text == NOTHING else text
