"""Reader of files of other simulators; the suffix of a file gives its format."""

from __future__ import annotations

from pathlib import Path

from scenarios.formats.imported import Imported, ImportRefusedError
from scenarios.formats.settling import settled

MUJOCO = (".xml", ".mjcf", ".urdf")
USD = (".usd", ".usda", ".usdc")
SDF = (".sdf",)
SUFFIXES = (*MUJOCO, *USD, *SDF)
"""Suffixes of all files that ``read_file`` takes."""


def read_file(path: Path) -> Imported:
    """Return the content of a file, with each brick in exact contact with its support.

    MuJoCo reads a file with an unknown suffix.

    Raises:
        ImportRefusedError: if no reader of the format is installed, the reader cannot read the file, or a scene cannot
            hold the content; the message names the fix.
    """
    suffix = path.suffix.lower()
    if suffix in SDF:
        raise ImportRefusedError(
            "SDF has no maintained parser for Python: convert the file to URDF or MJCF, or write the bodies of the "
            "file in a TOML file"
        )
    if suffix in USD:
        from scenarios.formats.usd_import import read_usd  # here, because OpenUSD is in an optional group

        return settled(read_usd(path))
    from scenarios.formats.mujoco_files import read_mujoco_file  # here, because MuJoCo takes a second to import

    return settled(read_mujoco_file(path))
