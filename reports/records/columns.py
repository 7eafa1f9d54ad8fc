"""The data dictionary: name, unit, type and meaning of each column of the data frames of ``reports.load``.

``uv run python -m reports.records.columns`` writes ``docs/columns.md`` from the docstrings of the fields and from
``POSE_COLUMNS``.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from reports.records.flat import EXPECTATION_PREFIX, flat_columns
from reports.records.frames import SCHEMA, FrameRow
from reports.records.results import POSE_COLUMNS, column_types
from reports.records.trial import TrialRecord
from scenarios.model import Expectation

PAGE = Path(__file__).parents[2] / "docs" / "columns.md"
"""Path of the generated page."""
_UNITS = {"_mib": "MiB", "_m_s": "m/s", "_ms": "ms", "_m": "m", "_s": "s", "_deg": "deg"}
"""Units by the suffix of a column's name. The suffix ``_m_s`` comes before ``_s``, because the first match counts."""
_TYPES = {"str": "text", "int64": "whole number", "Int64": "whole number", "float64": "number"}
"""Plain names of the types of ``.trials``, by the name of the type in pandas."""
_HEAD = """# Columns of the results

`reports.load(DIR)` returns `.trials`, `.frames(trial)` and `.poses(trial)` as pandas data frames, of a results folder
or of a folder in `docs/results`; `trials.csv` and `trials.parquet` have the columns of `.trials`. Most units
are SI; times of frames are in ms, angles in deg, and memory is in MiB. A value that does not exist is missing (nan, NA
or empty), never zero. `uv run python -m reports.records.columns` writes this page.
"""
_CHOICES_OF_OUTCOME = {"outcome": "The outcome that theory demands: stand, fall, or study where theory is silent."}


class Column(NamedTuple):
    """A column of a data frame."""

    name: str
    unit: str
    type: str
    meaning: str


def trial_columns() -> list[Column]:
    """Return the columns of ``.trials``."""
    meanings = field_meanings(TrialRecord)
    expected = {**_CHOICES_OF_OUTCOME, **field_meanings(Expectation)}
    meanings |= {EXPECTATION_PREFIX + name: meaning for name, meaning in expected.items()}
    types = {**column_types(), "parameters": "mapping"}
    return [
        Column(name, unit_of(name), _TYPES.get(types[name], types[name]), meanings[name]) for name in flat_columns()
    ]


def frame_columns() -> list[Column]:
    """Return the columns of ``.frames(trial)``."""
    meanings, types = (
        field_meanings(FrameRow),
        {"int32": "whole number", "int64": "whole number", "double": "number", "string": "text"},
    )
    return [
        Column(
            field.name,
            unit_of(field.name),
            types[str(field.type)],
            meanings[field.name],
        )
        for field in SCHEMA
    ]


def pose_columns() -> list[Column]:
    """Return the columns of ``.poses(trial)``."""
    return [Column(name, unit_of(name), kind, meaning) for name, (kind, meaning) in POSE_COLUMNS.items()]


def unit_of(name: str) -> str:
    """Return the unit that a column's name contains; empty if the name contains no unit."""
    if "_ms_" in name:
        return "ms"
    return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "")


def field_meanings(model: type) -> dict[str, str]:
    """Return the docstring of each documented field of a class, in one line and with single backticks."""
    body = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    assert isinstance(body, ast.ClassDef)
    meanings = {}
    for field, after in zip(body.body, body.body[1:], strict=False):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(after, ast.Expr):
            text = ast.literal_eval(after.value)
            meanings[field.target.id] = " ".join(text.split()).replace("``", "`")
    return meanings


def page() -> str:
    """Return the text of ``docs/columns.md``."""
    tables: Mapping[str, list[Column]] = {
        "`.trials`: one row per trial": trial_columns(),
        "`.frames(trial)`: one row per frame": frame_columns(),
        "`.poses(trial)`: one row per change of a body's pose or state": pose_columns(),
    }
    parts = [_HEAD]
    for title, columns in tables.items():
        rows = [f"| `{one.name}` | {one.unit or '-'} | {one.type} | {one.meaning} |" for one in columns]
        parts.append("\n".join([f"## {title}\n", "| Column | Unit | Type | Meaning |", "|---|---|---|---|", *rows, ""]))
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
