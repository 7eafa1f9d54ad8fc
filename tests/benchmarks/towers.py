"""Plank towers whose frames are timed: with the extension while the topmost plank lands, and all awake without it."""

from __future__ import annotations

import statistics
from abc import ABC, abstractmethod
from dataclasses import replace
from functools import cache

from adapters import open_engine
from adapters.base import Simulation
from bench.machine.calibration import calibrate
from bench.trial.awake_baseline import WARM_UP_FRAMES, open_awake
from bench.trial.builder import Builder
from bench.trial.measure import Plan, intact
from bench.trial.playback import SEATING_S, Snapshot
from bench.trial.stepping import FrameTimes, PlainFrames, SteeredFrames
from scenarios.model import CLEARANCE, Scene
from scenarios.registry import build
from stability_core import warm_up

PROFILE = "game"
SCENE = "plank_tower"
ALONE_FRAMES = 30
"""Frames without the extension before each second with it."""


class Tower(ABC):
    """A tower that is timed second by second; ``begin`` and ``frame`` are called in turns."""

    frames: PlainFrames | SteeredFrames

    def __init__(self, engine: str, levels: int) -> None:
        self.engine = engine
        self.scene = build(SCENE, levels=levels)
        self.simulation = self._open()
        self.frames_per_second = round(1 / self.simulation.info.frame_s)
        self.times: list[FrameTimes] = []
        """Of every frame since the tower was opened."""
        self.calibration_ms: list[float] = []
        """Time of the fixed calculation before each second."""

    @abstractmethod
    def _open(self) -> Simulation: ...

    @abstractmethod
    def _begin_second(self) -> None: ...

    @property
    def plan(self) -> Plan:
        return Plan.of(self.scene.bricks)

    @property
    def stands(self) -> bool:
        """Whether every plank is in its place."""
        _, position, quaternion = self.simulation.poses()
        return intact(self.plan, position, quaternion)

    def begin(self) -> None:
        """Prepare the next frame: every second begins in the same way, whatever happened in the one before."""
        if len(self.times) % self.frames_per_second == 0:
            self.calibration_ms.append(statistics.median(calibrate()))
            self._begin_second()

    def frame(self) -> None:
        """Play one frame: the engine's step, and the extension's update if there is one."""
        times, _ = self.frames.play()
        self.times.append(times)

    def close(self) -> None:
        self.simulation.close()


class SteeredTower(Tower):
    """A tower with the extension, on which the topmost plank lands and freezes in every second."""

    def __init__(self, engine: str, levels: int, policy: str) -> None:
        warm_up(policy)
        self.policy = policy
        self.alone = AwakeTower(engine, levels)
        self.alone_ms: list[float] = []
        """Median time of a frame without the extension, before each second: at the same speed of the machine."""
        super().__init__(engine, levels)

    def _open(self) -> Simulation:
        simulation = open_engine(self.engine, PROFILE, world=self.scene.world, expected=self.scene.bricks)
        self.frames = SteeredFrames(simulation, self.policy)
        play_whole(self.scene, simulation, self.frames)
        self.top = int(simulation.poses()[0][-1])
        return simulation

    def _begin_second(self) -> None:
        self.alone_ms.append(self.alone.median_ms(ALONE_FRAMES))
        self.simulation.remove(self.top)
        self.frames.play()  # the extension notes the removal: that frame is not one of a landing
        *_, brick = self.scene.bricks
        x, y, _ = brick.position
        below = float(self.simulation.poses()[1][-1, 2])
        self.top = self.simulation.spawn(replace(brick, position=(x, y, below + brick.size[2] + CLEARANCE)))

    def close(self) -> None:
        self.alone.close()
        super().close()


class AwakeTower(Tower):
    """The same tower without the extension, all awake: set up anew in every second, and whenever it has fallen."""

    def _open(self) -> Simulation:
        levels = len(self.scene.bricks)
        simulation = open_awake(self.engine, PROFILE, self.scene.world, built_stack(self.engine, levels))
        self.frames = PlainFrames(simulation)
        for _ in range(WARM_UP_FRAMES):
            self.frames.play()
        return simulation

    def _begin_second(self) -> None:
        self.simulation.close()
        self.simulation = self._open()

    def begin(self) -> None:
        super().begin()
        if not self.stands:
            self._begin_second()

    def median_ms(self, frames: int) -> float:
        """Median time of the next frames."""
        for _ in range(frames):
            self.begin()
            self.frame()
        return statistics.median(one.total for one in self.times[-frames:]) * 1e3


def play_whole(scene: Scene, simulation: Simulation, frames: SteeredFrames) -> Builder:
    """Build a scene as the harness does, one plank a second, and let the last one come to rest."""
    builder = Builder(scene, simulation, frames)
    frame_s = simulation.info.frame_s
    for frame in range(round((scene.done_s + SEATING_S) / frame_s)):
        builder.act(frame * frame_s)
        frames.play()
    return builder


@cache
def built_stack(engine: str, levels: int) -> Snapshot:
    """The tower as it stands once the extension has built it."""
    scene = build(SCENE, levels=levels)
    warm_up("equilibrium")
    simulation = open_engine(engine, PROFILE, world=scene.world, expected=scene.bricks)
    try:
        builder = play_whole(scene, simulation, SteeredFrames(simulation, "equilibrium"))
        _, position, quaternion = simulation.poses()
        return Snapshot(builder.bricks, position.copy(), quaternion.copy())
    finally:
        simulation.close()
