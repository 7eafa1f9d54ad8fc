"""A user's scene of SAPIEN, for ``tests.benchmarks.attach_cost``."""

from __future__ import annotations

from typing import Any

from stability_core.ports import attach
from tests.benchmarks.attached.side import ABOVE, FRAME_S, FRICTION, FROZEN, MASS, PARKED, SIZE, Side, place


class AttachedSapien(Side):
    """A user's scene of SAPIEN, with as many steps a frame as the suite's profile ``default``."""

    def __init__(self, steps: int) -> None:
        import sapien
        from sapien import physx

        self.sapien, self.physx, self.steps = sapien, physx, steps
        self.scene = sapien.Scene([physx.PhysxCpuSystem()])
        self.scene.set_timestep(FRAME_S / steps)
        self.material = physx.PhysxMaterial(FRICTION, FRICTION, 0.0)
        self.scene.add_ground(0, render=False, material=self.material)
        for index in range(FROZEN):
            self._add(place(index))
        self.plank = self._add(PARKED)
        self.falling = self.plank.entity.per_scene_id
        self.extension = attach(self.scene)
        self.build()

    def _add(self, position: tuple[float, ...]) -> Any:
        builder = self.scene.create_actor_builder()
        half = [edge / 2 for edge in SIZE]
        builder.add_box_collision(half_size=half, material=self.material, density=MASS / (SIZE[0] * SIZE[1] * SIZE[2]))
        entity = builder.build()
        entity.pose = self.sapien.Pose(position)
        return entity.find_component_by_type(self.physx.PhysxRigidDynamicComponent)

    def step(self) -> None:
        for _ in range(self.steps):
            self.scene.step()

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.plank.entity.pose = self.sapien.Pose(ABOVE)
        self.plank.linear_velocity = self.plank.angular_velocity = (0.0, 0.0, 0.0)
