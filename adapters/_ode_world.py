"""A world of ODE with the settings of a profile, and its bodies."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import numpy.typing as npt

from adapters._ode_contacts import ContactFinder
from adapters._ode_library import QUATERNION, REAL, Mass, lib, reals_at
from adapters.profile import KnobValue, Profile
from adapters.shared.bodies import NO_VELOCITY
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, FloatArray, IntArray

_POSITION, _QUATERNION, _LINEAR, _ANGULAR = slice(0, 3), slice(16, 20), slice(20, 23), slice(24, 27)
"""Columns of a body's state in ODE's memory. The rotation matrix has the columns between position and quaternion."""
_STATE = 28
"""Count of numbers in a body's state."""
_MOST = 1e12
"""Value of a position [m], speed [m/s] or spin [rad/s] from which a world counts as diverged. Squares of smaller values
are finite in single precision."""


class OdeWorld:
    """A world, with the handles of its bodies."""

    def __init__(self, world: World, profile: Profile) -> None:
        self._world: int = lib.dWorldCreate()
        self._space: int = lib.dSimpleSpaceCreate(0)  # of 100 bodies: pairs in 0.04 ms, in a hash space in 0.37 ms
        self._joints: int = lib.dJointGroupCreate(0)
        self._seed = 0
        self.has_diverged = False
        for name, value in profile.values.items():
            getattr(lib, f"dWorldSet{name}")(self._world, value)
        self._knobs = profile.values
        self._lowest = GROUND - len(world.fixed)
        self._states: dict[int, npt.NDArray[Any]] = {}
        self._geoms: dict[int, int] = {}
        self._is_live = np.zeros(64, np.bool_)
        self._joined = np.zeros(64, np.int64)  # handle of each body that contacts may move
        self.handles: dict[int, int] = {}
        """Handle of each body."""
        self.contacts = ContactFinder(world.friction)
        """Contacts of the latest step."""
        self._now = ContactFinder(world.friction)
        self.set_gravity(world.gravity)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed box, with the id ``body`` in contacts."""
        geom = self._add_geom(body, box)
        lib.dGeomSetPosition(geom, *box.position)
        lib.dGeomSetQuaternion(geom, QUATERNION(*box.quaternion))

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        self._add(body, brick)
        self._is_live[body] = True

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self._add(body, brick)
        lib.dBodySetKinematic(self.handles[body])

    def remove(self, body: int) -> None:
        """Remove a body."""
        del self._states[body]
        self._is_live[body], self._joined[body] = False, 0
        lib.dGeomDestroy(self._geoms.pop(body))
        lib.dBodyDestroy(self.handles.pop(body))

    def place(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a body, and stop the body."""
        handle = self.handles[body]
        lib.dBodySetPosition(handle, *position)
        lib.dBodySetQuaternion(handle, QUATERNION(*quaternion))
        self.set_velocity(body)

    def set_velocity(self, body: int, linear: Vector = NO_VELOCITY, angular: Vector = NO_VELOCITY) -> None:
        """Set the linear [m/s] and angular [rad/s] velocity of a body. The defaults stop the body."""
        handle = self.handles[body]
        lib.dBodySetLinearVel(handle, *linear)
        lib.dBodySetAngularVel(handle, *angular)

    def freeze(self, body: int) -> None:
        """Stop and disable a body, so that its contacts join the other body to the world."""
        self.set_velocity(body)
        lib.dBodyDisable(self.handles[body])
        self._is_live[body], self._joined[body] = False, 0

    def unfreeze(self, body: int) -> None:
        """Enable a frozen body again."""
        lib.dBodyEnable(self.handles[body])
        self._is_live[body], self._joined[body] = True, self.handles[body]

    def wake(self, body: int) -> None:
        """End the engine's own sleep of a live body."""
        lib.dBodyEnable(self.handles[body])

    def press(self, body: int, force: Vector) -> None:
        """Apply a force [N] at the centre of mass of a body in the next step."""
        lib.dBodyAddForce(self.handles[body], *force)

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow."""
        lib.dWorldSetGravity(self._world, *gravity)

    def step(self, seconds: float, *, feedback: bool) -> None:
        """Make one step, unless the world has diverged, because ODE would then end the process.

        Args:
            seconds: length of the step [s].
            feedback: True if ODE must record contact forces.
        """
        if self._diverges():
            return
        self.contacts.find(self._space, self._is_live, self._lowest)
        self.contacts.join(self._world, self._joints, self._joined, feedback=feedback)
        lib.dRandSetSeed(self._seed)
        lib.dWorldQuickStep(self._world, seconds)
        self._seed = lib.dRandGetSeed()
        lib.dJointGroupEmpty(self._joints)

    def contacts_now(self) -> ContactFinder:
        """Return the contacts at the present poses, without a step; the previous result if the world has diverged."""
        if not self._diverges():
            self._now.find(self._space, self._is_live, self._lowest)
        return self._now

    def states(self, bodies: IntArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return positions [m], quaternions (w, x, y, z), velocities [m/s] and spins [rad/s] of bodies (k,).

        All values are NaN if the world has diverged.
        """
        states = [self._states[body] for body in bodies.tolist()]
        rows = np.concatenate(states).astype(np.float64).reshape(-1, _STATE) if states else np.empty((0, _STATE))
        if self.has_diverged:
            rows[:] = np.nan
        return rows[:, _POSITION], rows[:, _QUATERNION], rows[:, _LINEAR], rows[:, _ANGULAR]

    def read_knobs(self) -> dict[str, KnobValue]:
        """Return the present values of the profile's knobs."""
        return {name: getattr(lib, f"dWorldGet{name}")(self._world) for name in self._knobs}

    def close(self) -> None:
        """Free the world."""
        self._states.clear()
        lib.dJointGroupDestroy(self._joints)
        lib.dSpaceDestroy(self._space)
        lib.dWorldDestroy(self._world)

    def _diverges(self) -> bool:
        """Return True if the world diverges now, or has diverged before."""
        live = [self._states[body] for body in np.flatnonzero(self._is_live).tolist()]
        if live and not (np.abs(np.concatenate(live)) < _MOST).all():
            self.has_diverged = True
        return self.has_diverged

    def _add(self, body: int, brick: Brick) -> None:
        handle: int = lib.dBodyCreate(self._world)
        mass = Mass()
        lib.dMassSetBoxTotal(ctypes.byref(mass), brick.mass, *brick.size)
        lib.dBodySetMass(handle, ctypes.byref(mass))
        lib.dGeomSetBody(self._add_geom(body, brick), handle)
        if body >= len(self._joined):
            self._is_live = np.concatenate([self._is_live, np.zeros_like(self._is_live)])
            self._joined = np.concatenate([self._joined, np.zeros_like(self._joined)])
        self.handles[body] = self._joined[body] = handle
        self._states[body] = _state_of(handle)
        self.place(body, brick.position, brick.quaternion)

    def _add_geom(self, body: int, box: Brick) -> int:
        geom: int = lib.dCreateBox(self._space, *box.size)
        lib.dGeomSetData(geom, body % 2**64)  # as an address: negative ids wrap around
        if body >= 0:
            self._geoms[body] = geom
        return geom


def _state_of(handle: int) -> npt.NDArray[Any]:
    """Return a view of a body's state in ODE's own memory, shape (28,).

    Raises:
        ImportError: if the library has another memory layout.
    """
    start = lib.dBodyGetPosition(handle)
    parts = (lib.dBodyGetQuaternion, lib.dBodyGetLinearVel, lib.dBodyGetAngularVel)
    places = [(part(handle) - start) // REAL.itemsize for part in parts]
    if places != [part.start for part in (_QUATERNION, _LINEAR, _ANGULAR)]:
        raise ImportError(
            f"ODE must have a body's state at the places 16, 20 and 24, got {places}; install libode.so.8, or the "
            "version of panda3d in uv.lock (uv sync --group ode)"
        )
    return reals_at(start, _STATE)
