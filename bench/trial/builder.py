"""Build a scene in an engine: place, remove, push, press, pull and drive bricks, and tilt the ground."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np

from adapters.base import Simulation
from bench.trial.drives import Drives
from bench.trial.gravity import TurningGravity
from bench.trial.manipulator import Listener, Manipulator
from bench.trial.measure import EARLY_S, FloatArray, Plan
from bench.trial.support import drop_heights
from scenarios.geometry import Boxes, resting_shift, side_by_side
from scenarios.model import CLEARANCE, Action, Brick, Drive, Place, Press, Pull, Push, Remove, Scene, Tilt

HOLD_S = 0.1
"""Time before each push, press and pull at which the manipulator begins to hold the brick [s], so that the extension
unfreezes the brick first."""


class Builder:
    """Executor of a scene's actions on a simulation, in the frame in which each action is due."""

    def __init__(self, scene: Scene, simulation: Simulation, listener: Listener | None = None) -> None:
        """Prepare to build a scene.

        Args:
            scene: the scene.
            simulation: an empty simulation.
            listener: receiver of the bodies that a user holds or releases, and of every new gravity; None for no
                receiver.
        """
        self._simulation = simulation
        self._fixed = Boxes.of(scene.world.fixed)
        self._is_poured = scene.poured
        self._manipulator = Manipulator(simulation, listener)
        self._gravity = TurningGravity(simulation, listener.turn_gravity if listener else lambda _: None)
        self._drives = Drives(simulation)
        self._is_driving = False
        self._pending = list(reversed(scene.actions))
        self._missing = Counter(brick.level for brick in scene.bricks)  # number of bricks not yet placed, by level
        self.bodies: list[int] = []
        """Ids of all released bricks, in the order of placement."""
        self._planned: dict[int, Brick] = {}  # planned bricks in the world, by body
        self._drop_below: dict[int, float] = {}  # drop heights [m] of bricks without their support, by body
        self.placed: dict[int, float] = {}
        """Time at which the last brick of each complete level was released [s], by level."""
        self.level = 0
        """Highest level of which a brick has been released."""
        self.plan = Plan.of(())
        """Planned poses of the bricks in the world, in the order of ``Simulation.poses``."""
        self._set_down: list[int] = []  # bodies of prebuilt stacks that ``take_set_down`` has not yet returned

    @property
    def bricks(self) -> list[Brick]:
        """Bricks in the world at their planned poses, in the order of ``Simulation.poses``."""
        return list(self._planned.values())

    @property
    def is_done(self) -> bool:
        """True if no action is waiting or in progress."""
        return not (
            self._pending
            or self._manipulator.pulls
            or self._manipulator.presses
            or self._gravity.tilts
            or self._is_driving
        )

    def take_set_down(self) -> list[int]:
        """Return the bodies of the prebuilt stacks placed since the last call, for the extension to judge."""
        bodies, self._set_down = self._set_down, []
        return bodies

    def act(self, time: float) -> None:
        """Execute all actions that are due at ``time`` [s], and continue the actions in progress.

        The method also holds each brick that a push, press or pull moves within ``HOLD_S``.
        """
        for body in self._manipulator.pull_on(time):
            self._forget(body)
            self._plan_anew()
        self._manipulator.press_on(time + EARLY_S)
        while action := self._due(time):
            self._pending.pop()
            self._carry_out(action, time)
            self._plan_anew()
        self._gravity.turn_on(time)
        if moved := self._drives.go_on(time, self._planned):
            self._planned |= moved
            self._plan_anew()
        self._is_driving = self._drives.is_changing(time)
        for action in self._pending:
            if (
                isinstance(action, Push | Press | Pull)
                and action.time <= time + HOLD_S
                and action.brick < len(self.bodies)
            ):
                self._manipulator.hold(self.bodies[action.brick])
        if self._manipulator.pulls:
            self._follow_pulls()

    def _carry_out(self, action: Action, time: float) -> None:
        """Execute a placement, a removal or a push; start a press, pull, drive or tilt."""
        match action:
            case Place():
                self._place(action, time)
            case Remove():
                body = self.bodies[action.brick]
                self._simulation.remove(body)
                self._forget(body)
            case Push():
                self._manipulator.push(self.bodies[action.brick], action.impulse)
            case Press():
                self._manipulator.press(self.bodies[action.brick], action)
            case Pull():
                self._manipulator.pull(self.bodies[action.brick], action)
            case Drive():
                self._drives.begin(self.bodies[action.brick], action)
            case Tilt():
                self._gravity.begin(action)

    def _follow_pulls(self) -> None:
        """Set the planned pose of every pulled brick to its actual pose, so that the brick counts as in place."""
        bodies, position, quaternion = self._simulation.poses()
        for row, body in enumerate(bodies.tolist()):
            if body in self._manipulator.pulls:
                before = self._planned[body]
                self._planned[body] = at_pose(before, position[row], quaternion[row])
                self._note_lost_support(before, body)
        self._plan_anew()

    def _forget(self, body: int) -> None:
        """Remove a brick from plan and drives after its removal from the simulation, and note lost supports."""
        self._drives.forget(body)
        self._note_lost_support(self._planned.pop(body), body)

    def _note_lost_support(self, before: Brick, moved: int) -> None:
        """Record the drop heights (see ``drop_heights``) of the bricks that lost their support by a removal or a pull.

        Args:
            before: the removed or pulled brick at its planned pose before the motion.
            moved: body of the removed or pulled brick.
        """
        rest = {body: brick for body, brick in self._planned.items() if body != moved}
        left = [self._planned[moved]] if moved in self._planned else []
        bodies, position, _ = self._simulation.poses()
        heights = drop_heights(Plan.of(list(rest.values())), position[bodies != moved], before, left)
        for body, height in zip(rest, heights.tolist(), strict=True):
            if height > -math.inf:
                self._drop_below.setdefault(body, height)

    def _plan_anew(self) -> None:
        self.plan = Plan.of(self.bricks)
        if self._drop_below:
            held = dict.fromkeys(self._manipulator.pulls, -math.inf)
            heights = self._drop_below | held
            rows = [heights.get(body, -math.inf) for body in self._planned]
            self.plan = replace(self.plan, drop_below=np.array(rows))

    def _due(self, time: float) -> Action | None:
        if self._pending and self._pending[-1].time <= time + EARLY_S:
            return self._pending[-1]
        return None

    def _place(self, action: Place, time: float) -> None:
        shift = self._resting_shift(action) + action.height - CLEARANCE
        for brick in action.bricks:
            x, y, z = brick.position
            body = self._simulation.spawn(replace(brick, position=(x, y, z + shift)))
            self.bodies.append(body)
            self._planned[body] = brick
            if action.height == 0.0:
                self._set_down.append(body)
            self.level = max(self.level, brick.level)
            self._missing[brick.level] -= 1
            if not self._missing[brick.level]:
                self.placed[brick.level] = time

    def _resting_shift(self, action: Place) -> float:
        """Return the shift [m] of planned heights by which an action's bricks lie ``CLEARANCE`` above their support.

        The support is the ground, a fixed box or a brick of a lower level. A brick with a planned pose beside the
        placed bricks is no support, although small motions may let both overlap horizontally by micrometres. For a
        pile, the function ignores planned poses, because poured bricks do not rest at these poses.
        """
        _, position, quaternion = self._simulation.poses()
        plan, group = self.plan, Boxes.of(action.bricks)
        level = np.array([brick.level for brick in action.bricks])
        lower = plan.level < level.max()
        carries_nothing = plan.level[lower] >= level[:, None]
        if not self._is_poured:
            planned = plan.boxes_at(plan.position, plan.quaternion, lower)
            carries_nothing |= side_by_side(group, planned)
        actual = plan.boxes_at(position, quaternion, lower)
        return resting_shift(group, actual, neighbours=carries_nothing, fixed=self._fixed)


def at_pose(brick: Brick, position: FloatArray, quaternion: FloatArray) -> Brick:
    """Return a brick at the pose reported by an engine.

    Args:
        brick: the brick.
        position: reported centre [m], shape (3,), world frame.
        quaternion: reported orientation (w, x, y, z), shape (4,), world frame.
    """
    x, y, z = position.tolist()
    w, i, j, k = quaternion.tolist()
    return replace(brick, position=(x, y, z), quaternion=(w, i, j, k))
