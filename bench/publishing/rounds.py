"""Frozen rounds: dated, complete and constant copies of the published results, with the hash of each file.

``uv run python -m bench.publishing --round DATE`` writes ``docs/results/rounds/DATE``; see ADR-0022.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from bench.machine.checkout import head, is_modified, tracked_files
from bench.machine.core_digest import present_core
from bench.machine.source_digest import PUBLISHED, ROOT, ROUNDS
from bench.publishing.citation import CITATION, ZENODO, citation_of_round, read_citation, zenodo_metadata
from bench.publishing.page_marks import NOT_USED, core_of, marked, pages
from reports.records.folder import ENVIRONMENT, ResultsFolder
from reports.tables.table import NOTHING, Table, to_markdown

MANIFEST = "manifest.json"
"""Name of the file with the origin of a round and the hash of each of its files."""
INDEX = "README.md"
"""Name of the file with the list of the pages of a round."""
LICENCE = "LICENSE"
_FORMAT = 1
"""Version of the format of the manifest."""


class RoundError(ValueError):
    """A changed round, or a round unfit to freeze; the message names the reason and the fix."""


@dataclass(frozen=True, slots=True)
class Source:
    """The published results that a round copies."""

    folder: Path
    """Folder of the published results."""
    files: Sequence[str]
    """Files to copy, relative to ``folder``."""
    commit: str
    core: str
    """Digest of the core of the checkout."""
    citation: Path
    """File with the citation of the suite."""
    licence: Path


def committed_results() -> Source:
    """Return the published results of this checkout.

    Raises:
        RoundError: if tracked files differ from the commit, or there is no git.
    """
    commit = require_clean()
    prefix = PUBLISHED.relative_to(ROOT).as_posix() + "/"
    names = [name.removeprefix(prefix) for name in tracked_files(prefix)]
    kept = [name for name in names if "/" in name and not name.startswith(f"{ROUNDS.name}/")]
    return Source(PUBLISHED, kept, commit, present_core(), ROOT / CITATION, ROOT / LICENCE)


def require_clean() -> str:
    """Return the commit of this checkout.

    Raises:
        RoundError: if tracked files differ from the commit, or there is no git.
    """
    commit = head()
    if commit is None:
        raise RoundError(
            "a round needs a git checkout with a commit, but git is missing or reports none: install git, and run the "
            "command in a clone of the repository"
        )
    if is_modified():
        raise RoundError(
            "a round needs committed files, but files of this checkout differ from its commit: commit or undo the "
            "changes, and repeat the command"
        )
    return commit


def freeze(day: str, source: Source, to: Path = ROUNDS) -> Path:
    """Copy the published results to ``to / day``, add index, citation and manifest; return the folder ``to / day``.

    Args:
        day: date of the round, such as ``2026-11-27``.
        source: the published results.
        to: folder of the rounds.

    Raises:
        RoundError: if the date is invalid, in the future, or not after the newest round; if there are no files; or if
            banner and last line of a page do not fit the core.
        MarkError: if a page does not name its core.
    """
    _check_day(day, to)
    _check_marks(source)
    to.mkdir(parents=True, exist_ok=True)
    draft = to / f".{day}.part"
    shutil.rmtree(draft, ignore_errors=True)  # of an interrupted attempt
    for name in source.files:
        (draft / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source.folder / name, draft / name)
    shutil.copyfile(source.licence, draft / LICENCE)
    citation = citation_of_round(read_citation(source.citation), day)
    (draft / CITATION).write_text(citation.text, encoding="utf-8")
    (draft / ZENODO).write_text(json.dumps(zenodo_metadata(citation), indent=1) + "\n", encoding="utf-8")
    described = {
        "format": _FORMAT,
        "round": day,
        "version": citation.suite_version,
        "commit": source.commit,
        "core": source.core,
        "pages": list(_pages(draft, source)),
    }
    (draft / INDEX).write_text(_index(described), encoding="utf-8")
    manifest = described | {"files": {name: _sha256(draft / name) for name in _files(draft)}}
    (draft / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    return draft.rename(to / day)


def rounds(folder: Path = ROUNDS) -> list[Path]:
    """Return the folders of the frozen rounds, the newest first."""
    return sorted((path.parent for path in folder.glob(f"[0-9]*/{MANIFEST}")), reverse=True)


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a round.

    Raises:
        RoundError: if there is no readable manifest.
    """
    try:
        manifest: dict[str, Any] = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RoundError(
            f"{folder}: not a frozen round ({error}); restore the round with git, or {_choice(folder.parent)}"
        ) from error
    return manifest


def changes(folder: Path) -> list[str]:
    """Return the differences between a round and its manifest, one line per file; empty if the round is intact.

    Raises:
        RoundError: if there is no readable manifest.
    """
    frozen, present = read_manifest(folder)["files"], set(_files(folder))
    found = [f"{name}: missing" for name in frozen.keys() - present]
    found += [f"{name}: not in the manifest" for name in present - frozen.keys()]
    found += [f"{name}: changed" for name in frozen.keys() & present if _sha256(folder / name) != frozen[name]]
    return sorted(found)


def rounds_block(folder: Path = ROUNDS) -> str:
    """Return the list of the frozen rounds, the newest first, with a link to the newest round.

    Raises:
        RoundError: if a manifest is not readable.
    """
    listed = [(path, read_manifest(path)) for path in rounds(folder)]
    if not listed:
        return "No round is frozen yet.\n"
    newest = listed[0][0].name
    rows = tuple(
        (
            f"[{path.name}]({folder.name}/{path.name}/{INDEX})",
            manifest["version"],
            f"`{manifest['commit'][:10]}`",
            f"`{manifest['core']}`",
            _counts(manifest),
            f"`{_sha256(path / MANIFEST)}`",
        )
        for path, manifest in listed
    )
    header = ("Round", "Version", "Commit", "Core", "Pages", f"SHA-256 of `{MANIFEST}`")
    table = to_markdown([Table("", header, rows)]).partition("\n\n")[2]
    return f"The newest round: [{newest}]({folder.name}/{newest}/{INDEX}).\n\n{table}"


def _check_day(day: str, to: Path) -> None:
    try:
        is_date = date.fromisoformat(day).isoformat() == day
    except ValueError:
        is_date = False
    today = datetime.now(UTC).date().isoformat()
    if not is_date:
        raise RoundError(f"the date of a round must have the form YYYY-MM-DD, got {day!r}: give --round {today}")
    if day > today:
        raise RoundError(f"the date of a round must not be in the future, got {day}: give --round {today}")
    newest = next((path.name for path in rounds(to)), "")
    if day <= newest:
        fix = f"give --round {today}" if today > newest else f"wait for the day after {newest}"
        raise RoundError(
            f"the date of a round must be later than the newest round, {newest}, because rounds never change, got "
            f"{day}: {fix}"
        )


def _check_marks(source: Source) -> None:
    """Check that the source has files, and that the banner and the last line of each page fit the source's core.

    Raises:
        RoundError: if the source has no files, or banner and last line of a page do not fit the core.
        MarkError: if a page does not name its core.
    """
    if not source.files:
        raise RoundError(
            f"{source.folder}: a round needs committed results, but the folder contains none; publish a study, and "
            "commit its results"
        )
    for page in pages(source.folder):
        text = page.read_text(encoding="utf-8")
        if text != marked(text, core_of(page), source.core):
            raise RoundError(
                f"{page}: banner and last line must fit the round's core, {source.core}, but do not (the last line "
                f"names {core_of(page)}); run 'python -m bench.publishing --mark', and commit the page"
            )


def _pages(folder: Path, source: Source) -> Iterator[dict[str, str | None]]:
    """Yield for each page its name, its core, the maker of its results and, for a study, the commit of the run."""
    for page in pages(folder):
        has_run = page.name == "tables.md" and (page.parent / ENVIRONMENT).exists()
        core = core_of(page)
        yield {
            "page": page.relative_to(folder).as_posix(),
            "core": core,
            "made_by": "engines alone" if core == NOT_USED else "core" if core == source.core else "earlier core",
            "commit": ResultsFolder(page.parent).environment.get("commit") if has_run else None,
        }


def _index(described: dict[str, Any]) -> str:
    """Return the index of a round as Markdown."""
    claims = {
        "engines alone": "of engines alone",
        "core": "core of this round",
        "earlier core": "earlier core: claims hold for that core only",
    }
    rows = tuple(
        (
            f"[`{page['page']}`]({page['page']})",
            NOTHING if page["core"] == NOT_USED else f"`{page['core']}`",
            f"`{page['commit'][:10]}`" if page["commit"] else NOTHING,
            claims[page["made_by"]],
        )
        for page in described["pages"]
    )
    table = to_markdown([Table("", ("Page", "Core", "Commit of the run", "Claims"), rows)]).partition("\n\n")[2]
    return (
        f"# Results frozen on {described['round']}\n\n"
        f"The published results of version {described['version']}, as of commit `{described['commit']}` with core "
        f"`{described['core']}`. No file of this folder ever changes: `{MANIFEST}` has the SHA-256 of each, and a test "
        "compares them. Newer results are in `docs/results` of the repository. "
        f"How to cite this round: `{CITATION}`.\n\n"
        f"{table}"
    )


def _counts(manifest: dict[str, Any]) -> str:
    made_by = [page["made_by"] for page in manifest["pages"]]
    counts = {
        "of this core": made_by.count("core"),
        "of earlier cores": made_by.count("earlier core"),
        "of engines alone": made_by.count("engines alone"),
    }
    return ", ".join(f"{count} {kind}" for kind, count in counts.items() if count)


def _files(folder: Path) -> list[str]:
    """Return the sorted paths of the files of a round, relative to ``folder``, without the manifest."""
    found = (path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    return sorted(name for name in found if name != MANIFEST)


def _choice(folder: Path) -> str:
    names = ", ".join(path.name for path in rounds(folder))
    return f"choose one of the rounds {names}" if names else "freeze the first round with --round"


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
