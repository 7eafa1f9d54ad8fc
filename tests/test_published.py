"""What the README and docs/results say is what the suite wrote."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from bench.machine.core_digest import core_of_commit, present_core
from bench.publishing.catalogue import PUBLICATIONS
from bench.publishing.doc_blocks import BLOCKS
from bench.publishing.page_marks import NOT_USED, UNKNOWN, core_of, is_of_core, marked, pages, warning
from reports.records.flat import flat_columns
from reports.tables.separation import STUDIES as SEPARATION

ROOT = Path(__file__).parent.parent
PAPER = ROOT / "docs" / "results" / "paper"


PUBLISHED = ROOT / "docs" / "results"
PAGES = {page.relative_to(PUBLISHED).as_posix(): page for page in pages(PUBLISHED)}
STUDIES = [name for name, page in PAGES.items() if (page.parent / "environment.json").exists()]
AGAIN = "make it again, or mark it as it is: uv run python -m bench.publishing --mark"


def quick_start() -> list[str]:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"## Quick start\n.*?```bash\n(.*?)```", readme, re.DOTALL)
    assert block is not None
    return block[1].splitlines()


def block_of(name: str) -> str:
    """The generated block of a document."""
    document = (ROOT / BLOCKS[name][0]).read_text(encoding="utf-8")
    found = re.search(rf"<!-- begin {name}\b.*?<!-- end {name} -->", document, re.DOTALL)
    assert found is not None
    return found[0]


def test_quick_start_is_the_main_job_and_the_tests():
    assert quick_start() == ["pip install uv && uv run -m bench run", "uv run pytest"]


def test_the_headline_table_is_the_published_one():
    document = block_of("headline")
    published = (PAPER / "tables.md").read_text(encoding="utf-8")
    rows = [line for line in document.splitlines() if line.startswith(("| scene ", "| four_", "| card_", "| leaning_"))]
    assert len(rows) > 10
    assert all(f"{row}\n" in published for row in rows)


def test_published_results_come_from_a_clean_commit():
    environment = json.loads((PAPER / "environment.json").read_text(encoding="utf-8"))
    assert environment["modified"] is False
    assert re.fullmatch("[0-9a-f]{40}", environment["commit"])


LATER_COLUMNS = {"frame_ratio_one_live"}
"""Columns that format 3 got after some pages were published; a page made before leaves them out."""


def test_published_columns_are_those_of_the_records_of_their_format():
    table = pq.read_table(PAPER / "trials.parquet")
    (of_format,) = set(table["format"].to_pylist())
    left_out = set(flat_columns(of_format)) - set(table.column_names)
    assert left_out <= LATER_COLUMNS
    assert table.column_names == [column for column in flat_columns(of_format) if column not in left_out]


@pytest.mark.parametrize("name", STUDIES)
def test_a_published_study_keeps_what_its_numbers_can_be_made_from_again(name: str):
    files = {path.name for path in PAGES[name].parent.iterdir()}
    assert {"tables.md", "trials.parquet", "study.toml", "environment.json"} <= files
    pictures = files & {"figure.svg", "stills.png"}
    assert len(pictures) == 1 or (not pictures and not PUBLICATIONS[PAGES[name].parent.name].is_timed)
    others = files - {"tables.md", "trials.parquet", "study.toml", "environment.json", "figure.svg", "stills.png"}
    assert all(other.endswith(".md") for other in others), "of commands of their own"


def test_every_kind_of_page_is_held_to_its_core():
    assert {"paper/tables.md", "truth/tables.md", "truth/decisions.md", "speed/README.md"} <= set(PAGES)


@pytest.mark.parametrize("name", PAGES)
def test_a_page_claims_nothing_for_a_core_that_did_not_make_it(name: str):
    """The digest is that of the core as it is; a page of another one says so at its top."""
    page, present = PAGES[name], present_core()
    text = page.read_text(encoding="utf-8")
    assert text == marked(text, core_of(page), present), f"{name} is of {core_of(page)}, the core is {present}: {AGAIN}"


@pytest.mark.parametrize("name", STUDIES)
def test_the_core_of_a_study_is_that_of_its_run(name: str):
    page = PAGES[name]
    environment = json.loads((page.parent / "environment.json").read_text(encoding="utf-8"))
    core = core_of(page)
    if page.name != "tables.md":  # has a command of its own
        assert core != NOT_USED
    elif not is_of_core(page.parent):
        assert core == NOT_USED
    else:
        ran_with = environment.get("core") or core_of_commit(environment["commit"])
        if ran_with is None:
            pytest.skip("no git here that holds its commit")
        assert core in {ran_with, UNKNOWN}


@pytest.mark.parametrize(
    ("block", "pages"),
    [("headline", ["paper"]), ("many_seeds", ["publish"]), ("pairs", ["truth"]), ("ratios", ["ratio", "publish"])],
)
def test_a_document_says_below_a_table_that_it_is_of_an_earlier_core(block: str, pages: list[str]):
    found = block_of(block)
    outputs = {warning(core_of(PAGES[f"{page}/tables.md"]), present_core()) for page in pages}
    assert found.count("Made with an earlier core") == len(outputs - {""}), AGAIN
    assert all(output in found for output in outputs)


def test_the_readme_says_below_its_table_which_studies_are_of_an_earlier_core():
    found = block_of("separation")
    for study in SEPARATION:
        assert warning(core_of(PAGES[f"{study}/tables.md"]), present_core()) in found, AGAIN
