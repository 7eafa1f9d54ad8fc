"""Results folders as runs leave them, made up of records and frames by hand."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from reports.records.frames import UNTIMED_FRAMES, FrameRow, write_frames
from reports.records.trial import RecordWriter, TrialRecord
from reports.statistics.height_cost import CostPoint
from scenarios.model import Expectation

STANDS = Expectation("stand", "always in equilibrium")
FALLS = Expectation("fall", "n d > L first at n = 9", 9)
COMPLETED = {"height_levels": 30, "levels_placed": 30}
GAME = {"description": "one step a frame", "tuned_by": "nobody", "knobs": {}}
DESCRIBED = {"version": "1", "capabilities": {"contact_points": "up to 4"}, "profiles": {"game": GAME}}


def record(**fields) -> TrialRecord:
    """A trial that was completed as it should be, unless ``fields`` say otherwise."""
    names = {"engine": "bullet", "profile": "game", "scene": "four_stack", "policy": "none", "seed": 0, "repeat": 0}
    names |= {key: fields[key] for key in names if key in fields}
    engine, profile, scene, policy, seed, repeat = names.values()
    return TrialRecord(
        **{
            **names,
            "trial": f"{engine}.{profile}.{scene}.{policy}.s{seed}.r{repeat}",
            "engine_version": "1",
            "scenario": scene.partition("-")[0],
            "parameters": {},
            "status": "completed",
            "expectation": STANDS,
            "verdict": "right",
            "environment": "abc",
            "levels_planned": 30,
            "frame_ms_p50": 1.0 + 0.1 * seed,
            "frame_ms_p99": 2.0 + 0.1 * seed,
            "timed_frames": 100,
            **COMPLETED,
            **fields,
        }
    )


def fallen(level: int, **fields) -> TrialRecord:
    """A trial that fell at ``level`` and should not have."""
    return record(
        **{
            "status": "collapsed",
            "collapse_kind": "topple",
            "collapse_level": level,
            "height_levels": level - 1,
            "levels_placed": level,
            "verdict": "false_collapse",
            **fields,
        }
    )


def failed(status: str, **fields) -> TrialRecord:
    """A trial that never came to its end."""
    verdict = {"unsupported": "none", "timeout": "undecided"}.get(status, "failed")
    nothing = {"frame_ms_p50": None, "frame_ms_p99": None, "timed_frames": None, "height_levels": 0}
    return record(**{"status": status, "verdict": verdict, "message": f"it {status}", **nothing, **fields})


def cost_point(levels: float, frame_ms: float, engine: str = "bullet", policy: str = "none") -> CostPoint:
    """What a stack of 30 planks cost on an engine."""
    return CostPoint("plank_tower", engine, "game", policy, levels, 30, False, frame_ms)


def write_study(folder: Path, records: Sequence[TrialRecord], without_frames: Sequence[str] = ()) -> Path:
    """A results folder of ``records``, with frames of all that were timed but those named."""
    (folder / "frames").mkdir(parents=True)
    writer = RecordWriter(folder / "trials.jsonl")
    for one in records:
        writer.append(one)
        if one.timed_frames and one.trial not in without_frames:
            count = one.timed_frames + UNTIMED_FRAMES
            rows = [FrameRow(i, (i + 1) / 60, 1, 1, 1, 1.0, 1.0 + i % 7, woken=int(i == 50)) for i in range(count)]
            write_frames(folder / "frames" / f"{one.trial}.parquet", rows)
    writer.close()
    environment = {"commit": "c0ffee", "engines": dict.fromkeys({one.engine for one in records}, DESCRIBED)}
    (folder / "environment.json").write_text(json.dumps(environment))
    (folder / "study.toml").write_text('name = "made-up"\n')
    return folder
