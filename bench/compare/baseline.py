"""Read one side of a comparison, from a results folder or a baseline file, and write a baseline file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from bench.compare.results_side import read_folder
from bench.compare.side import FORMAT, Baseline, BaselineError, first_error
from bench.compare.strict_json import JsonError, parse, read_file
from reports.records.atomic import write_atomic
from reports.records.trial import RecordError


def read_baseline(path: Path) -> Baseline:
    """Return the side of a comparison from a results folder or a baseline file.

    Raises:
        BaselineError: if ``path`` is neither a results folder nor a baseline file, is incomplete or invalid, or
            contains a trial twice.
    """
    try:
        baseline = read_folder(path) if path.is_dir() else _read_baseline_file(path)
    except (JsonError, RecordError) as error:
        raise BaselineError(str(error)) from error
    except ValidationError as error:
        raise BaselineError(
            f"{path}: not a baseline of this suite: {first_error(error)}; create the file again with 'bench baseline', "
            "or run the study again"
        ) from error
    seen: set[str] = set()
    for record in baseline.trials:
        if record.trial in seen:
            raise BaselineError(
                f"{path}: trial {record.trial[:200]!r} must occur once, but occurs again; remove the additional records"
            )
        seen.add(record.trial)
    return baseline


def of_engines(side: Baseline, engines: Sequence[str] | None, name: str) -> Baseline:
    """Return the side with the trials of ``engines`` only; with all trials if ``engines`` is empty or None.

    Args:
        side: base or head.
        engines: names of engines.
        name: name of the side, for the message.

    Raises:
        BaselineError: if the side has no trial of these engines.
    """
    if not engines:
        return side
    trials = [record for record in side.trials if record.engine in engines]
    if not trials:
        present = ", ".join(sorted({record.engine for record in side.trials}))
        fix = f"give --engine with an engine of {name}: {present}" if present else "run the study first"
        raise BaselineError(f"{name} must have a trial of {' or '.join(engines)}, but has none: {fix}")
    return side.model_copy(update={"trials": trials})


def replaced_baseline(path: Path) -> Baseline | None:
    """Return the baseline in the file that a new baseline replaces; None if there is no file.

    Raises:
        BaselineError: if ``path`` is a folder, a file of another kind, or a damaged file.
    """
    if path.is_dir():
        raise BaselineError(f"{path} must be a file, but is a folder: name a file with -o")
    if not path.exists():
        return None
    try:
        return _read_baseline_file(path)
    except (JsonError, ValidationError):
        raise BaselineError(
            f"{path} must be a readable baseline file or a new file, but is unreadable, damaged or of another kind: "
            "name another file with -o"
        ) from None


def write_baseline(baseline: Baseline, path: Path) -> None:
    """Write a baseline into a file atomically; replace no existing file other than a baseline.

    Raises:
        BaselineError: if ``path`` is a folder, a file of another kind, damaged or not writable; or if a pose trace is
            unreadable.
    """
    replaced_baseline(path)
    try:
        write_atomic(path, (with_packed_traces(baseline).model_dump_json(indent=1) + "\n").encode())
    except OSError as error:
        raise BaselineError(f"{path}: cannot write this file ({error.strerror}): name another file with -o") from error


def _read_baseline_file(path: Path) -> Baseline:
    content = read_file(path)
    value = parse(content, str(path))
    if not isinstance(value, dict) or value.get("format") != FORMAT:
        got = repr(value["format"])[:80] if isinstance(value, dict) and "format" in value else "no format"
        raise JsonError(
            f"{path}: not a baseline ('format' must be '{FORMAT}', got {got}): create a baseline with 'bench baseline "
            "DIR -o FILE', or name a results folder"
        )
    return Baseline.model_validate_json(content, strict=True)


def with_packed_traces(side: Baseline) -> Baseline:
    """Return a copy of the side with its pose traces inside, so that the copy needs no files.

    Raises:
        BaselineError: if a trace is missing or unreadable.
    """
    hashes = {record.pose_hash for record in side.trials} | {
        value for hashes in side.poses.values() for value in hashes.values()
    }
    packed = {value: trace.packed() for value in side.trace_files if value in hashes and (trace := side.trace(value))}
    kept = {value: text for value, text in side.traces.items() if value in hashes}
    return side.model_copy(update={"traces": kept | packed})
