"""What the README and docs/results say is what the suite wrote."""

from __future__ import annotations

import json
import re
from pathlib import Path

from reports.records import TrialRecord

ROOT = Path(__file__).parent.parent
PAPER = ROOT / "docs" / "results" / "paper"


def quick_start() -> list[str]:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"## Quick start\n.*?```bash\n(.*?)```", readme, re.DOTALL)
    assert block is not None
    return block[1].splitlines()


def test_quick_start_is_the_main_job_and_the_tests():
    assert quick_start() == ["pip install uv && uv run -m bench run", "uv run pytest"]


def test_the_readmes_table_is_the_published_one():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    published = (PAPER / "tables.md").read_text(encoding="utf-8")
    rows = [line for line in readme.splitlines() if line.startswith(("| scene ", "| four_", "| card_", "| leaning_"))]
    assert len(rows) > 10
    assert all(f"{row}\n" in published for row in rows)


def test_published_results_come_from_a_clean_commit():
    environment = json.loads((PAPER / "environment.json").read_text(encoding="utf-8"))
    assert environment["modified"] is False
    assert re.fullmatch("[0-9a-f]{40}", environment["commit"])


def test_published_columns_are_those_of_the_records():
    header = (PAPER / "trials.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert set(header) <= set(TrialRecord.model_fields)
