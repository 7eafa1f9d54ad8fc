"""The folder in which a run leaves its results; its names are fixed."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench.studies import Study
from bench.trial import Outcome
from reports.frames import write_frames
from reports.records import RecordWriter

TRIALS = "trials.jsonl"
_PARTS = ("study.toml", "environment.json", TRIALS, "frames", "report")


class ResultsError(ValueError):
    """A folder that cannot take results; the message names the fix."""


def check_folder(folder: Path, fresh: bool) -> None:
    """Whether results can go into ``folder``; nothing is written.

    Raises:
        ResultsError: if it holds results already and ``fresh`` is not asked for, or it cannot be written.
    """
    nearest = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    if not nearest.is_dir():
        raise ResultsError(f"{nearest} is not a folder: choose another with --out")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise ResultsError(f"{nearest} cannot be written: choose another folder with --out")
    if (folder / TRIALS).exists() and not fresh:
        raise ResultsError(f"{folder} already holds trials: choose another folder with --out, or replace them: --fresh")


class Results:
    """A folder that takes the outcomes of a run, one by one."""

    def __init__(self, folder: Path, study: Study, environment: Mapping[str, Any]) -> None:
        """Make the folder, without what an earlier run left in it."""
        for name in _PARTS:
            part = folder / name
            if part.is_dir():
                shutil.rmtree(part)
            else:
                part.unlink(missing_ok=True)
        self.folder = folder
        self._frames = folder / "frames"
        self._frames.mkdir(parents=True)
        (folder / "study.toml").write_text(_to_toml(study), encoding="utf-8")
        (folder / "environment.json").write_text(json.dumps(environment, indent=2) + "\n", encoding="utf-8")
        self._writer = RecordWriter(folder / TRIALS)
        self.kept = 0
        """Number of trials kept so far."""

    def keep(self, outcome: Outcome) -> None:
        """Write the frames, then the record: a record on disk means that all of its trial is."""
        if outcome.frames:
            write_frames(self._frames / f"{outcome.record.trial}.parquet", outcome.frames)
        self._writer.append(outcome.record)
        self.kept += 1

    def close(self) -> None:
        """No more outcomes."""
        self._writer.close()


def _to_toml(study: Study) -> str:
    """The resolved study. TOML writes strings, numbers and flat lists as JSON does."""
    content = study.model_dump()
    scenarios, limits = content.pop("scenario"), content.pop("limits")
    lines = [*_assignments(content), "", "[limits]", *_assignments(limits)]
    for scenario in scenarios:
        lines += ["", "[[scenario]]", f"name = {json.dumps(scenario['name'])}"]
        if scenario["parameters"]:
            lines += ["", "[scenario.parameters]", *_assignments(scenario["parameters"])]
    return "\n".join(lines) + "\n"


def _assignments(fields: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in fields.items()]
