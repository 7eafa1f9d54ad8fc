"""Traces: frame times over a trial, reduced to median and maximum per bin, so that a page can draw long trials."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from reports.records.folder import ResultsFolder
from reports.records.frames import UNTIMED_FRAMES, read_columns
from reports.records.trial import TrialRecord
from reports.statistics.groups import Group

BINS = 240
"""Greatest number of bins of a trace, so that a bin is one to three pixels wide on a page."""
_FEWEST_BINS = 48
"""Least number of bins of a trace on a page with many traces. Few bins are enough, because each bin shows its worst
frame."""
_BINS_A_PAGE = 250_000
"""Approximate number of bins of all traces of a page, which take about 2 MB, so that a page of a thousand traces stays
usable."""
_STEPS_A_DECADE = 100
"""Resolution of frame times [steps per decade]. Finer steps are useless, because a step of 2.3 % is less than a pixel
of a logarithmic axis."""


def traces(folder: Path, groups: Sequence[Group]) -> tuple[list[dict[str, Any]], list[str]]:
    """Return a trace per group with frame times, and the ids of trials whose frames are unreadable.

    The trace of a group shows the first of its draws with frame times.

    Args:
        folder: a results folder.
        groups: groups of the folder's records.
    """
    kept, missing = [], []
    most = bins_for(len(groups))
    for group in groups:
        trial = next((draw for draw in group.draws if draw.frame_ms_p50 is not None), None)
        if trial is None:
            continue
        try:
            kept.append({**group.key._asdict(), "seed": trial.seed, **_trace(folder, trial, most)})
        except (OSError, pa.ArrowException):
            missing.append(trial.trial)
    return kept, missing


def bins_for(traces: int) -> int:
    """Return the greatest number of bins of each trace on a page with ``traces`` traces."""
    return min(BINS, max(_FEWEST_BINS, _BINS_A_PAGE // max(1, traces)))


def _trace(folder: Path, trial: TrialRecord, most: int) -> dict[str, Any]:
    """Return the trace of a trial, with times in simulated seconds.

    Returns:
        The fields of the trace:

        - start and end of the frames after the first ``UNTIMED_FRAMES`` [s];
        - times at which the core unfroze bricks [s];
        - time of the fall [s], or None;
        - median and worst frame time of at most ``most`` bins, as ``_STEPS_A_DECADE`` times the decimal logarithm of
          the time in microseconds.
    """
    path = ResultsFolder(folder).frames_file(trial.trial)
    columns = read_columns(path, ("time_s", "frame_ms", "woken"))
    time, frame = columns["time_s"][UNTIMED_FRAMES:], columns["frame_ms"][UNTIMED_FRAMES:]
    bins = np.array_split(frame, min(most, len(frame)))
    woken = time[columns["woken"][UNTIMED_FRAMES:] > 0]
    return {
        "from": round(float(time[0]), 3),
        "to": round(float(time[-1]), 3),
        "median": _quantised(np.array([np.median(part) for part in bins])),
        "worst": _quantised(np.array([part.max() for part in bins])),
        "wakes": np.unique(np.round(woken, 1)).tolist(),
        "falls": round(float(time[trial.timed_frames - 1]), 2) if trial.collapse_level and trial.timed_frames else None,
    }


def _quantised(times_ms: npt.NDArray[np.float64]) -> list[int]:
    quantised: list[int] = np.rint(_STEPS_A_DECADE * np.log10(np.maximum(times_ms * 1e3, 1.0))).astype(int).tolist()
    return quantised
