"""Results as data frames: trials, frames and poses of a results folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from types import NoneType
from typing import Any, get_args

import pandas as pd

from reports.records.atomic import atomic_file
from reports.records.flat import flat_columns, to_flat
from reports.records.folder import ResultsFolder
from reports.records.recording import LENGTH_STEP, QUATERNION_STEP, STATES
from reports.records.trial import TrialRecord

POSE_COLUMNS: Mapping[str, tuple[str, str]] = {
    "body": ("whole number", "Id of the body, unique within the trial."),
    "frame": ("whole number", "First frame of the row. The row is valid until the body's next row."),
    "time_s": ("number", "Simulated time at the end of that frame."),
    "x_m": ("number", "Centre of the body in the world, to 0.01 mm."),
    "y_m": ("number", "Centre of the body in the world, to 0.01 mm."),
    "z_m": ("number", "Centre of the body in the world, upwards, to 0.01 mm."),
    "qw": ("number", "Orientation as a unit quaternion (w, x, y, z), to 1e-4: its real part."),
    "qx": ("number", "Orientation: first imaginary part."),
    "qy": ("number", "Orientation: second imaginary part."),
    "qz": ("number", "Orientation: third imaginary part."),
    "state": ("category", "State of the body: `live`, `frozen` (held by the core or the engine), or `removed`."),
}
"""Type and meaning of each column of the poses."""
_EXPECTATION_TYPES = {
    "expectation_outcome": "str",
    "expectation_level": "Int64",
    "expectation_not_before_s": "float64",
    "expectation_within_s": "float64",
    "expectation_theory": "str",
}


class Results:
    """The results of a study as data frames."""

    def __init__(self, folder: Path) -> None:
        """Keep the path of a results folder, or of a published folder in ``docs/results``."""
        self._folder = ResultsFolder(folder)

    @cached_property
    def trials(self) -> pd.DataFrame:
        """Table with one row per trial; the column ``parameters`` contains mappings.

        ``docs/columns.md`` lists the columns.

        Raises:
            RecordError: if the folder contains no readable file of trials.

        Warns:
            RecordWarning: if the last line of ``trials.jsonl`` is incomplete; the reader skips this line.
        """
        trials = trials_frame(self._folder.records)
        trials["parameters"] = trials["parameters"].map(json.loads).astype(object)
        return trials

    def frames(self, trial: str) -> pd.DataFrame:
        """Return the frames of a trial, one row per frame.

        ``docs/columns.md`` lists the columns.

        Raises:
            OSError: if the folder contains no frames of the trial.
            pyarrow.ArrowException: if the file of the frames is incomplete.
        """
        return pd.read_parquet(self._folder.frames_file(trial))

    def poses(self, trial: str) -> pd.DataFrame:
        """Return the recorded poses of a trial, one row per change of a body's pose or state.

        A row is valid until the next row of its body. ``docs/columns.md`` lists the columns.

        Raises:
            RecordingError: if the trial has no recording, or an incomplete recording.
        """
        recording = self._folder.recording(trial)
        position, quaternion = recording.position * LENGTH_STEP, recording.quaternion * QUATERNION_STEP
        time = (recording.frame + 1) * recording.frame_s
        state = pd.Categorical.from_codes(recording.state, list(STATES))
        values = [recording.body, recording.frame, time, *position.T, *quaternion.T, state]
        return pd.DataFrame(dict(zip(POSE_COLUMNS, values, strict=True)))

    @property
    def environment(self) -> Mapping[str, Any]:
        """Machine, versions, settings and sessions of the run; empty if the folder has no readable environment."""
        return self._folder.environment

    @property
    def study(self) -> Mapping[str, Any]:
        """Content of the resolved study; empty if the folder has no readable study."""
        return self._folder.study


def trials_frame(records: Sequence[TrialRecord]) -> pd.DataFrame:
    """Return a table with one row per record, in the order of ``records``.

    A missing number is NaN or NA. The column ``parameters`` contains JSON texts.
    """
    types = column_types()
    rows = pd.DataFrame([to_flat(record) for record in records], columns=flat_columns(), dtype=object)
    return rows.astype(types)


def column_types() -> dict[str, str]:
    """Return the type of each column, by name; ``Int64`` stands for whole numbers that may be missing."""
    types = {name: _type(field.annotation) for name, field in TrialRecord.model_fields.items()}
    types |= _EXPECTATION_TYPES
    return {column: types[column] for column in flat_columns()}


def _type(annotation: Any) -> str:
    kinds = set(get_args(annotation)) or {annotation}
    if float in kinds:
        return "float64"
    if int in kinds:
        return "Int64" if NoneType in kinds else "int64"
    return "int64" if all(isinstance(kind, int) for kind in kinds) else "str"


def write_trials_csv(path: Path, records: Sequence[TrialRecord]) -> None:
    """Write the flat records as CSV, with a header and one line per trial; missing values are empty."""
    rows = pd.DataFrame([to_flat(record) for record in records], columns=flat_columns(), dtype=object)
    rows.to_csv(path, index=False, lineterminator="\n")


def write_trials_parquet(path: Path, records: Sequence[TrialRecord]) -> None:
    """Write the flat records atomically as compressed Parquet; ``reports.load`` restores the types of the columns."""
    with atomic_file(path) as draft:
        trials_frame(records).to_parquet(
            draft, index=False, compression="zstd", compression_level=19, write_statistics=False, store_schema=False
        )
