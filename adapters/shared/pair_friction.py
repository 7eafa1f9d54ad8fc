"""Friction of pairs of bodies: the geometric mean of both coefficients, by the bodies' ids in contacts."""

from __future__ import annotations

import numpy as np

from adapters.shared.contact_completion import fixed_id
from scenarios.model import Brick, World
from scenarios.solids import friction_of
from stability_core.port import GROUND, FloatArray, IntArray


class PairFriction:
    """Coefficients of friction of the ground, the fixed bodies and the bodies of a world."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._first = len(world.fixed) + 1  # row of body 0, after the fixed bodies and the ground
        self._roots = np.full(self._first + 64, np.sqrt(world.friction))
        self.is_uniform = True
        """True while all coefficients equal the world's."""
        for index, body in enumerate(world.fixed):
            self.add(fixed_id(index), body)

    def add(self, body: int, brick: Brick) -> None:
        """Record the coefficient of a body, or of a fixed body by its id in contacts."""
        friction = friction_of(brick, self._world)
        if friction == self._world.friction:
            return
        self.is_uniform = False
        row = self._first + body
        if row >= len(self._roots):
            more = np.full(row, np.sqrt(self._world.friction))
            self._roots = np.concatenate([self._roots, more])
        self._roots[row] = np.sqrt(friction)

    def of(self, body_a: IntArray, body_b: IntArray) -> FloatArray:
        """Return the coefficients of pairs of ids, shape (n,)."""
        if self.is_uniform:
            return np.full(len(body_a), self._world.friction)
        friction: FloatArray = self._root(body_a) * self._root(body_b)
        return friction

    def _root(self, bodies: IntArray) -> FloatArray:
        rows = bodies + self._first
        known = rows < len(self._roots)
        return np.where(known, self._roots[np.where(known, rows, self._first + GROUND)], np.sqrt(self._world.friction))
