"""A simulation whose engine runs a world larger than the scene, because many engines suit bodies of a metre.

The profile's scale multiplies all lengths, velocities, impulses and forces, and gravity. Times, masses, angles and
friction do not change. Therefore the motion is the same, multiplied by the scale. This scaling is the recipe of
Bullet's wiki ("Scaling The World"), which does not change masses. The engine's absolute constants (slops, margins,
tolerances and speed thresholds) keep their values in the engine's units, so that their ratio to the bricks changes. Two
kinds of length grow with the bricks: a profile's lengths for the bricks' size (``Knob.follows_world``), and an
adapter's own lengths (``Simulation.scale``).

A profile's offset moves the scene along x, with the ground below it, as in a large level of a game. Far from the
origin, engines in single precision resolve positions coarsely (in steps of 7.6 um at 100 m).

The host and the port see SI units of the scene. The port adds missing corners in these units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import ClassVar

import numpy as np

from adapters.base import Simulation
from adapters.hooks import Pair
from adapters.port import EnginePort
from adapters.profile import KnobValue
from scenarios.model import Brick, Quaternion, Vector
from scenarios.solids import enlarged
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions


class _ScaledSimulation(Simulation):
    """Simulation of the scene that drives a larger simulation. A body has the same id in both simulations."""

    unscaled: ClassVar[type[Simulation]]

    def _open(self) -> None:
        bricks = [self._enlarged(brick) for brick in self.expected]
        fixed = tuple(self._enlarged(box) for box in self.world.fixed)
        larger = replace(self.world, gravity=_times(self.scale, self.world.gravity), fixed=fixed)
        self._larger = self.unscaled(self._unfitted, larger, self.info.sleeping, bricks)
        self.info = replace(self._larger.info, unit_scale=self._larger.info.unit_scale * self.scale)

    @property
    def port(self) -> EnginePort:
        """Return the core's view of the scene.

        The property also uses the port of the larger simulation, so that the engine records contact data.
        """
        _ = self._larger.port
        return super().port

    def _spawn(self, body: int, brick: Brick) -> None:  # noqa: ARG002 - both assign the same ids
        self._larger.spawn(self._enlarged(brick))

    _spawn_moved = _spawn

    def _remove(self, body: int) -> None:
        self._larger.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._larger.move(body, self._place(position), quaternion)

    def _push(self, body: int, impulse: Vector) -> None:
        self._larger.push(body, _times(self.scale, impulse))

    def _press(self, body: int, force: Vector) -> None:
        self._larger.apply_force(body, _times(self.scale, force))

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        self._larger.drive(body, _times(self.scale, linear), angular)

    def _set_gravity(self, gravity: Vector) -> None:
        self._larger.set_gravity(_times(self.scale, gravity))

    def _step(self, seconds: float) -> None:
        self._act_on_bodies(seconds)
        self._larger.step(seconds)
        self.own_step_s = self._larger.own_step_s

    def _solver_iterations(self) -> int | None:
        return self._larger._solver_iterations()

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        positions, quaternions = self._larger._poses(bodies)
        return self._places_in_scene(positions), quaternions

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._places_in_scene(self._larger._positions(bodies))

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        linear, angular = self._larger._velocities(bodies)
        return linear / self.scale, angular

    def _freeze(self, body: int) -> None:
        self._larger.port.sleep((body,))

    def _unfreeze(self, body: int) -> None:
        self._larger.port.wake((body,))

    def _join(self, pair: Pair) -> None:
        self._larger.port.join((pair,))

    def _part(self, pair: Pair) -> None:
        self._larger.port.part((pair,))

    def _contacts(self) -> Contacts:
        return self._in_scene(self._larger._contacts())

    def _motions_before(self) -> Motions | None:
        before = self._larger._motions_before()
        if before is None:
            return None
        return replace(before, position=self._places_in_scene(before.position), linear=before.linear / self.scale)

    def _find_contacts(self) -> Contacts:
        return self._in_scene(self._larger._find_contacts())

    def _close(self) -> None:
        self._larger.close()

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._larger.read_knobs()

    def _place(self, position: Vector) -> Vector:
        """Convert a position [m] in the scene to the position [m] in the larger world."""
        x, y, z = position
        return _times(self.scale, (x + self.info.profile.offset, y, z))

    def _places_in_scene(self, places: FloatArray) -> FloatArray:
        """Convert positions (n, 3) [m] in the larger world to positions [m] in the scene."""
        in_scene: FloatArray = places / self.scale - np.array([self.info.profile.offset, 0.0, 0.0])
        return in_scene

    def _enlarged(self, brick: Brick) -> Brick:
        """Return the brick in the larger world, with the same mass."""
        return replace(enlarged(brick, self.scale), position=self._place(brick.position))

    def _in_scene(self, seen: Contacts) -> Contacts:
        """Convert contacts of the larger world to the scene's frame and units."""
        return replace(
            seen,
            point=self._places_in_scene(seen.point),
            separation=seen.separation / self.scale,
            relative_velocity=seen.relative_velocity / self.scale,
            force=None if seen.force is None else seen.force / self.scale,
        )


@cache
def scaled(simulation: type[Simulation]) -> type[Simulation]:
    """Return a class whose simulations drive larger worlds of the same engine, with the profile's scale and offset."""

    class Scaled(_ScaledSimulation):
        engine = simulation.engine
        capabilities = simulation.capabilities
        profiles = simulation.profiles
        unscaled = simulation

    return Scaled


def _times(scale: float, vector: Vector) -> Vector:
    x, y, z = vector
    return scale * x, scale * y, scale * z
