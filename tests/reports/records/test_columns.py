"""The dictionary of columns is that of the code, and every column has a meaning and the unit that it names."""

import re

import pytest

from reports.records.columns import PAGE, frame_columns, page, pose_columns, trial_columns, unit_of

COLUMNS = [*trial_columns(), *frame_columns(), *pose_columns()]


def test_the_page_is_made_from_the_fields() -> None:
    command = "uv run python -m reports.records.columns"
    assert PAGE.read_text(encoding="utf-8") == page(), f"make it again: {command}"
    assert command in page()


@pytest.mark.parametrize("column", COLUMNS, ids=[column.name for column in COLUMNS])
def test_a_meaning_names_the_unit_that_the_column_has(column) -> None:
    assert column.meaning[0].isupper() or column.meaning[0].isdigit()
    assert column.meaning.endswith(".")
    assert len(column.meaning) > 10
    assert "|" not in column.meaning
    units = {unit for unit in re.findall(r"\[([^\]]+)\]", column.meaning) if unit in {"m", "s", "ms", "m/s", "deg"}}
    assert units <= {column.unit}


@pytest.mark.parametrize(
    ("name", "unit"), [("creep_m_s", "m/s"), ("frame_ms_p50", "ms"), ("sink_m", "m"), ("wall_s", "s"), ("seed", "")]
)
def test_a_name_ends_with_its_unit(name: str, unit: str) -> None:
    assert unit_of(name) == unit
