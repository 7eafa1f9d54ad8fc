"""The creep limit, and the creep that recordings prove for trials from before format 3."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from reports.records.recording import FROZEN, LENGTH_BAND, LENGTH_STEP, REMOVED, Recording
from reports.records.trial import TrialRecord
from scenarios.lookup import UnknownNameError
from scenarios.registry import build

CREEP_LIMIT_PER_MIN = 0.01
"""Greatest creep of a standing stack, in thicknesses of a brick per minute. A plank 7.8 mm thick may creep at 1.3
micrometres per second, so that the plank needs 100 minutes to move by its thickness."""
_MINUTE_S = 60.0
_RECORDED_M = math.sqrt(3) * (LENGTH_BAND + LENGTH_STEP / 2)
"""Greatest distance of a recorded centre from the true centre [m]: dead band and rounding, in three directions."""


def creep_limit_m_s(thickness_m: float, per_min: float = CREEP_LIMIT_PER_MIN) -> float:
    """Return the creep limit of a brick [m/s].

    Args:
        thickness_m: thickness of the brick [m].
        per_min: creep limit in thicknesses per minute.
    """
    return per_min * thickness_m / _MINUTE_S


def is_creeping(creep_m_s: float, error_m_s: float, limit_m_s: float) -> bool:
    """Return whether the whole interval of a creep lies above the limit.

    A creep whose interval includes the limit does not count, because vibration also moves a brick.

    Args:
        creep_m_s: the creep [m/s].
        error_m_s: half width of the interval of the creep [m/s].
        limit_m_s: the creep limit [m/s].
    """
    return creep_m_s - error_m_s > limit_m_s


def with_creep(record: TrialRecord, recording: Recording) -> TrialRecord:
    """Return a record from before format 3 with the creep that its recording proves, and with the resulting verdict.

    A recording is accurate to about 0.05 mm in each coordinate. Therefore a recording proves only two cases:

    - zero creep, if all bricks were frozen during the last half of the watch;
    - a creep above the limit, if the creep of a brick exceeds the limit by more than the greatest error of that creep.

    In any other case, for a thinned recording and for a record since format 3, the record stays unchanged. The verdict
    changes only from ``right`` to ``creeps``.
    """
    begin = _watch_half_s(record)
    if record.creep_m_s is not None or record.mean_motion_m_s is None or begin is None or recording.every != 1:
        return record
    first = math.ceil(begin / recording.frame_s)
    if recording.frames - first < 2:
        return record
    found = _proven(recording, first)
    if found is None:
        return record
    crept, error, thickness = found
    limit = creep_limit_m_s(thickness)
    fields = {
        "creep_m_s": crept,
        "creep_error_m_s": error,
        "creep_thickness_m": thickness,
        "creep_limit_m_s": limit,
    }
    stood = record.verdict == "right" and record.expectation.outcome == "stand"
    verdict = "creeps" if stood and is_creeping(crept, error, limit) else record.verdict
    return record.model_copy(update={**fields, "verdict": verdict})


def _watch_half_s(record: TrialRecord) -> float | None:
    """Return the start of the last half of the watch [s]; None if this version of the suite cannot build the scene."""
    try:
        return record.simulated_s - build(record.scenario, **record.parameters).watch_s / 2
    except (ValueError, TypeError, UnknownNameError):
        return None


def _proven(recording: Recording, first: int) -> tuple[float, float, float] | None:
    """Return the creep that the recording proves from frame ``first`` on; None if the recording proves nothing.

    Returns:
        Creep [m/s], greatest error of the creep [m/s], and thickness [m] of one brick. The brick has the greatest ratio
        (creep - error) / thickness. If all bricks are frozen: zero, zero, and the least thickness of a brick. Bricks
        that are removed before frame ``first`` do not count.
    """
    fastest: tuple[float, float, float] | None = None
    all_frozen = True
    thinnest = math.inf
    for body in np.unique(recording.body).tolist():
        rows = recording.body == body
        frame, state = recording.frame[rows], recording.state[rows]
        latest = int(np.searchsorted(frame, first, "right")) - 1
        if latest < 0:
            return None
        if state[latest] == REMOVED:
            continue
        thickness = min(recording.sizes[body])
        thinnest = min(thinnest, thickness)
        all_frozen &= bool((state[latest:] == FROZEN).all())
        crept, error = _slope(frame, recording.position[rows] * LENGTH_STEP, first, recording)
        if fastest is None or (crept - error) / thickness > (fastest[0] - fastest[1]) / fastest[2]:
            fastest = crept, error, thickness
    if all_frozen and fastest is not None:
        return 0.0, 0.0, thinnest
    if fastest is not None and is_creeping(fastest[0], fastest[1], creep_limit_m_s(fastest[2])):
        return fastest
    return None


def _slope(
    frame: npt.NDArray[np.int32], position: npt.NDArray[np.float64], first: int, recording: Recording
) -> tuple[float, float]:
    """Return the speed of a brick by regression over its recorded positions, and the greatest error of the speed [m/s].

    With the position x_k of the brick at the time t_k of frame k:

        slope     = sum_k w_k x_k,   w_k = (t_k - t_mean) / sum_j (t_j - t_mean)^2
        |error|  <= sum_k |w_k| * greatest error of a position

    Args:
        frame: frames of the rows of the brick, shape (n,).
        position: positions of the brick [m], shape (n, 3), world frame; each position holds until the next row.
        first: first frame of the regression.
        recording: the recording of the trial.
    """
    frames = np.arange(first, recording.frames)
    time = frames * recording.frame_s
    time -= time.mean()
    held = position[np.searchsorted(frame, frames, "right") - 1]
    slope = time @ (held - held[0]) / (time @ time)
    return float(np.linalg.norm(slope)), float(_RECORDED_M * np.abs(time).sum() / (time @ time))
