"""Run a study with each version of a history. The folder keeps finished versions, so that a new call continues."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.compare.checkouts import Checkout, prepare
from bench.compare.commands import CheckoutError
from bench.compare.environments import environment, is_complete, remove_environment
from bench.compare.requirements import pinned
from bench.history.figures import Figure, figures_of, first_failure
from bench.studies.schema import Study
from bench.studies.toml_text import to_toml
from reports.records.atomic import write_atomic
from reports.records.folder import ENVIRONMENT, TRIALS
from reports.records.trial import RecordError, read_records

VERSIONS = "versions"
"""Name of the folder, in the folder of a history, with the results of each version in a folder of its own."""
_DONE = "version.json"
"""File that marks a version as measured or failed, written last."""
_FILE_IN_BRACKETS = re.compile(r" \(\.\.\./[^)]*\)")
"""Pattern of the file that Python names in an import error."""


@dataclass(frozen=True, slots=True)
class Measured:
    """The figures of one version, or the reason for their absence."""

    version: str
    figures: tuple[Figure, ...] = ()
    message: str = ""
    notes: tuple[str, ...] = ()
    processor: str = ""


def measure_release(
    engine: str,
    package: str,
    version: str,
    suite: Path,
    study: Path,
    out: Path,
    console: Console,
    *,
    keep: bool,
) -> None:
    """Run the study with one release of an engine, and record the results, or the reason for a failure.

    The function does nothing if the folder of the history has these results or this reason already.

    Args:
        engine: name of the engine.
        package: package of the engine on the registry.
        version: release of the package.
        suite: folder of a checkout of the suite, which runs every release.
        study: file of the study.
        out: folder of the history.
        console: console that shows the start of each slow step.
        keep: False to remove the environment afterwards, if the function created the environment.
    """

    def run(folder: Path) -> None:
        pins = pinned(version, suite, [engine], [f"{package}=={version}"], build=False)
        common = pinned("the suite", suite, [])
        existed = is_complete(pins, common)
        python = environment(f"{package} {version}", pins, console, on=common)
        try:
            Checkout(version, suite, python, tuple(pins)).run(study, folder, report=False)
        finally:
            if not keep and not existed:
                remove_environment(python)

    _measure(version, out, run, console)


def measure_commit(commit: str, study: Study, study_file: Path, out: Path, console: Console) -> None:
    """Run the study with one commit of the suite and its locked packages, and record the results.

    After a failure, the function records the reason. The function does nothing if the folder of the history has the
    results or the reason already.
    """

    def run(folder: Path) -> None:
        prepare(commit, (), console, engines=study.engines).run(study_file, folder, report=False)

    _measure(commit, out, run, console)


def read_measured(version: str, out: Path) -> Measured:
    """Return the figures of a measured version, or the reason for their absence.

    Raises:
        RecordError: if the records of the version are unreadable.
    """
    folder = out / VERSIONS / version
    message = json.loads((folder / _DONE).read_text(encoding="utf-8"))["message"]
    if not (folder / TRIALS).exists():
        return Measured(version, message=message)
    records = read_records(folder / TRIALS)
    described: dict[str, Any] = json.loads((folder / ENVIRONMENT).read_text(encoding="utf-8"))
    notes = [
        f"without settings that are unknown here: {', '.join(missing)}"
        for engine in described["engines"].values()
        if (missing := engine.get("missing_knobs"))
    ]
    late = [one.trial for one in records if one.status == "timeout"]
    if late:
        notes.append(f"stopped by the time limit: {', '.join(late)}")
    failure = message or first_failure(records)
    figures = () if failure else tuple(figures_of(records))
    return Measured(version, figures, failure, tuple(notes), described["processor"])


def forget_failed(out: Path) -> None:
    """Remove the versions that failed to run, so that they run again; a version with failed trials stays."""
    for done in sorted((out / VERSIONS).glob(f"*/{_DONE}")):
        if json.loads(done.read_text(encoding="utf-8"))["message"]:
            shutil.rmtree(done.parent)


def write_study(study: Study, out: Path) -> Path:
    """Write the study of a history, and return the path of the file.

    Raises:
        CheckoutError: if the folder contains a history of another study.
    """
    path = (out / "study.toml").resolve()
    text = to_toml(study)
    if path.exists() and path.read_text(encoding="utf-8") != text:
        raise CheckoutError(
            f"{path} must be the study of this history, but is another study: choose another folder with --out"
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(path, text.encode())
    return path


def _measure(version: str, out: Path, run: Callable[[Path], None], console: Console) -> None:
    """Run the study with a version without a record, and record the end of the run or the reason for its failure."""
    folder = (out / VERSIONS / version).resolve()
    if (folder / _DONE).exists():
        return
    console.print(f"measuring {version}", highlight=False)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        run(folder)
        message = ""
    except (CheckoutError, RecordError) as error:
        message = _plain(str(error), (out.resolve(), Path.home()))
        console.print(f"{version} has no figures: {message}", highlight=False, markup=False)
    write_atomic(folder / _DONE, (json.dumps({"message": message}) + "\n").encode())


def _plain(message: str, folders: Sequence[Path]) -> str:
    """Return a message with "..." for each of ``folders``, and without the file that an import error names."""
    for folder in folders:
        message = message.replace(str(folder), "...")
    return _FILE_IN_BRACKETS.sub("", message)
