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
        ValueError: if the row is not a record; the message names the trial.
    """
    fields = {name: value for name, value in row.items() if value not in _MISSING and value == value}
    if "expectation" in fields:  # CSV files of earlier versions have the expectation as JSON
        fields["expectation"] = _from_json(fields, "expectation")
    else:
        columns = {field: EXPECTATION_PREFIX + field for field in EXPECTATION_FIELDS}
        fields["expectation"] = {field: fields.pop(name) for field, name in columns.items() if name in fields}
    if isinstance(fields.get("parameters"), str):
        fields["parameters"] = _from_json(fields, "parameters")
    for name in _WHOLE:
        try:
            fields[name] = int(fields.get(name, 0))
        except (ValueError, TypeError) as error:
            raise _invalid(fields, name, "must be a whole number", fields[name]) from error
    try:
        return TrialRecord.model_validate(fields)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        got = None if first["type"] == "missing" else first["input"]
        raise _invalid(fields, ".".join(map(str, first["loc"])), first["msg"], got) from error


def _from_json(fields: Mapping[str, Any], name: str) -> Any:
    try:
        return json.loads(fields[name])
    except (ValueError, TypeError) as error:
        raise _invalid(fields, name, "must be a JSON text", fields[name]) from error


def _invalid(fields: Mapping[str, Any], name: str, words: str, got: object) -> ValueError:
    """Return the error for a field with an invalid value."""
    return ValueError(
        f"trial {fields.get('trial', 'without an id')}: field '{name}': {words}, got {got!r:.80}: correct this field, "
        "restore the file, or publish the study again"
    )
