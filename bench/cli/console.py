"""Consoles, the results folder and the handling of bad input, shared by the commands."""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer
from rich.console import Console

from adapters import EngineNotInstalledError, EnginesFileError, PeerError, ProfileError, ProfileFileError
from bench.compare.commands import CheckoutError
from bench.compare.comparison import NothingInCommonError
from bench.compare.failures import SideFailedError
from bench.compare.side import BaselineError
from bench.execution.errors import ClusterError
from bench.execution.results import ResultsError
from bench.history.bisection import BisectionError
from bench.history.versions import VersionsError
from bench.studies.schema import StudyError
from reports.records.folder import ResultsFolder
from reports.records.history import HistoryError
from reports.records.recording import RecordingError
from reports.records.trial import RecordError, RecordWarning, TrialRecord
from reports.replays.errors import ExportError
from scenarios.lookup import UnknownNameError

RESULTS = Path("results")
"""Default folder for the results of runs. An estimate also reads the earlier results in this folder."""
_LOG_WIDTH = 110
for _stream in (sys.stdout, sys.stderr):  # a terminal whose encoding lacks a character shows its code
    if isinstance(_stream, io.TextIOWrapper):
        _stream.reconfigure(errors="backslashreplace")
OUT = Console(width=None if sys.stdout.isatty() else _LOG_WIDTH)
"""Standard output: tables and records."""
ERR = Console(stderr=True)
"""Standard error: progress, notes and errors."""


@contextmanager
def input_errors() -> Iterator[None]:
    """Print the message of an input error inside the ``with`` block, without a traceback, and exit with status 2."""
    try:
        yield
    except (
        UnknownNameError,
        StudyError,
        ResultsError,
        RecordError,
        RecordingError,
        EngineNotInstalledError,
        EnginesFileError,
        PeerError,
        ProfileError,
        ProfileFileError,
        ClusterError,
        BaselineError,
        CheckoutError,
        SideFailedError,
        VersionsError,
        BisectionError,
        HistoryError,
        NothingInCommonError,
        ExportError,
        OSError,
    ) as error:
        ERR.print(f"error: {error}", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(2) from error


def note(text: str) -> None:
    """Print ``text`` on standard error."""
    ERR.print(text, highlight=False, soft_wrap=True)


def relative(folder: Path) -> str:
    """Return a path relative to the working directory."""
    return os.path.relpath(folder)


def read_folder(folder: Path) -> list[TrialRecord]:
    """Return the records of a results folder; print a warning if the last line is incomplete.

    Raises:
        RecordError: if a file of the folder is missing or invalid.
    """
    with printed_warnings():
        return ResultsFolder(folder).records


@contextmanager
def printed_warnings() -> Iterator[None]:
    """Print the warnings of the code inside the ``with`` block, among them every ``RecordWarning``, after the block.

    Print nothing if the block raises an error.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        yield
    for warning in caught:
        note(f"warning: {warning.message}")
