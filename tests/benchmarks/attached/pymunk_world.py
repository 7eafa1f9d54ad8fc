"""A user's space of pymunk with the planks of ``tests.benchmarks.attach_cost``."""

from __future__ import annotations

from typing import Any

import pymunk

from stability_core.ports import attach
from tests.benchmarks.attached.side import (
    ABOVE,
    FRAME_S,
    FRICTION,
    FROZEN,
    MASS,
    PARKED_IN_PLANE,
    SIZE,
    Side,
    place_in_plane,
)


class AttachedPymunk(Side):
    """A user's space of pymunk in millimetres, as in the suite's adapter, with one step a frame.

    The planks lie side by side, because the space is a plane. A landing plank lands on the first of them.
    """

    def __init__(self) -> None:
        self.space = pymunk.Space()
        self.space.gravity = 0.0, -9810.0
        floor = pymunk.Poly(self.space.static_body, [(-20000, -1000), (20000, -1000), (20000, 0), (-20000, 0)])
        floor.friction = FRICTION**0.5
        self.space.add(floor)
        for index in range(FROZEN):
            self._add(place_in_plane(index))
        self.plank = self._add(PARKED_IN_PLANE)
        self.extension = attach(self.space)
        self.falling = self.extension.id_of(self.plank)
        self.build()

    def _add(self, position: tuple[float, ...]) -> Any:
        width, height = 1e3 * SIZE[0], 1e3 * SIZE[2]
        body = pymunk.Body(MASS, pymunk.moment_for_box(MASS, (width, height)))
        body.position = 1e3 * position[0], 1e3 * position[2]
        shape = pymunk.Poly.create_box(body, (width, height))
        shape.friction = FRICTION**0.5
        self.space.add(body, shape)
        return body

    def step(self) -> None:
        self.space.step(FRAME_S)

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.plank.position, self.plank.angle = (1e3 * ABOVE[0], 1e3 * ABOVE[2]), 0.0
        self.plank.velocity, self.plank.angular_velocity = (0.0, 0.0), 0.0
