"""A page names the core that made it, and says at its top if that is not the present core."""

import json
from pathlib import Path

import pytest

from bench.publishing import page_marks
from bench.publishing.page_marks import (
    NOT_USED,
    UNKNOWN,
    MarkError,
    core_of,
    mark,
    mark_all,
    marked,
    signed,
    warning,
    write_page,
)

OLD, NEW = "0123456789ab", "ba9876543210"
PAGE = "## A table\n\n| a |\n| --- |\n| 1 |\n"


@pytest.fixture(autouse=True)
def _present(monkeypatch) -> None:
    monkeypatch.setattr(page_marks, "present_core", lambda: NEW)


@pytest.fixture
def study(tmp_path) -> Path:
    """A published study; returns its page."""
    folder = tmp_path / "results" / "study"
    folder.mkdir(parents=True)
    (folder / "tables.md").write_text(PAGE)
    (folder / "trials.csv").write_text("trial,policy\na,none\nb,paper\n")
    (folder / "environment.json").write_text(json.dumps({"commit": "c0ffee", "core": OLD}))
    return folder / "tables.md"


def test_a_page_of_the_present_core_has_its_digest_and_no_banner() -> None:
    assert marked(PAGE, NEW, NEW) == signed(PAGE, NEW) == f"{PAGE}\ncore: {NEW}\n"


def test_a_page_of_an_earlier_core_says_so_at_its_top() -> None:
    first, _, rest = marked(PAGE, OLD, NEW).partition("\n\n")
    output = (
        "Made with an earlier core (digest `0123456789ab`); not yet made again: its claims hold for that core only."
    )
    assert first == f"> **{output}**"
    assert rest == signed(PAGE, OLD)
    assert "(digest unknown)" in marked(PAGE, UNKNOWN, NEW)
    assert warning(NOT_USED, NEW) == ""


@pytest.mark.parametrize("core", [OLD, NEW, UNKNOWN, NOT_USED])
def test_marks_are_renewed_not_accumulated(core: str) -> None:
    once = marked(PAGE, core, NEW)
    assert marked(once, core, NEW) == once
    assert marked(marked(PAGE, core, OLD), core, NEW) == once


def test_a_study_is_of_the_core_that_its_run_recorded(study: Path) -> None:
    mark(study)
    assert core_of(study) == OLD
    assert study.read_text().startswith("> **Made with an earlier core")


@pytest.mark.parametrize(("known", "core"), [(OLD, OLD), (None, UNKNOWN)])
def test_a_study_that_recorded_none_is_of_the_core_of_its_commit(monkeypatch, study: Path, known, core: str) -> None:
    (study.parent / "environment.json").write_text(json.dumps({"commit": "c0ffee"}))
    monkeypatch.setattr(page_marks, "core_of_commit", lambda commit: known if commit == "c0ffee" else None)
    mark(study)
    assert core_of(study) == core


def test_a_study_of_engines_alone_is_of_no_core(study: Path) -> None:
    (study.parent / "trials.csv").write_text("trial,policy\na,none\nb,raised\n")
    mark(study)
    assert study.read_text() == f"{PAGE}\ncore: not used\n"


def test_the_line_of_a_page_is_never_changed_by_marking(study: Path) -> None:
    study.write_text(signed(PAGE, NEW))
    mark(study)
    assert core_of(study) == NEW


def test_all_pages_are_marked_but_their_list(study: Path) -> None:
    folder = study.parents[1]
    (study.parent / "report").mkdir()
    (study.parent / "report" / "tables.md").write_text("made of the published trials, for oneself\n")
    (folder / "README.md").write_text("# Published results\n")
    write_page(folder / "speed" / "README.md", "# Speed\n", NEW)
    (folder / "study" / "other.md").write_text("# Of no known core\n")
    assert mark_all(folder) == 2
    assert (folder / "README.md").read_text() == "# Published results\n"
    assert (folder / "speed" / "README.md").read_text() == f"# Speed\n\ncore: {NEW}\n"
    assert core_of(folder / "study" / "other.md") == UNKNOWN


def test_a_page_without_its_core_is_reported_with_the_fix(study: Path) -> None:
    with pytest.raises(
        MarkError, match=r"tables.md: the last line must be 'core: DIGEST', got '.*'; write this line with .* --mark"
    ):
        core_of(study)
