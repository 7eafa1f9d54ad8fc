"""The citation of a round, as a ``CITATION.cff`` file and as metadata for Zenodo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

CITATION = "CITATION.cff"
"""Name of the file with a citation in the Citation File Format 1.2."""
ZENODO = ".zenodo.json"
"""Name of the file with the metadata that Zenodo reads."""


@dataclass(frozen=True, slots=True)
class RoundCitation:
    """Citation of a round."""

    fields: dict[str, Any]
    """Fields of the citation file."""
    suite_version: str
    """Version of the suite that made the round."""

    @property
    def text(self) -> str:
        """The citation file as text."""
        text: str = yaml.safe_dump(self.fields, sort_keys=False, allow_unicode=True, width=110)
        return text


def read_citation(file: Path) -> dict[str, Any]:
    """Return the fields of a citation file."""
    fields: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8"))
    return fields


def citation_of_round(suite: dict[str, Any], day: str) -> RoundCitation:
    """Return the citation of the round of a day, with the authors, licence and references of the suite."""
    version = str(suite["version"])
    own = {
        "message": "If you use these results, please cite them, and the paper whose method the extension implements.",
        "title": f"Stillstack results: stacking in physics engines, round of {day}",
        "type": "dataset",
        "version": f"{version}+{day}",
        "date-released": day,
    }
    return RoundCitation({**suite, **own}, version)


def zenodo_metadata(citation: RoundCitation) -> dict[str, Any]:
    """Return the metadata of a round for a deposit at Zenodo."""
    fields = citation.fields
    return {
        "title": fields["title"],
        "upload_type": "dataset",
        "description": (
            f"<p>Results of Stillstack {citation.suite_version}, a comparative benchmark of stacking in physics "
            "engines: tables, figures, and every field of every trial as Parquet, with the resolved study and the "
            "environment of each run. README.md lists the pages with the core that made each; manifest.json has the "
            "SHA-256 of each file.</p>"
        ),
        "creators": [{"name": _name(author)} for author in fields["authors"]],
        "publication_date": fields["date-released"],
        "version": fields["version"],
        "license": fields["license"],
        "access_right": "open",
        "keywords": ["rigid body", "stacking", "contact", "static equilibrium", "physics engine", "benchmark"],
        "references": [_reference(reference) for reference in fields.get("references", [])],
    }


def _name(author: dict[str, str]) -> str:
    """Return the name of a person as "family, given", or the name of an organisation."""
    if "name" in author:
        return author["name"]
    return ", ".join(author[key] for key in ("family-names", "given-names") if key in author)


def _reference(reference: dict[str, Any]) -> str:
    authors = "; ".join(map(_name, reference["authors"]))
    place = reference.get("conference", {}).get("name", "")
    return f"{authors} ({reference['year']}). {reference['title']}. {place}".strip()
