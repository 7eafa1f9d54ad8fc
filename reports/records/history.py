"""The history of an engine or of the suite: figures of a study for each version, with the steps between versions."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from reports.records.atomic import write_atomic

FORMAT: Literal["stillstack-history-1"] = "stillstack-history-1"
"""Name of the file format."""
HISTORY = "history.json"
"""File name of a history in its folder."""
Kind = Literal["levels", "collapse", "creep", "sink", "tilt", "time"]
"""Kind of a figure. ``reports.statistics.steps`` has the least step of each kind."""


class HistoryError(ValueError):
    """An unreadable history; the message names the file and the fix."""


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Point(_Model):
    """One version of a history."""

    version: str
    """Version of the engine, or commit of the suite."""
    link: str = ""
    """Address of the version's changelog; empty if unknown."""
    message: str = ""
    """Reason why the version has no figures; empty for a version with figures."""
    notes: list[str] = []
    """Circumstances that differ from other versions, such as missing knobs."""


class Series(_Model):
    """The values of one figure of a study over the versions."""

    name: str
    """Unique name of the figure, such as ``creep of four_stack-6``."""
    kind: Kind
    unit: str
    values: list[float | None]
    """Values, one for each point; None where the version has no value."""


class Explanation(_Model):
    """A changelog line that explains a step."""

    version: str
    """First version with the new values of the step."""
    series: list[str] = []
    """Names of the explained figures; empty for all figures with a step at ``version``."""
    quote: str
    """Quoted line of the changelog."""
    of: str = ""
    """Version whose section of the changelog contains the quote; empty for ``version`` itself."""
    link: str
    """Address of the changelog."""


class Step(_Model):
    """A lasting change of a figure."""

    series: str
    version: str
    """First version with the new values."""
    previous: str
    """Last version with the old values."""
    before: float
    """Median of the values from the previous step, or from the first version, up to this step."""
    after: float
    """Median of the values from this step up to the next step, or to the last version."""
    explanation: Explanation | None = None


class History(_Model):
    """A history with its steps."""

    format: Literal["stillstack-history-1"] = FORMAT
    subject: str
    """The engine's name, or ``stillstack`` for commits of the suite."""
    package: str = ""
    """Name of the engine's package."""
    study: str
    commit: str = ""
    """Commit of the suite that measured all versions; empty if the versions are commits."""
    processor: str = ""
    points: list[Point]
    series: list[Series]
    steps: list[Step] = []


def read_history(path: Path) -> History:
    """Return the history in a file.

    Raises:
        HistoryError: if the file is missing or unreadable, or is not a history.
    """
    try:
        return History.model_validate_json(path.read_bytes())
    except OSError as error:
        raise HistoryError(
            f"{path}: cannot read this file ({error.strerror}); name a readable file, or run 'bench history' first"
        ) from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = f"field '{'.'.join(map(str, first['loc']))}': " if first["loc"] else ""
        raise HistoryError(f"{path}: not a history: {field}{first['msg']}; run 'bench history' again") from error


def write_history(path: Path, history: History) -> None:
    """Write a history atomically; the folder must exist."""
    write_atomic(path, (history.model_dump_json(indent=1) + "\n").encode())
