"""Play one scene on one engine frame by frame.

The playback ends when the watch ends, the stack has fallen, a pose is not finite, or the time limit passes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from time import perf_counter
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from adapters.base import Simulation
from bench.machine.instructions import process_counter
from bench.trial.builder import Builder
from bench.trial.force_audit import ForceAudit
from bench.trial.measure import FloatArray
from bench.trial.onset_monitor import OnsetMonitor
from bench.trial.pile_monitor import PileMonitor
from bench.trial.sleep_audit import SleepAudit
from bench.trial.sleep_stats import SleepStats
from bench.trial.stack_monitor import StackMonitor
from bench.trial.stepping import FrameTimes, PlainFrames, SteeredFrames, Steering
from reports.records.frames import FrameRow
from reports.records.pose_trace import PoseTracer
from reports.records.recording import Recorder
from reports.records.trial import Status
from scenarios.model import Brick, Scene, Tilt

SEATING_S = 1.0
"""Time after the last action in which the last brick settles [s], multiplied by the pace of the scene. The time is one
second, because every other brick also has a second before the next brick."""
CREEP_SHARE = 0.5
"""Share of the watch, from its start, that the measurement of creep leaves out, because the stack still settles."""
OnFrame: TypeAlias = Callable[
    [float, npt.NDArray[np.int64], FloatArray, FloatArray, Collection[int], Mapping[int, Brick]], None
]
"""Type of a function that receives a frame:

- the time [s] and the n bodies;
- their positions [m], shape (n, 3), and their quaternions (w, x, y, z), shape (n, 4);
- the frozen bodies, and the bricks by body.
"""
_ROUNDING_S = 1e-9
"""Bound on the rounding error of the simulated time at the end of a frame [s]."""


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a trial."""

    level: int
    """Highest level of which a brick has been released."""
    levels: int
    """Number of levels of the whole scene."""
    bricks: int
    """Number of bricks in the world."""
    simulated_s: float
    """Simulated time [s]."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Stack of n bricks at the end of a level: before the next level starts, or when the last brick has settled."""

    bricks: Sequence[Brick]
    """Bricks at their planned poses."""
    position: FloatArray
    """Actual centres [m], shape (n, 3), world frame."""
    quaternion: FloatArray
    """Actual orientations (w, x, y, z), shape (n, 4), world frame."""


class Playback:
    """Playback of one scene, whose measurements are available even if the playback ends by an exception."""

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        policy: str | None,
        wall_limit_s: float,
        on_progress: Callable[[Progress], None],
        *,
        audits_forces: bool = False,
        on_frame: OnFrame | None = None,
        tracer: PoseTracer | None = None,
    ) -> None:
        """Prepare to play ``scene`` in an empty ``simulation``.

        Args:
            scene: the scene to build.
            simulation: an empty world.
            policy: name of a policy with an extension; None for the engine alone.
            wall_limit_s: wall time [s] after which to stop.
            on_progress: function that receives the progress after every frame with finite poses.
            audits_forces: True to audit contact forces during the watch of the finished stack, if the engine is alone;
                with an extension there is no audit, because engines report no force on a frozen brick.
            on_frame: function that receives the poses after every frame with finite poses, outside the timed part.
            tracer: recorder of the pose trace; None to trace no poses.

        Raises:
            NotImplementedError: if the policy joins bodies, and the engine does not.
        """
        self._scene = scene
        self._simulation = simulation
        self.is_steered = policy is not None
        self._frames = (
            PlainFrames(simulation) if policy is None else SteeredFrames(simulation, policy, process_counter())
        )
        self._wall_limit_s = wall_limit_s
        self._on_progress = on_progress
        self._on_frame = on_frame
        self._tracer = tracer
        self._last_action_s = scene.done_s
        self._seated_s = self._last_action_s + SEATING_S * scene.pace
        self._hash = blake2b(digest_size=16)
        self.builder = Builder(scene, simulation, self._frames)
        creep_from_s = max(self._seated_s, self._last_action_s + CREEP_SHARE * scene.watch_s)
        self.monitor = (
            PileMonitor(self._last_action_s, self._seated_s, creep_from_s)
            if scene.poured
            else StackMonitor(creep_from_s, scene.pace)
        )
        self.onset = (
            OnsetMonitor(scene, simulation, is_alone=policy is None)
            if any(isinstance(action, Tilt) for action in scene.actions)
            else None
        )
        self.sleep_audit = SleepAudit(scene.must_move) if scene.must_move else None
        self.force_audit = ForceAudit(simulation) if audits_forces and policy is None else None
        self.sleep_stats = SleepStats()
        self.recorder = Recorder(simulation.info.frame_s, scene.world)
        self.rows: list[FrameRow] = []
        self.at_level: dict[int, Snapshot] = {}
        """Stack at the end of each level, by level."""
        self.adopted: int | None = None
        """Number of bodies of prebuilt stacks that the extension froze before the first step after their placement;
        None without an extension or a prebuilt stack."""

    @property
    def simulated_s(self) -> float:
        """Simulated time since the start [s]."""
        return len(self.rows) * self._simulation.info.frame_s

    @property
    def pose_hash(self) -> str:
        """BLAKE2b digest of the float64 poses of all frames so far, in hexadecimal."""
        return self._hash.hexdigest()

    def run(self) -> Status:
        """Play the scene to its end and return the status.

        If a frame ends after the limit on wall time while the stack stands, the status is ``timeout``, even if that
        frame was the last. The status is ``diverged`` after a frame with a pose that is not finite. The method raises
        every error of the engine and of the extension.
        """
        deadline = perf_counter() + self._wall_limit_s
        end = self._last_action_s + self._scene.watch_s - _ROUNDING_S
        while True:
            if self.monitor.collapse is None:
                self.builder.act(self.simulated_s)
                self._adopt(self.builder.take_set_down())
            if not self._play_frame():
                return "diverged"
            is_late = perf_counter() > deadline
            if is_late and self.monitor.collapse is None:
                return "timeout"
            if is_late or self.monitor.is_over or (self.builder.is_done and self.simulated_s >= end):
                return "completed" if self.monitor.collapse is None else "collapsed"

    def has_diverged(self) -> bool:
        """Return whether a present pose is not finite."""
        _, position, quaternion = self._simulation.poses()
        return not (np.isfinite(position).all() and np.isfinite(quaternion).all())

    def frames_of(self, level: int) -> list[FrameRow]:
        """Return the frames in which ``level`` was the highest level, until the last brick of the scene has settled.

        The last brick settles within ``SEATING_S``, multiplied by the pace of the scene.
        """
        until = self._seated_s + _ROUNDING_S
        return [row for row in self.rows if row.level == level and row.time_s <= until]

    def _adopt(self, bodies: Sequence[int]) -> None:
        """Make the extension, if any, judge a prebuilt stack before the next step."""
        if bodies and isinstance(self._frames, SteeredFrames):
            self.adopted = (self.adopted or 0) + len(self._frames.adopt(bodies))

    def _play_frame(self) -> bool:
        """Play, record and monitor one frame; return False if a pose is not finite."""
        begin = self.simulated_s
        times, steering = self._frames.play()
        self.rows.append(self._row(times, steering))
        now = self.simulated_s
        bodies, position, quaternion = self._simulation.poses()
        if not (np.isfinite(position).all() and np.isfinite(quaternion).all()):
            return False
        self._hash.update(np.ascontiguousarray(position, np.float64).tobytes())
        self._hash.update(np.ascontiguousarray(quaternion, np.float64).tobytes())
        position, quaternion = position.copy(), quaternion.copy()  # an engine may return views of its memory
        world, frozen, bricks = self._simulation.world, self._simulation.frozen, self._simulation.bricks
        self.recorder.see(bodies, position, quaternion, frozen, bricks, world.gravity)
        if self._tracer is not None:
            self._tracer.see(bodies, position, quaternion)
        if self._on_frame is not None:
            self._on_frame(now, bodies, position, quaternion, frozen, bricks)
        builder = self.builder
        self.monitor.see(now, builder.plan, position, quaternion, builder.placed)
        if self.onset is not None:
            self.onset.see(now, position, quaternion)
        if self.sleep_audit is not None:
            rows = dict(zip(bodies.tolist(), np.hstack([position, quaternion]), strict=True))
            placed = {index: rows[body] for index, body in enumerate(self.builder.bodies) if body in rows}
            self.sleep_audit.see(begin, now, placed)
        if self.force_audit is not None and now > self._seated_s and self.monitor.collapse is None:
            self.force_audit.see()
        if steering is not None:
            self.sleep_stats.see(begin, now, bodies.tolist(), steering.frozen, steering.woken)
        if now <= self._seated_s + _ROUNDING_S:
            self.at_level[builder.level] = Snapshot(builder.bricks, position, quaternion)
        self._on_progress(Progress(builder.level, self._scene.levels, len(bodies), now))
        return True

    def _row(self, times: FrameTimes, steering: Steering | None) -> FrameRow:
        frame, world = len(self.rows), self._simulation
        plain = FrameRow(
            frame=frame,
            time_s=(frame + 1) * world.info.frame_s,
            level=self.builder.level,
            bricks=len(world.bricks),
            live=len(world.bricks) - len(world.frozen),
            engine_ms=times.engine * 1e3,
            frame_ms=times.total * 1e3,
            bridge_ms=None if times.bridge is None else times.bridge * 1e3,
            solver_iterations=world.solver_iterations(),
        )
        if steering is None:
            return plain
        return plain._replace(
            contacts=steering.contacts,
            readback_ms=times.readback * 1e3,
            core_ms=times.core * 1e3,
            port_ms=times.port * 1e3,
            frozen=len(steering.frozen),
            woken=len(steering.woken),
            woken_because=steering.summary,
            core_instructions=steering.instructions,
            joined=steering.joined,
            parted=steering.parted,
        )
