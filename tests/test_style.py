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

OTHER_FOLDERS = ("docs/results/", "docs/history.md", "tests/test_style.py")
"""Published pages (remade by their generators), the changelog's past, this test."""


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
        name: count for name in _listed() if not name.startswith(OTHER_FOLDERS) if (count := _count(_text(name), word))
    }
    assert uses == {}
