"""A world of MuJoCo whose model is compiled when it is first needed, and anew when a brick fits no free slot."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from adapters._mujoco_contacts import NOBODY, Geoms
from adapters._mujoco_slots import Shape, SlotModel, shape_of
from adapters.profile import Profile
from adapters.shared.bodies import Bodies
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import IntArray


class MujocoWorld:
    """The slots of the bodies, with the compiled model that has them and the record of whose its geoms are."""

    def __init__(
        self,
        world: World,
        profile: Profile,
        bodies: Bodies,
        expected: Sequence[Brick],
        needs_ghosts: Callable[[], bool],
    ) -> None:
        """Reserve a slot for each expected brick.

        Args:
            world: friction, gravity and fixed boxes.
            profile: how MuJoCo is set up.
            bodies: the adapter's record of its bodies.
            expected: the bricks that will be spawned.
            needs_ghosts: whether bodies may be frozen; asked when the model is first compiled.
        """
        self.slot_of: dict[int, int] = {}
        """Slot of each body."""
        self._world, self._profile, self._bodies, self._needs_ghosts = world, profile, bodies, needs_ghosts
        self._shapes: list[Shape] = [shape_of(brick) for brick in expected]
        self._free: defaultdict[Shape, deque[int]] = defaultdict(deque)
        for slot, shape in enumerate(self._shapes):
            self._free[shape].append(slot)
        self._slots: SlotModel | None = None

    @property
    def slots(self) -> SlotModel:
        """The compiled model, made when it is first needed: only then is it known whether bodies may be frozen."""
        return self._slots or self._compile(ghosts=self._needs_ghosts())

    @property
    def geoms(self) -> Geoms:
        """The record of whose the model's geoms are."""
        if self._slots is None:
            self._compile(ghosts=self._needs_ghosts())
        return self._geoms

    def slots_of(self, bodies: IntArray) -> IntArray:
        """Return the slots of bodies, shape (n,)."""
        return np.array([self.slot_of[body] for body in bodies.tolist()], np.int64)

    def add_live(self, body: int, brick: Brick) -> None:
        """Put a live brick into a slot that fits."""
        self._let_live(self._occupy_slot(body, brick))

    def add_moved(self, body: int, brick: Brick) -> None:
        """Put a brick that the host moves into a slot that fits."""
        slot = self._occupy_slot(body, brick)  # first, because it may compile another model
        self.slots.unpark_moved(slot)

    def remove(self, body: int) -> None:
        """Empty the slot of a body."""
        if body in self._bodies.frozen:
            self.slots.hide_ghost(self.slot_of[body])
        slot = self.slot_of.pop(body)
        self._retire(slot)
        self.geoms.assign(slot, NOBODY)
        self._free[self._shapes[slot]].append(slot)
        self._wake_all()

    def move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a body, or of the ghost that stands for it, and stop it."""
        slot = self.slot_of[body]
        self.slots.set_pose(slot, position, quaternion)
        if body in self._bodies.frozen:
            self.slots.show_ghost(slot)
        self.geoms.assign(slot, body)
        self._wake_all()

    def freeze(self, body: int) -> None:
        """Let the ghost stand where a live brick is, and park the brick."""
        if not self.slots.has_ghosts:
            self._compile(ghosts=True)
        slot = self.slot_of[body]
        self.slots.show_ghost(slot)
        self._retire(slot)

    def unfreeze(self, body: int) -> None:
        """Let the brick live where its ghost stood."""
        slot = self.slot_of[body]
        self.slots.hide_ghost(slot)
        self._let_live(slot)

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow."""
        self._world = replace(self._world, gravity=gravity)
        if self._slots is not None:
            self._slots.model.opt.gravity = gravity
            self._wake_all()

    def close(self) -> None:
        """Free the model."""
        self._slots = None

    def _wake_all(self) -> None:
        """Wake every live brick from the engine's own sleep."""
        for body, slot in self.slot_of.items():
            if body in self._bodies.live:
                self.slots.wake(slot)

    def _compile(self, *, ghosts: bool) -> SlotModel:
        """Compile a model for the present shapes, and carry the state over."""
        old, new = self._slots, SlotModel(self._shapes, self._world, self._profile, ghosts=ghosts)
        if old is not None:
            for body in self._bodies.frozen:
                old.hide_ghost(self.slot_of[body])
            new.copy_state(old)
        self._slots, self._geoms = new, Geoms(new)
        for body, slot in self.slot_of.items():
            self.geoms.assign(slot, body)
            if body in self._bodies.frozen:
                new.show_ghost(slot)
            elif body in self._bodies.moved:
                new.unpark_moved(slot)
            else:
                self._let_live(slot)
        return new

    def _occupy_slot(self, body: int, brick: Brick) -> int:
        """Put a brick into a slot that fits; returns the slot, still parked."""
        slot = self._take_slot(shape_of(brick))
        self.slots.set_pose(slot, brick.position, brick.quaternion)
        self.slot_of[body] = slot
        self.geoms.assign(slot, body)
        return slot

    def _take_slot(self, shape: Shape) -> int:
        """Return a free slot; if there is none, make as many as there are bodies, so that few models are compiled."""
        if not self._free[shape]:
            first, more = len(self._shapes), max(1, len(self.slot_of))
            self._shapes += [shape] * more
            self._free[shape].extend(range(first, first + more))
            if self._slots is not None:
                self._compile(ghosts=self._slots.has_ghosts)
        return self._free[shape].popleft()

    def _let_live(self, slot: int) -> None:
        self.slots.unpark(slot)
        self.geoms.set_live(slot, True)

    def _retire(self, slot: int) -> None:
        self.slots.park(slot)
        self.geoms.set_live(slot, False)
