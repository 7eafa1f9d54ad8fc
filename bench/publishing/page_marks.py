"""Marks on published pages: the digest of the core that made a page, and a banner if the present core differs.

Each page below ``docs/results`` ends with a line ``core: DIGEST``. The generator of a page writes this line together
with the numbers, and no later command changes the line. The banner at the top depends on that digest. The command ``uv
run python -m bench.publishing --mark`` renews all banners.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

from bench.machine.core_digest import core_of_commit, present_core
from bench.machine.source_digest import ROUNDS
from bench.studies.policies import BENCH_POLICIES
from reports.records.atomic import write_atomic
from reports.records.folder import ENVIRONMENT, REPORT, ResultsFolder, published_rows

UNKNOWN = "unknown"
"""Text in place of the digest on a page without a recorded digest and without a known commit."""
NOT_USED = "not used"
"""Text in place of the digest on a page of engines alone, which does not use the core."""
_FOOTER = re.compile(rf"\n*^core: ([0-9a-f]{{12}}|{UNKNOWN}|{NOT_USED})\n*\Z", re.MULTILINE)
_BANNER = re.compile(r"\A> \*\*Made with an earlier core[^\n]*\n\n?")
_TABLES = "tables.md"


class MarkError(ValueError):
    """A page without the digest of its core; the message names the page and the fix."""


def pages(folder: Path) -> Iterator[Path]:
    """Yield every published page below ``folder``, sorted by path.

    Three kinds of files are no published pages:

    - files directly in ``folder``, such as the README that lists the pages;
    - reports that ``bench report`` has built in ``folder``;
    - frozen rounds, because a round does not change.
    """
    others = {REPORT, ROUNDS.name}
    return (
        path
        for path in sorted(folder.rglob("*.md"))
        if path.parent != folder and not others.intersection(path.relative_to(folder).parts)
    )


def signed(text: str, core: str) -> str:
    """Return the text of a page with the line ``core: DIGEST`` at its end."""
    return f"{_FOOTER.sub('', text).rstrip()}\n\ncore: {core}\n"


def core_of(page: Path) -> str:
    """Return the digest of the core that made a page, or ``UNKNOWN`` or ``NOT_USED``.

    Raises:
        MarkError: if the page does not end with the line ``core: DIGEST``.
    """
    text = page.read_text(encoding="utf-8")
    found = _FOOTER.search(text)
    if found is None:
        last = (text.splitlines() or [""])[-1]
        raise MarkError(
            f"{page}: the last line must be 'core: DIGEST', got {last[:80]!r}; write this line with 'python -m "
            "bench.publishing --mark'"
        )
    return found[1]


def warning(core: str, present: str) -> str:
    """Return the caveat for a page that ``core`` made; empty if the page needs no caveat.

    Args:
        core: digest of the core that made the page, or ``UNKNOWN`` or ``NOT_USED``.
        present: digest of the present core.
    """
    if core in {present, NOT_USED}:
        return ""
    digest = "digest unknown" if core == UNKNOWN else f"digest `{core}`"
    return f"Made with an earlier core ({digest}); not yet made again: its claims hold for that core only."


def marked(text: str, core: str, present: str) -> str:
    """Return the text of a page with the line ``core: DIGEST``, and with the caveat of ``warning``, if any, on top."""
    caveat = warning(core, present)
    banner = f"> **{caveat}**\n\n" if caveat else ""
    return banner + signed(_BANNER.sub("", text), core)


def write_page(page: Path, text: str, core: str) -> None:
    """Write a page with its marks.

    Args:
        page: path of the page.
        text: content of the page as Markdown.
        core: digest of the core when the computation began, because the code may change during the computation.
    """
    page.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(page, marked(text, core, present_core()).encode())


def mark(page: Path, present: str | None = None) -> None:
    """Renew the banner of a page, and add the line ``core: DIGEST`` to a page without this line.

    Args:
        page: path of the page.
        present: digest of the present core; None to compute the digest.
    """
    text = page.read_text(encoding="utf-8")
    found = _FOOTER.search(text)
    core = found[1] if found else _recorded_core(page)
    write_atomic(page, marked(text, core, present or present_core()).encode())


def mark_all(folder: Path) -> int:
    """Renew the banners of all pages below ``folder``; return the number of pages that an earlier core made."""
    present, earlier = present_core(), 0
    for page in pages(folder):
        mark(page, present)
        earlier += bool(warning(core_of(page), present))
    return earlier


def _recorded_core(page: Path) -> str:
    """Return the digest of the core for a page without the line ``core: DIGEST``, from its environment file.

    The environment file records the digest, or at least the commit from which the function computes the digest. The
    result is ``NOT_USED`` for a study of engines alone. It is ``UNKNOWN`` without the file, without that commit in the
    repository, or for a page that is not ``tables.md``.
    """
    if page.name != _TABLES or not (page.parent / ENVIRONMENT).exists():
        return UNKNOWN
    if not is_of_core(page.parent):
        return NOT_USED
    environment = json.loads((page.parent / ENVIRONMENT).read_text(encoding="utf-8"))
    return environment.get("core") or core_of_commit(environment["commit"]) or UNKNOWN


def is_of_core(folder: Path) -> bool:
    """Return whether any trial of a published study used a policy of the core."""
    policies = {row["policy"] for row in published_rows(ResultsFolder(folder).trials_file)}
    return any(BENCH_POLICIES[policy].core is not None for policy in policies)
