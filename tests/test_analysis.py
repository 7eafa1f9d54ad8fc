"""The notebook runs, and counts what docs/findings.md says."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest

from tests.test_recount import rows_of

NOTEBOOK = Path(__file__).parent.parent / "docs" / "analysis.ipynb"
MOST_BYTES = 100_000


def cells() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    return found


def test_it_is_small_and_keeps_no_outputs() -> None:
    assert NOTEBOOK.stat().st_size < MOST_BYTES
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells())


def test_it_runs_and_its_table_is_that_of_the_findings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(NOTEBOOK.parent)
    monkeypatch.setattr("sys.path", [*sys.path])
    names: dict[str, Any] = {}
    with mpl.rc_context({"backend": "agg"}):
        for cell in cells():
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), NOTEBOOK.name, "exec"), names)
    table, axes = names["table"], names["axes"]
    for row in rows_of("many_seeds"):
        engine = row.pop("engine")
        assert {column: table.loc[engine, tuple(column.split(": "))] for column in row} == row
    curves = [line.get_ydata() for line in axes.lines]
    assert len(curves) == 4
    assert all((curve[1:] <= curve[:-1]).all() for curve in curves)
    names["plt"].close(names["figure"])
