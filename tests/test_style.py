"""Words that the style rules replaced do not come back: in sources, tests and documentation."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SUFFIXES = {".py", ".md", ".toml", ".yml", ".yaml", ".json", ".cff", ".mjs", ".js", ".html"}
WORDS = {
    "told": r"told",
    "tell": r"tells?|telling",
    "nought": r"nought",
    "lest": r"lest",
    "whither": r"whither",
    "thaw": r"thaw(?:s|ed|ing)?",
    "rouse": r"rous(?:e|es|ed|ing)",
    "heap": r"heap(?:s|ed|ing)?",
    "lay to sleep": r"la(?:y|ys|id|ying)(?: \w+){0,3} to sleep",
    "old identifiers": "|".join(
        (
            "accept_flat",
            "accept_leaning",
            "concerned",
            "fallen_out",
            "time_awake",
            "write_whole",
            "CERTAIN",
            "HAIR",
            "SURE",
        )
    ),
}
"""A pattern for each word that must not occur. A word ends at an underscore, so that identifiers count too."""

OTHER_FOLDERS = ("docs/results/", "docs/history.md", "tests/test_style.py", "stability_core/")
"""Published pages (remade by their generators), the changelog's past, this test; the core has its own list below."""

CORE = {
    "stability_core/frame.py": {"told": 2},
    "stability_core/frame_buffers.py": {"told": 1},
    "stability_core/port_check.py": {"tell": 1},
    "stability_core/equilibrium/snapshot.py": {"nought": 1},
    "stability_core/policies/equilibrium.py": {"told": 5},
    "stability_core/policies/paper.py": {"old identifiers": 10},
    "stability_core/policies/pile.py": {"heap": 10},
}
"""Uses in code of the core. Published pages name the core by a digest of its code (ADR-0012), so that a rename marks
them all as made by an earlier core. The next change of behaviour in one of these files renames its uses."""

DOCS = {
    "docs/paper_map.md": {"old identifiers"},
    "docs/adr/0002-kernels.md": {"old identifiers"},
}
"""Pages that name identifiers of the core."""


def _listed() -> list[str]:
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [name for name in names.split("\0") if Path(name).suffix in SUFFIXES and (ROOT / name).is_file()]


def _text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def _count(text: str, word: str) -> int:
    flags = 0 if word == "old identifiers" else re.IGNORECASE
    return len(re.findall(rf"(?<![A-Za-z])(?:{WORDS[word]})(?![A-Za-z])", text, flags))


@pytest.mark.parametrize("word", WORDS)
def test_replaced_words_do_not_occur(word: str) -> None:
    uses = {
        name: count
        for name in _listed()
        if not name.startswith(OTHER_FOLDERS) and word not in DOCS.get(name, ())
        if (count := _count(_text(name), word))
    }
    assert uses == {}


def test_the_core_has_no_more_uses_than_those_that_its_digest_keeps() -> None:
    uses = {
        name: counts
        for name in _listed()
        if name.startswith("stability_core/")
        if (counts := {word: count for word in WORDS if (count := _count(_text(name), word))})
    }
    assert uses == CORE
