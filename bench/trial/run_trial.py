"""Run one trial: open the engine, play the scene, and return the record."""

from __future__ import annotations

import gc
import platform
import statistics
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from adapters import PeerError, capabilities, engine_version, open_engine
from bench.machine.calibration import calibrate, typical
from bench.machine.environment import allowed_cores
from bench.machine.memory import PeakMemory
from bench.studies.plan import Trial
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import Limits
from bench.trial.awake_baseline import HIGHEST_LEVEL, time_baseline
from bench.trial.judging import verdict
from bench.trial.pile_monitor import PileMonitor
from bench.trial.playback import OnFrame, Playback, Progress
from reports.records.creep import creep_limit_m_s, is_creeping
from reports.records.frames import UNTIMED_FRAMES, FrameRow
from reports.records.pose_trace import PoseTrace, PoseTracer
from reports.records.recording import Recording
from reports.records.trial import Status, TrialRecord
from scenarios.model import Scene
from scenarios.placement_noise import NoRoomError
from stability_core import warm_up

_MEANS = (
    "engine_ms",
    "readback_ms",
    "core_ms",
    "port_ms",
    "bridge_ms",
    "solver_iterations",
    "core_instructions",
)
"""Columns of frames, of which the record contains the means under the same names."""
_BROKEN: tuple[Status, ...] = ("error", "crashed")
"""Statuses after which the harness does not time the baseline (all awake), because the engine may fail again."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Results of a trial: record, frames, recording and pose trace."""

    record: TrialRecord
    frames: list[FrameRow]
    """Frames in order; empty if the playback never began."""
    recording: Recording | None = None
    """Recorded poses; None if the playback never began."""
    trace: PoseTrace | None = None
    """Pose trace; None for an engine that does not repeat bit for bit across processes, or if no playback began."""


def run_trial(
    trial: Trial,
    limits: Limits,
    environment: str,
    on_progress: Callable[[Progress], None],
    *,
    on_frame: OnFrame | None = None,
) -> Outcome:
    """Run one trial in this process; return an outcome even if the engine fails.

    Args:
        trial: the trial to run.
        limits: limits of the trial.
        environment: digest of the environment, for the record.
        on_progress: function that receives the progress after every frame.
        on_frame: function that receives the poses after every frame.

    Raises:
        EngineNotInstalledError: if the engine's package is missing.
    """
    try:
        scene = trial.build_scene()
    except NoRoomError as error:
        return Outcome(bare_record(trial, trial.planned_scene(), environment, "unsupported", str(error)), [])
    if capabilities(trial.engine).planar and not scene.planar:
        why = f"{trial.engine} is planar, but {scene.variant} is not a planar scene: choose another engine"
        return Outcome(bare_record(trial, scene, environment, "unsupported", why), [])
    begin = perf_counter()
    policy = BENCH_POLICIES[trial.policy]
    tracer = PoseTracer() if capabilities(trial.engine).deterministic == "across processes" else None
    playback = None
    machine: dict[str, Any] = {}
    try:
        if policy.core is not None:
            warm_up(policy.core)
        memory = PeakMemory()
        simulation = open_engine(
            trial.engine, trial.profile, world=scene.world, sleeping=policy.sleeping, expected=scene.bricks
        )
        info = simulation.info
        playback = Playback(
            scene,
            simulation,
            trial.policy if policy.is_steered else None,
            limits.trial_wall_s,
            on_progress,
            audits_forces=limits.forces,
            on_frame=on_frame,
            tracer=tracer,
        )
        before = calibrate()
        with _undisturbed():
            status, message = playback.run(), ""
        machine = {
            "host": platform.node(),
            "core": _only_core(),
            "memory_mib": memory.growth_mib() if simulation.own_step_s is None else None,
            "calibration_ms": typical(before, calibrate()),
        }
        simulation.close()
    except NotImplementedError as error:  # the engine cannot play the scene
        status, message = "unsupported", str(error)
    except MemoryError:
        status, message = "out_of_memory", "the process ran out of memory; run fewer jobs at a time"
    except PeerError as error:  # an engine in a separate process failed, or that process failed
        status, message = error.status, str(error)
    except ValueError as error:  # the core rejects poses that are not finite
        has_diverged = playback is not None and playback.has_diverged()
        status, message = ("diverged", "") if has_diverged else ("error", f"{type(error).__name__}: {error}")
    except Exception as error:  # any error of the engine or of the core is an outcome of the trial
        status, message = "error", f"{type(error).__name__}: {error}"
    if playback is None:
        return Outcome(bare_record(trial, scene, environment, status, message), [])
    fields = {
        **_seen(playback),
        **_creep(playback, limits.creep_per_min),
        **_timings(_standing_rows(playback), info.frame_s),
        **(_ratio(trial, scene, playback) if policy.is_steered and limits.ratio and status not in _BROKEN else {}),
        "engine_version": info.version,
        "unit_scale": info.unit_scale,
        "wall_s": perf_counter() - begin,
        **machine,
    }
    message = message or _message(status, playback, limits)
    return Outcome(
        bare_record(trial, scene, environment, status, message, **fields),
        playback.rows,
        playback.recorder.finish(),
        None if tracer is None else tracer.finish(),
    )


def bare_record(
    trial: Trial, scene: Scene, environment: str, status: Status, message: str, **fields: Any
) -> TrialRecord:
    """Return the record of a trial: its identity, its status, the measured ``fields`` and the verdict."""
    collapse = [fields.get(field) for field in ("collapse_level", "collapse_kind", "collapse_s")]
    creep = fields.get("creep_m_s")
    creeps = creep is not None and is_creeping(creep, fields["creep_error_m_s"], fields["creep_limit_m_s"])
    is_neutral = scene.world.friction == 0.0 and not fields.get("adopted")  # the extension froze it before any error
    return TrialRecord(
        **{
            "trial": trial.id,
            "engine": trial.engine,
            "engine_version": engine_version(trial.engine),
            "profile": trial.profile,
            "scenario": trial.scenario,
            "scene": trial.scene,
            "pair": scene.pair,
            "parameters": scene.parameters,
            "policy": trial.policy,
            "seed": trial.seed,
            "repeat": trial.repeat,
            "status": status,
            "message": message,
            "expectation": scene.expectation,
            "verdict": verdict(scene.expectation, status, *collapse, creeps=creeps, is_neutral=is_neutral),
            "environment": environment,
            "levels_planned": scene.levels,
            "watch_s": scene.watch_s,
            **fields,
        }
    )


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Disable garbage collection inside the block, because its pauses would count as time of the engine."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _only_core() -> int | None:
    """Return the only processor core that this process may use; None for several cores."""
    allowed = allowed_cores()
    return min(allowed) if len(allowed) == 1 else None


def _seen(playback: Playback) -> dict[str, Any]:
    standing, collapse = playback.monitor.standing, playback.monitor.collapse
    fields: dict[str, Any] = {
        "levels_placed": len(playback.builder.placed),
        "pose_hash": playback.pose_hash,
        "simulated_s": playback.simulated_s,
    }
    if standing is not None:
        fields |= {
            "height_levels": standing.level,
            "height_m": standing.height_m,
            "sink_m": standing.sink_m,
            "drift_m": standing.drift_m,
        }
    if collapse is not None:
        fields |= {"collapse_level": collapse.level, "collapse_kind": collapse.kind, "collapse_s": collapse.time}
    if isinstance(playback.monitor, PileMonitor):
        fields |= {"rest_s": playback.monitor.rest_s, "repose_deg": playback.monitor.repose_deg}
    if playback.onset is not None:
        fields |= playback.onset.fields()
    if playback.sleep_audit is not None:
        fields |= playback.sleep_audit.fields()
    if playback.force_audit is not None:
        fields |= playback.force_audit.fields()
    if playback.is_steered:
        fields |= {
            "adopted": playback.adopted,
            "wakes": playback.sleep_stats.wakes,
            "refreezes": playback.sleep_stats.refreezes,
            "longest_live_s": playback.sleep_stats.longest_live_s(playback.simulated_s),
        }
        if playback.rows:  # none if the engine raises an error in its first step
            fields |= {
                "live_mean": statistics.fmean(row.live for row in playback.rows),
                "live_last": playback.rows[-1].live,
            }
    return fields


def _creep(playback: Playback, per_min: float) -> dict[str, float]:
    """Return the fields of the record about creep; empty without a measured creep."""
    creep = playback.monitor.creep
    if creep is None:
        return {}
    return {
        "creep_m_s": creep.speed_m_s,
        "creep_error_m_s": creep.error_m_s,
        "creep_thickness_m": creep.thickness_m,
        "creep_limit_m_s": creep_limit_m_s(creep.thickness_m, per_min),
        "sliding_m_s": creep.sliding_m_s,
        "sinking_m_s": creep.sinking_m_s,
    }


def _standing_rows(playback: Playback) -> list[FrameRow]:
    """Return the frames up to a collapse, because tumbling bricks make later frames expensive."""
    collapse = playback.monitor.collapse
    return playback.rows if collapse is None else [row for row in playback.rows if row.time_s <= collapse.time]


def _timings(rows: list[FrameRow], frame_s: float) -> dict[str, Any]:
    """Return the fields of the record about frame times, from all frames after the first ``UNTIMED_FRAMES``.

    Args:
        rows: frames up to a collapse.
        frame_s: simulated time of a frame [s].
    """
    timed = rows[UNTIMED_FRAMES:]
    if not timed:
        return {}
    frame_ms = np.array([row.frame_ms for row in timed])
    mean_ms = float(frame_ms.mean())
    p50, p95, p99 = np.percentile(frame_ms, [50, 95, 99]).tolist()
    fields = {
        "frame_ms_p50": p50,
        "frame_ms_p95": p95,
        "frame_ms_p99": p99,
        "frame_ms_max": float(frame_ms.max()),
        "timed_frames": len(timed),
        "realtime_factor": frame_s * 1e3 / mean_ms
        if mean_ms
        else None,  # zero if the clock of the engine's process is too coarse
    }
    for name in _MEANS:
        parts = [getattr(row, name) for row in timed]
        if None not in parts:
            fields[name] = statistics.fmean(parts)
    return fields


def _ratio(trial: Trial, scene: Scene, playback: Playback) -> dict[str, Any]:
    standing = playback.monitor.standing
    if standing is None:
        return {"frame_ratio_message": "no level stood"}
    level = min(HIGHEST_LEVEL, standing.level)
    falls_at = scene.expectation.level
    if falls_at is not None and level >= falls_at:
        return {"frame_ratio_level": level, "frame_ratio_message": "no engine can hold this stack awake"}
    if level not in playback.at_level:
        return {"frame_ratio_level": level, "frame_ratio_message": "the level was placed together with higher levels"}
    steered_ms = [row.frame_ms for row in playback.frames_of(level) if row.frame >= UNTIMED_FRAMES]
    if not steered_ms:
        message = f"the level was placed within the first {UNTIMED_FRAMES} frames, which are not timed"
        return {"frame_ratio_level": level, "frame_ratio_message": message}
    try:
        with _undisturbed():
            awake = time_baseline(trial.engine, trial.profile, scene.world, playback.at_level[level])
    except Exception as error:  # a stack that the engine rejects has no ratio, but the trial is complete
        return {"frame_ratio_message": f"{type(error).__name__}: {error}"}
    if awake.frame_ms is None:
        return {"frame_ratio_level": level, "frame_ratio_message": awake.message}
    if awake.frame_ms == 0.0:
        return {
            "frame_ratio_level": level,
            "frame_ratio_message": "the engine's own clock is too coarse to time a frame",
        }
    return {
        "frame_ratio_level": level,
        "frame_ratio": statistics.fmean(steered_ms) / awake.frame_ms,
        "frame_ratio_one_live": None if awake.one_live_ms is None else awake.one_live_ms / awake.frame_ms,
    }


def _message(status: Status, playback: Playback, limits: Limits) -> str:
    collapse = playback.monitor.collapse
    if status == "collapsed" and collapse is not None:
        return f"{collapse.kind} at level {collapse.level}, {collapse.time:.2f} s"
    if status == "timeout":
        return (
            f"stopped after {limits.trial_wall_s:g} s of wall time at {playback.simulated_s:.1f} simulated seconds; if "
            "the trial needs longer, raise 'trial_wall_s' in the study's [limits]"
        )
    if status == "diverged":
        return f"poses were not finite after {playback.simulated_s:.2f} s"
    return ""
