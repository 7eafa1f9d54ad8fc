"""A frozen round never changes, says which core made each page, and becomes the same archive everywhere."""

import hashlib
import json
import os
import subprocess
import zipfile
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import yaml

import reports
from bench.machine.source_digest import PUBLISHED, ROOT, ROUNDS
from bench.publishing import rounds as rounds_module
from bench.publishing.archive import CHECKSUMS, write_archive
from bench.publishing.page_marks import MarkError, marked, pages
from bench.publishing.rounds import (
    RoundError,
    Source,
    changes,
    committed_results,
    freeze,
    read_manifest,
    require_clean,
    rounds,
    rounds_block,
)
from reports.records.results import write_trials_parquet
from tests.reports.studies import record

PRESENT, EARLIER, COMMIT, RUN = "0123456789ab", "ba9876543210", "c" * 40, "d" * 40
DAY, LATER = "2026-01-31", "2026-02-01"


@pytest.fixture
def source(tmp_path) -> Source:
    """Three pages: of the present core, of an earlier core, and of engines alone."""
    folder = tmp_path / "results"
    cores = {"new/tables.md": PRESENT, "old/tables.md": EARLIER, "engines/tables.md": "not used"}
    for name, core in cores.items():
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text(marked(f"# {name}\n", core, PRESENT))
    (folder / "new" / "environment.json").write_text(json.dumps({"commit": RUN}))
    (folder / "new" / "study.toml").write_text('name = "new"\n')
    write_trials_parquet(folder / "new" / "trials.parquet", [record()])
    names = [path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*")) if path.is_file()]
    (folder / "README.md").write_text("# Published results\n")
    (folder / "new" / "untracked.txt").write_text("of this machine\n")
    return Source(folder, names, COMMIT, PRESENT, ROOT / "CITATION.cff", ROOT / "LICENSE")


@pytest.fixture
def frozen(source, tmp_path) -> Path:
    return freeze(DAY, source, tmp_path / "rounds")


@pytest.mark.parametrize("folder", rounds(), ids=lambda folder: folder.name)
def test_no_file_of_a_frozen_round_has_changed(folder: Path) -> None:
    """A round is corrected by a later round, never in place."""
    assert changes(folder) == [], f"restore it: git checkout -- {folder.relative_to(ROOT)}"
    assert read_manifest(folder)["round"] == folder.name


def test_a_round_holds_the_committed_files_of_the_studies_unchanged(source: Source, frozen: Path) -> None:
    own = {"README.md", "CITATION.cff", ".zenodo.json", "LICENSE", "manifest.json"}
    found = {path.relative_to(frozen).as_posix() for path in frozen.rglob("*") if path.is_file()}
    assert found == own | set(source.files)
    assert all((frozen / name).read_bytes() == (source.folder / name).read_bytes() for name in source.files)
    assert changes(frozen) == []
    assert len(reports.load(frozen / "new").trials) == 1


def test_a_round_says_of_each_page_which_core_made_it(frozen: Path) -> None:
    """A page of an earlier core is not frozen as if it were of the present one."""
    listed = {page["page"]: page for page in read_manifest(frozen)["pages"]}
    assert {name: page["made_by"] for name, page in listed.items()} == {
        "engines/tables.md": "engines alone",
        "new/tables.md": "core",
        "old/tables.md": "earlier core",
    }
    assert listed["new/tables.md"]["commit"] == RUN
    index = (frozen / "README.md").read_text()
    assert f"| [`new/tables.md`](new/tables.md) | `{PRESENT}` | `{RUN[:10]}` | core of this round |" in index
    assert (
        f"| [`old/tables.md`](old/tables.md) | `{EARLIER}` | - | earlier core: claims hold for that core only |"
        in index
    )
    assert f"`{COMMIT}`" in index


def test_a_frozen_round_is_never_overwritten(source: Source, frozen: Path) -> None:
    before = (frozen / "manifest.json").read_bytes()
    for day in (DAY, "2026-01-30"):
        with pytest.raises(RoundError, match=f"later than the newest round, {DAY}, because rounds never change"):
            freeze(day, replace(source, commit="e" * 40), frozen.parent)
    assert (frozen / "manifest.json").read_bytes() == before
    assert freeze(LATER, source, frozen.parent).name == LATER
    assert [path.name for path in rounds(frozen.parent)] == [LATER, DAY]


@pytest.mark.parametrize("day", ["today", "2026-1-31", "20260131", "2026-02-30"])
def test_a_round_has_a_date(source: Source, tmp_path, day: str) -> None:
    with pytest.raises(RoundError, match="the date of a round must have the form YYYY-MM-DD, got"):
        freeze(day, source, tmp_path / "rounds")


def test_a_round_of_the_future_is_refused(source: Source, tmp_path) -> None:
    tomorrow = (datetime.now(UTC) + timedelta(days=1)).date().isoformat()
    with pytest.raises(RoundError, match=r"must not be in the future, got .*: give --round"):
        freeze(tomorrow, source, tmp_path / "rounds")


def test_a_page_whose_mark_is_old_is_refused(source: Source, tmp_path) -> None:
    """The core changed after the page was made, and nobody marked the page."""
    with pytest.raises(
        RoundError,
        match=r"banner and last line must fit the round's core, f{12}, but do not .*; run 'python -m",
    ):
        freeze(DAY, replace(source, core="f" * 12), tmp_path / "rounds")
    (source.folder / "new" / "tables.md").write_text("# new\n")
    with pytest.raises(MarkError, match="the last line must be 'core: DIGEST'"):
        freeze(DAY, source, tmp_path / "rounds")
    assert list((tmp_path / "rounds").glob("*")) == []


def test_every_kind_of_change_is_found(frozen: Path) -> None:
    (frozen / "new" / "tables.md").write_bytes((frozen / "new" / "tables.md").read_bytes() + b" ")
    (frozen / "old" / "tables.md").unlink()
    (frozen / "old" / "more.md").write_text("# more\n")
    assert changes(frozen) == [
        "new/tables.md: changed", "old/more.md: not in the manifest", "old/tables.md: missing"
    ]  # fmt: skip


def test_the_newest_round_is_linked_with_the_digest_of_its_manifest(source: Source, frozen: Path) -> None:
    freeze(LATER, source, frozen.parent)
    block = rounds_block(frozen.parent)
    assert block.startswith(f"The newest round: [{LATER}](rounds/{LATER}/README.md).\n")
    digest = hashlib.sha256((frozen / "manifest.json").read_bytes()).hexdigest()
    assert f"[{DAY}](rounds/{DAY}/README.md)" in block
    assert f"1 of this core, 1 of earlier cores, 1 of engines alone | `{digest}`" in block
    assert rounds_block(frozen.parent / "none") == "No round is frozen yet.\n"


def test_a_round_can_be_cited(frozen: Path) -> None:
    suite = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    cited = yaml.safe_load((frozen / "CITATION.cff").read_text())
    assert cited["version"] == f"{suite['version']}+{DAY}"
    assert (cited["type"], cited["date-released"]) == ("dataset", DAY)
    assert cited["authors"] == suite["authors"]
    deposit = json.loads((frozen / ".zenodo.json").read_text())
    assert (deposit["upload_type"], deposit["publication_date"]) == ("dataset", DAY)
    assert deposit["version"] == cited["version"]
    assert deposit["creators"] == [{"name": author["name"]} for author in suite["authors"]]
    assert "Kronborg Thomsen, Kasper; Kraus, Martin (2015)" in deposit["references"][0]


def test_the_archive_is_the_same_bytes_and_its_checksums_hold(frozen: Path, tmp_path) -> None:
    first = write_archive(frozen, tmp_path / "a")
    for path in frozen.rglob("*"):
        os.utime(path, (0, 0))
    (frozen / "LICENSE").chmod(0o600)
    assert write_archive(frozen, tmp_path / "b").read_bytes() == first.read_bytes()
    assert first.name == f"stillstack-results-{DAY}.zip"
    with zipfile.ZipFile(first) as archive:
        assert archive.testzip() is None
        archive.extractall(tmp_path / "out")
    out = tmp_path / "out" / first.stem
    found = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert {"CITATION.cff", ".zenodo.json", "LICENSE", "new/trials.parquet", "new/tables.md"} <= found
    sums = dict(reversed(line.split("  ")) for line in (out / CHECKSUMS).read_text().splitlines())
    assert sums.keys() == found - {CHECKSUMS}
    assert all(hashlib.sha256((out / name).read_bytes()).hexdigest() == digest for name, digest in sums.items())
    (out / CHECKSUMS).unlink()
    assert changes(out) == []


def test_a_changed_round_or_none_is_not_archived(frozen: Path, tmp_path) -> None:
    with pytest.raises(
        RoundError, match=rf"not a frozen round .*; restore the round with git, or choose one of the rounds {DAY}"
    ):
        write_archive(frozen.parent / LATER, tmp_path)
    (frozen / "LICENSE").write_text("none\n")
    with pytest.raises(
        RoundError,
        match=r"has 1 difference from its manifest \(LICENSE: changed\); .* restore the round with: git checkout",
    ):
        write_archive(frozen, tmp_path)
    assert list(tmp_path.glob("*.zip")) == []


def test_rounds_are_made_of_committed_files_only(monkeypatch) -> None:
    monkeypatch.setattr(rounds_module, "head", lambda: COMMIT)
    monkeypatch.setattr(rounds_module, "is_modified", lambda: False)
    files = committed_results().files
    assert {"paper/tables.md", "truth/trials.parquet"} <= set(files)
    assert not any(name == "README.md" or name.startswith("rounds/") for name in files)
    listed = subprocess.run(["git", "ls-files", "docs/results"], cwd=ROOT, capture_output=True, text=True, check=True)
    assert {f"docs/results/{name}" for name in files} <= set(listed.stdout.splitlines())
    monkeypatch.setattr(rounds_module, "is_modified", lambda: True)
    with pytest.raises(RoundError, match="differ from its commit: commit or undo the changes"):
        require_clean()
    monkeypatch.setattr(rounds_module, "head", lambda: None)
    with pytest.raises(RoundError, match="a round needs a git checkout with a commit"):
        require_clean()


def test_pages_of_rounds_are_not_marked_again() -> None:
    """A mark depends on the core of the checkout; a frozen page keeps the mark that it had."""
    assert not any(page.is_relative_to(ROUNDS) for page in pages(PUBLISHED))
