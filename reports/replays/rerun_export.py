"""Recordings as files of Rerun (https://rerun.io), a viewer for logged 3-D data.

Each brick is an entity ``POLICY/bricks/ID`` on the timeline ``time`` (simulated seconds). Rerun shows each value until
the next value of its entity. A recording follows the same rule: a row holds until the next row of its body. The package
``rerun-sdk`` writes the file and contains the viewer. The package is optional, because it takes 0.5 GB. A box shows a
brick of any shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from reports.records.atomic import write_atomic
from reports.records.recording import FROZEN, LENGTH_STEP, QUATERNION_STEP, REMOVED, Recording
from reports.replays.drawing import COLOURS
from reports.replays.errors import ExportError
from reports.replays.live_view import APPLICATION, XYZW, log_fixed, require_rerun
from reports.replays.replay import Replayed


def write_rerun(path: Path, trials: Sequence[Replayed]) -> None:
    """Write trials to one ``.rrd`` file, with a view for each trial, side by side.

    Args:
        path: file to write.
        trials: trials to show, at least one.

    Raises:
        ExportError: if the package of Rerun is missing, or the suffix is not ``.rrd``.
    """
    if path.suffix != ".rrd":
        raise ExportError(f"{path}: the suffix of a file of Rerun must be .rrd: give --rrd FILE.rrd")
    rerun = require_rerun()
    stream = rerun.RecordingStream(APPLICATION, recording_id=trials[-1].record.trial)
    memory = stream.memory_recording()
    for trial in trials:
        policy = trial.record.policy
        log_fixed(rerun, stream, policy, trial.recording.fixed)
        _log_recording(rerun, stream, policy, trial.recording)
    views = [
        rerun.blueprint.Spatial3DView(origin=trial.record.policy, name=f"{trial.record.policy}: {trial.end}")
        for trial in trials
    ]
    stream.send_blueprint(rerun.blueprint.Blueprint(rerun.blueprint.Horizontal(*views)))
    write_atomic(path, memory.drain_as_bytes())


def _log_recording(rerun: Any, stream: Any, policy: str, recording: Recording) -> None:
    """Send the rows of each brick as columns, because a call per row would take far longer."""
    starts = np.flatnonzero(np.diff(recording.body, prepend=-1))
    for rows in np.split(np.arange(len(recording.body)), starts[1:]) if len(starts) else ():
        body = int(recording.body[rows[0]])
        entity, size = f"{policy}/bricks/{body}", recording.sizes[body]
        times = (recording.frame[rows] + 1) * recording.frame_s
        is_there = recording.state[rows] != REMOVED
        shown = rows[is_there]
        centers = recording.position[shown] * LENGTH_STEP
        turns = recording.quaternion[shown][:, XYZW] * QUATERNION_STEP
        has_fallen = np.linalg.norm(centers - recording.position[rows[0]] * LENGTH_STEP, axis=1) > min(size)
        states = np.where(has_fallen, "fallen", np.where(recording.state[shown] == FROZEN, "frozen", "live"))
        columns = rerun.Boxes3D.columns(
            half_sizes=np.tile(np.array(size) / 2, (len(shown), 1)),
            centers=centers,
            quaternions=turns / np.linalg.norm(turns, axis=1, keepdims=True),
            colors=[COLOURS[state] for state in states.tolist()],
            fill_mode=["solid"] * len(shown),
        )
        stream.send_columns(entity, [rerun.TimeColumn("time", duration=times[is_there])], columns)
        for time in times[~is_there].tolist():
            stream.set_time("time", duration=time)
            stream.log(entity, rerun.Clear(recursive=False))
