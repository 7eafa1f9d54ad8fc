"""The results folder: its file names, and what is read from it and written into it."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable
from pathlib import Path

from reports.records.trial import TrialRecord


def write_csv(path: Path, records: Iterable[TrialRecord]) -> None:
    """One line a trial, all fields of the records; what is null is empty, what is nested is JSON."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(TrialRecord.model_fields)
        for record in records:
            fields = record.model_dump(mode="json")
            writer.writerow(json.dumps(v) if isinstance(v, dict) else v for v in fields.values())


def replay_name(trial: TrialRecord) -> str:
    """Name of the replay that shows a trial beside the other policies, without its ending."""
    return f"{trial.scene}.{trial.engine}.{trial.profile}.s{trial.seed}"


def still_of(folder: Path, trial: TrialRecord) -> Path:
    """The still of a trial in a folder of stills, whether it is there or not."""
    return folder / f"{trial.trial}.png"
