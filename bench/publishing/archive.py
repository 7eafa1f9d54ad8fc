"""The archive of a frozen round: one zip file to deposit. Its bytes depend only on the files of the round."""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Iterator
from datetime import date
from pathlib import Path

from bench.publishing.rounds import RoundError, changes, read_manifest
from reports.records.atomic import atomic_file

CHECKSUMS = "SHA256SUMS"
"""Name of the file with the checksums in the archive, in the format of ``sha256sum --check``."""
_MODE = 0o100644
"""Kind and permissions of each file in the archive: a regular file that all may read."""
_UNIX = 3
"""Code of Unix as the system of origin in a zip file, so that all systems write the same bytes."""


def write_archive(folder: Path, to: Path) -> Path:
    """Write a frozen round into ``to / stillstack-results-DATE.zip``; return the path of the zip file.

    The archive contains the files of the round and their checksums. The archive does not compress the entries, because
    compressed bytes depend on the version of the compressor, and most files already contain compressed data.

    Raises:
        RoundError: if the round does not exist, or its files differ from the manifest.
    """
    day = read_manifest(folder)["round"]
    if differing := changes(folder):
        count = "1 difference" if len(differing) == 1 else f"{len(differing)} differences"
        first = "; ".join([*differing[:3], *["..."] * (len(differing) > 3)])
        raise RoundError(
            f"round {day} must be unchanged, but has {count} from its manifest ({first}); remove additional files, "
            f"and restore the round with: git checkout -- '{folder}'"
        )
    name = f"stillstack-results-{day}"
    to.mkdir(parents=True, exist_ok=True)
    target = to / f"{name}.zip"
    with atomic_file(target) as draft, zipfile.ZipFile(draft, "w", zipfile.ZIP_STORED) as archive:
        for path, content in _entries(folder):
            archive.writestr(_entry(f"{name}/{path}", date.fromisoformat(day)), content)
    return target


def _entries(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield path and content of each file of the archive, sorted by path, with the checksums last."""
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    sums = []
    for name in names:
        content = (folder / name).read_bytes()
        sums.append(f"{hashlib.sha256(content).hexdigest()}  {name}\n")
        yield name, content
    yield CHECKSUMS, "".join(sums).encode()


def _entry(path: str, day: date) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(path, (day.year, day.month, day.day, 0, 0, 0))
    entry.external_attr = _MODE << 16
    entry.create_system = _UNIX
    return entry
