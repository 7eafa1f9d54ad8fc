"""Records as flat rows, one value per column, for CSV, Parquet and data frames."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from reports.records.trial import FORMAT, TrialRecord

EXPECTATION_PREFIX = "expectation_"
"""Prefix of the columns of the expectation."""
EXPECTATION_FIELDS = ("outcome", "level", "not_before_s", "within_s", "theory")
"""Fields of the expectation, in the order of their columns."""
_WHOLE = ("format",)
_SINCE_FORMAT_3 = (
    "watch_s",
    "creep_error_m_s",
    "creep_limit_m_s",
    "creep_thickness_m",
    "sliding_m_s",
    "sinking_m_s",
    "mean_motion_m_s",
)
_MISSING = (None, "")


def flat_columns(of_format: int = FORMAT) -> list[str]:
    """Return the columns of a flat row: the fields of a record, with a column for each field of ``expectation``.

    Args:
        of_format: format of the records; formats 1 and 2 lack the columns that format 3 introduced.
    """
    columns: list[str] = []
    for name in TrialRecord.model_fields:
        if name in _SINCE_FORMAT_3 and of_format < 3:
            continue
        columns += [EXPECTATION_PREFIX + field for field in EXPECTATION_FIELDS] if name == "expectation" else [name]
    return columns


def to_flat(record: TrialRecord) -> dict[str, Any]:
    """Return a record as a flat row, with the parameters as a JSON text."""
    row = record.model_dump(mode="json")
    row["parameters"] = json.dumps(row["parameters"])
    expectation = row.pop("expectation")
    row |= {EXPECTATION_PREFIX + field: expectation[field] for field in EXPECTATION_FIELDS}
    return {column: row[column] for column in flat_columns()}


def from_flat(row: Mapping[str, Any]) -> TrialRecord:
    """Return the record of a flat row, or of a row of a CSV file of earlier versions.

    Missing values may be null, empty or NaN.

    Raises:
        ValueError: if the row is not a record.
    """
    fields = {name: value for name, value in row.items() if value not in _MISSING and value == value}
    if "expectation" in fields:  # CSV files of earlier versions have the expectation as JSON
        fields["expectation"] = json.loads(fields["expectation"])
    else:
        columns = {field: EXPECTATION_PREFIX + field for field in EXPECTATION_FIELDS}
        fields["expectation"] = {field: fields.pop(name) for field, name in columns.items() if name in fields}
    if isinstance(fields.get("parameters"), str):
        fields["parameters"] = json.loads(fields["parameters"])
    for name in _WHOLE:
        fields[name] = int(fields.get(name, 0))
    try:
        return TrialRecord.model_validate(fields)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise ValueError(f"field '{'.'.join(map(str, first['loc']))}': {first['msg']}; correct this field") from error
