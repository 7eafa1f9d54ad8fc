"""A world of Chipmunk with the settings of a profile, and its bodies."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from adapters._pymunk_plane import UNITS_PER_METRE, in_plane, moment, outline, planar_gravity
from adapters.profile import Profile
from scenarios.model import Brick, Quaternion, Vector, World
from scenarios.shapes import Polyhedron
from scenarios.solids import friction_of, restitution_of
from stability_core.port import GROUND, FloatArray
from stability_core.ports.pymunk_calls import forget_pairs, freeze, halt, unfreeze
from stability_core.ports.pymunk_reader import SpaceReader

MIN_GROUND_WIDTH = 20.0
"""Least width [m] of the ground, so that all scenes but the largest have the same ground. Chipmunk clips a brick by the
ends of the ground. Therefore the last bits of all contacts depend on the width."""


class PymunkWorld:
    """A world, with its bodies, the reader of their states, and their depths along y, which a planar engine ignores."""

    def __init__(self, world: World, profile: Profile) -> None:
        self.space = pymunk.Space()
        self.set_gravity(world.gravity)
        for setting, value in profile.values.items():
            setattr(self.space, setting, value)
        self.bodies: dict[int, pymunk.Body] = {}
        """Chipmunk's object of each body, without the ground and the fixed bodies."""
        self.fixed_rows = 1 + len(world.fixed)
        """Number of rows of the ground and the fixed bodies. These rows come last, so that negative ids select them."""
        self.reader = SpaceReader(self.space, self.fixed_rows)
        self.depths = np.full(self.fixed_rows, np.inf)
        """Extents along y [m], by the rows of ``reader``."""
        self._world = world
        self._min_ground_width = MIN_GROUND_WIDTH * profile.scale
        self._new_statics: list[int] = []

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow."""
        self.space.gravity = planar_gravity(gravity)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts."""
        length, depth, height = box.size
        if body == GROUND:
            length, depth = max(length, self._min_ground_width), np.inf
        self._add(body, pymunk.Body(body_type=pymunk.Body.STATIC), box, (length, depth, height))

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        self._add_body(body, brick, pymunk.Body(brick.mass, moment(brick)))

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self._add_body(body, brick, pymunk.Body(body_type=pymunk.Body.KINEMATIC))

    def remove(self, body: int) -> None:
        """Remove a body."""
        planar = self.bodies.pop(body)
        self.space.remove(*planar.shapes, planar)
        self.reader.remove(body)

    def move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a body ([m], quaternion w, x, y, z), and stop the body."""
        planar = self.bodies[body]
        planar.position, planar.angle = in_plane(position, quaternion)
        halt(planar)
        self.space.reindex_shapes_for_body(planar)
        self.reader.note_change()

    def freeze(self, body: int) -> None:
        """Stop a body, and make it static."""
        freeze(self.bodies[body])
        self._new_statics.append(body)
        self.reader.note_change()

    def unfreeze(self, body: int, brick: Brick) -> None:
        """Make a static body dynamic again, and set its mass and moment of inertia, which Chipmunk has dropped."""
        unfreeze(self.bodies[body], brick.mass, moment(brick))

    def forget_static_pairs(self) -> None:
        """Delete the arbiters of newly frozen bodies, because Chipmunk would keep and list these arbiters.

        The next step detects the contacts of these bodies with live bodies again.
        """
        for body in self._new_statics:
            planar = self.bodies.get(body)
            if planar is not None and planar.body_type == pymunk.Body.STATIC:
                forget_pairs(self.space, planar)
        self._new_statics.clear()

    def step(self, seconds: float) -> None:
        """Make one step of ``seconds`` [s]."""
        self.space.step(seconds)
        self.reader.note_change()

    def close(self) -> None:
        """Free the world."""
        self.bodies.clear()
        del self.space, self.reader

    def _add_body(self, body: int, brick: Brick, planar: pymunk.Body) -> None:
        self._add(body, planar, brick, brick.size)
        self.bodies[body] = planar

    def _add(self, body: int, planar: pymunk.Body, box: Brick, size: Vector) -> None:
        """Add the engine's body ``planar`` for a brick with edges ``size`` [m], with the id ``body`` in contacts."""
        length, depth, height = size
        planar.position, planar.angle = in_plane(box.position, box.quaternion)
        if box.shape == "sphere":
            shape: pymunk.Shape = pymunk.Circle(planar, length / 2 * UNITS_PER_METRE)
            depth = 0.0
        elif isinstance(box.shape, Polyhedron):
            corners, depth = outline(box.shape)
            shape = pymunk.Poly(planar, corners)
        else:
            shape = pymunk.Poly.create_box(planar, (length * UNITS_PER_METRE, height * UNITS_PER_METRE))
        # The coefficients of a pair are the products of both shapes'.
        shape.friction = math.sqrt(friction_of(box, self._world))
        shape.elasticity = math.sqrt(restitution_of(box, self._world))
        self.space.add(planar, shape)
        self.reader.add(planar, body)
        self.depths = self._longer(self.depths)
        self.depths[body] = depth

    def _longer(self, depths: FloatArray) -> FloatArray:
        """Return the depths [m] with as many rows as the reader has, infinite in a row without a body."""
        longer = np.full(self.reader.rows, np.inf)
        bodies = len(depths) - self.fixed_rows
        longer[:bodies] = depths[:bodies]
        longer[-self.fixed_rows :] = depths[-self.fixed_rows :]
        return longer
