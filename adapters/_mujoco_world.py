"""A world of MuJoCo, which compiles a model on first use, and again when it needs more slots, ghosts or welds."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from adapters._mujoco_contacts import NOBODY, Geoms
from adapters._mujoco_slots import SlotModel, pattern_of
from adapters.profile import Profile
from adapters.shared.bodies import Bodies
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import IntArray


class MujocoWorld:
    """Slots of the bodies, with the compiled model and the record of its geoms."""

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
            world: friction, gravity and fixed bodies.
            profile: MuJoCo's settings.
            bodies: the adapter's record of its bodies.
            expected: the bricks that the host plans to spawn.
            needs_ghosts: function that returns True if the port may freeze bodies; the first compilation calls this
                function.
        """
        self.slot_of: dict[int, int] = {}
        """Slot of each body."""
        self._world, self._profile, self._bodies, self._needs_ghosts = world, profile, bodies, needs_ghosts
        self._patterns = [pattern_of(brick) for brick in expected]
        self._free: defaultdict[Brick, deque[int]] = defaultdict(deque)
        for slot, pattern in enumerate(self._patterns):
            self._free[pattern].append(slot)
        self._slots: SlotModel | None = None
        self._weld_of: dict[tuple[int, int], int] = {}  # MuJoCo's weld of each joined pair
        self._free_welds: list[int] = []

    @property
    def slots(self) -> SlotModel:
        """Return the model; compile it on first use, because the result of ``needs_ghosts`` is unknown earlier."""
        return self._slots or self._compile(ghosts=self._needs_ghosts())

    @property
    def geoms(self) -> Geoms:
        """Return the record of the model's geoms and their bodies."""
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
        self._free[self._patterns[slot]].append(slot)
        self._wake_all()

    def move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a body ([m], quaternion w, x, y, z), and of the ghost of a frozen body, and stop the body."""
        slot = self.slot_of[body]
        self.slots.set_pose(slot, position, quaternion)
        if body in self._bodies.frozen:
            self.slots.show_ghost(slot)
        self.geoms.assign(slot, body)
        self._wake_all()

    def freeze(self, body: int) -> None:
        """Place the ghost at a live brick's pose, and park the brick."""
        if not self.slots.has_ghosts:
            self._compile(ghosts=True)
        slot = self.slot_of[body]
        self.slots.show_ghost(slot)
        self._retire(slot)

    def unfreeze(self, body: int) -> None:
        """Activate a frozen brick at the pose of its ghost, and hide the ghost."""
        slot = self.slot_of[body]
        self.slots.hide_ghost(slot)
        self._let_live(slot)

    def join(self, pair: tuple[int, int]) -> None:
        """Join two live bodies; first, if no weld is free, compile a model with three more welds for each slot."""
        if not self._free_welds:
            first, more = self.slots.welds, 3 * len(self._patterns)
            self._compile(ghosts=self.slots.has_ghosts, welds=first + more)
            self._free_welds = list(range(first, first + more))
        self._weld_of[pair] = self._free_welds.pop(0)
        self.slots.join(self._weld_of[pair], *(self.slot_of[body] for body in pair))

    def part(self, pair: tuple[int, int]) -> None:
        """Part two joined bodies."""
        weld = self._weld_of.pop(pair)
        self.slots.part(weld)
        self._free_welds.append(weld)

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

    def _compile(self, *, ghosts: bool, welds: int | None = None) -> SlotModel:
        """Compile a model for the present patterns, and copy the state of the old model.

        Args:
            ghosts: True for a model with ghosts.
            welds: number of welds; None for as many as in the old model.
        """
        old = self._slots
        if welds is None:
            welds = 0 if old is None else old.welds
        new = SlotModel(self._patterns, self._world, self._profile, ghosts=ghosts, welds=welds)
        if old is not None:
            for body in self._bodies.frozen:
                old.hide_ghost(self.slot_of[body])
            new.copy_state(old)
            new.copy_welds(old)
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
        """Put a brick into a slot that fits; return the slot, still parked."""
        slot = self._take_slot(pattern_of(brick))
        self.slots.set_pose(slot, brick.position, brick.quaternion)
        self.slot_of[body] = slot
        self.geoms.assign(slot, body)
        return slot

    def _take_slot(self, pattern: Brick) -> int:
        """Return a free slot of a pattern; if no slot is free, first add a slot for each body, but at least one."""
        if not self._free[pattern]:
            first, more = len(self._patterns), max(1, len(self.slot_of))
            self._patterns += [pattern] * more
            self._free[pattern].extend(range(first, first + more))
            if self._slots is not None:
                self._compile(ghosts=self._slots.has_ghosts)
        return self._free[pattern].popleft()

    def _let_live(self, slot: int) -> None:
        self.slots.unpark(slot)
        self.geoms.set_live(slot, True)

    def _retire(self, slot: int) -> None:
        self.slots.park(slot)
        self.geoms.set_live(slot, False)
