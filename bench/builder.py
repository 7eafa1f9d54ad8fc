"""The hand that builds a scene in an engine: lets bricks go, takes them away, pushes them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from adapters.base import Simulation
from bench.measure import FloatArray, Plan
from scenarios.geometry import Boxes, resting_shift
from scenarios.model import Brick, Place, Push, Remove, Scene

_EARLY_S = 1e-9
"""An action is due if it lies no more than this [s] ahead: frame times are rounded sums."""


class Builder:
    """Carries out a scene's actions on a simulation, each in the frame in which it is due."""

    def __init__(self, scene: Scene, simulation: Simulation) -> None:
        self._simulation = simulation
        self._pending = list(reversed(scene.actions))
        self._missing = Counter(brick.level for brick in scene.bricks)  # bricks still to come, by level
        self._bodies: list[int] = []  # in the order of placement
        self._planned: dict[int, Brick] = {}  # by body, of those now in the world
        self.placed: dict[int, float] = {}
        """The levels that are complete, and when [s] the last brick of each was let go."""
        self.level = 0
        """The highest level of which a brick has been let go."""
        self.plan = Plan.of(())
        """Of the bricks now in the world, in the order of ``Simulation.poses``."""

    @property
    def bricks(self) -> list[Brick]:
        """The bricks now in the world as they were planned, in the order of ``Simulation.poses``."""
        return list(self._planned.values())

    @property
    def is_done(self) -> bool:
        """True when every action has been carried out."""
        return not self._pending

    def act(self, time: float) -> None:
        """Carry out all actions that are due at ``time`` [s]."""
        while action := self._due(time):
            self._pending.pop()
            if isinstance(action, Place):
                self._place(action, time)
            elif isinstance(action, Remove):
                body = self._bodies[action.brick]
                self._simulation.remove(body)
                del self._planned[body]
            else:
                self._simulation.push(self._bodies[action.brick], action.impulse)
            self.plan = Plan.of(self.bricks)

    def _due(self, time: float) -> Place | Remove | Push | None:
        if self._pending and self._pending[-1].time <= time + _EARLY_S:
            return self._pending[-1]
        return None

    def _place(self, action: Place, time: float) -> None:
        shift = resting_shift(Boxes.of(action.bricks), self._supports(action))
        for brick in action.bricks:
            x, y, z = brick.position
            body = self._simulation.spawn(replace(brick, position=(x, y, z + shift)))
            self._bodies.append(body)
            self._planned[body] = brick
            self.level = max(self.level, brick.level)
            self._missing[brick.level] -= 1
            if not self._missing[brick.level]:
                self.placed[brick.level] = time

    def _supports(self, action: Place) -> Boxes:
        """The actual boxes of all bricks of lower levels: a neighbour of the same level is no support."""
        _, position, quaternion = self._simulation.poses()
        lower = self.plan.level < min(brick.level for brick in action.bricks)
        return Boxes.at(self.plan.size[lower], position[lower], quaternion[lower])


def at_pose(brick: Brick, position: FloatArray, quaternion: FloatArray) -> Brick:
    """A brick at the pose that an engine reports: position (3,) [m], quaternion (4,)."""
    x, y, z = position.tolist()
    w, i, j, k = quaternion.tolist()
    return replace(brick, position=(x, y, z), quaternion=(w, i, j, k))
