"""Links of the page to documents of the project."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

_ROOT = Path(__file__).parents[2]
"""Root of the project."""
_PATHS = {"sleep": "docs/results/sleep/tables.md", "use": "docs/using_it_in_your_engine.md"}
"""Documents to which the page refers, relative to the root of the project, by the name that the templates use."""


class Document(NamedTuple):
    """Path and link of a document."""

    path: str
    """Path relative to the root of the project, which the page shows."""
    link: str
    """Link relative to the page; empty where the document does not exist."""


def documents(report: Path) -> dict[str, Document]:
    """Return the documents to which a page in the folder ``report`` refers, by name."""
    return {name: Document(path, _link(_ROOT / path, report)) for name, path in _PATHS.items()}


def _link(document: Path, report: Path) -> str:
    return os.path.relpath(document, report).replace(os.sep, "/") if document.exists() else ""
