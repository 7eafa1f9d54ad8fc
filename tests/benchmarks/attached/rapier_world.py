"""A user's world of Rapier, for ``tests.benchmarks.attach_cost``."""

from __future__ import annotations

from typing import Any

from stability_core.ports import attach
from tests.benchmarks.attached.side import ABOVE, FRAME_S, FRICTION, FROZEN, MASS, PARKED, SIZE, Side, place


class AttachedRapier(Side):
    """A user's world of Rapier, with the settings of the suite's profile ``default``."""

    def __init__(self, steps: int) -> None:
        import rapier3d

        from stability_core.ports.rapier import id_of

        self.rapier, self.steps = rapier3d, steps
        self.world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -9.81))
        self.world.set_num_threads(1)
        self.world.integration_parameters.dt = FRAME_S / steps
        self.world.integration_parameters.length_unit = 0.1
        ground = rapier3d.Collider.cuboid(20.0, 20.0, 1.0).translation((0.0, 0.0, -1.0))
        self.world.add_collider(ground.friction(FRICTION))
        for index in range(FROZEN):
            self._add(place(index))
        plank = self._add(PARKED)
        self.plank, self.falling = self.world.rigid_bodies[plank], id_of(plank)
        self.extension = attach(self.world)
        self.build()

    def _add(self, position: tuple[float, ...]) -> Any:
        body = self.rapier.RigidBody.dynamic().translation(position).can_sleep(False)
        collider = self.rapier.Collider.cuboid(*(edge / 2 for edge in SIZE)).mass(MASS).friction(FRICTION)
        return self.world.add_body(body, [collider])

    def step(self) -> None:
        for _ in range(self.steps):
            self.world.step()

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.plank.position = self.rapier.Isometry3(ABOVE)
        self.plank.linvel = self.plank.angvel = self.rapier.Vec3.zeros()
