"""``Simulation``: the world that the harness drives, with checks of bodies, poses and vectors for every engine.

An adapter implements the hooks of ``adapters.hooks``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar, Self

import numpy as np

from adapters.engines import engine_version
from adapters.hooks import EngineHooks
from adapters.port import EnginePort
from adapters.profile import Capabilities, EngineInfo, Knob, KnobValue, Profile, Sleeping
from adapters.shared.bodies import NO_FORCE, Bodies
from adapters.shared.contact_completion import fixed_id, prepare
from adapters.shared.ground import ground_box
from adapters.shared.input_checks import (
    check_body,
    check_finite,
    check_mass,
    check_pose,
    check_pose_in_plane,
    check_vector_in_plane,
)
from adapters.shared.pair_friction import PairFriction
from adapters.shared.refusals import check_capable
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, FloatArray, IntArray

__all__ = ["Capabilities", "EngineInfo", "EnginePort", "Knob", "Profile", "Simulation", "Sleeping"]


class Simulation(EngineHooks):
    """One world of one engine.

    A pose is the position [m] of a centre of mass and a quaternion (w, x, y, z). Every method may raise ``PeerError``
    on an engine in a separate process.
    """

    port_type: ClassVar[type[EnginePort]] = EnginePort

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        """Open a world with the ground and the fixed bodies only.

        Args:
            profile: settings of the engine.
            world: friction, restitution, gravity and fixed bodies.
            sleeping: mode of the engine's own sleeping: off, on (native), or on with a raised threshold.
            expected: the bricks that the host plans to spawn, for engines that must allocate in advance.
                An adapter may ignore this list, and must also accept other bricks.

        Raises:
            ValueError: if a fixed body is not valid, or a fixed body or gravity leaves the plane of a planar engine.
            NotImplementedError: if the adapter cannot build a fixed or an expected body, or lacks the world's
                restitution or the sleeping mode; the message gives the reason.
        """
        for body in world.fixed:
            check_body(body)
            self._check_pose_in_plane(body.position, body.quaternion)
        check_capable(self.engine, self.capabilities, world, (*world.fixed, *expected))
        self._check_vector_in_plane("gravity", world.gravity, "m/s2")
        self.world = world
        self.expected = tuple(expected)
        self._unfitted = profile
        profile = profile.with_knobs(self.sleep_knobs.get(sleeping, {})).fitted_to(expected)
        self.info = EngineInfo(self.engine, engine_version(self.engine), profile, sleeping)
        self.bodies = Bodies()
        self.bricks, self.frozen = self.bodies.bricks, self.bodies.frozen
        self.pair_friction = PairFriction(world)
        self._port = self.port_type(self)
        self._is_observed = False
        self.own_step_s: float | None = None
        """Wall time [s] of the engine's steps in the latest frame; None unless a separate process reports the time."""
        self._open()

    @classmethod
    def check_installed(cls) -> None:
        """Raise ``ImportError`` if the adapter loads, but the engine cannot open a world. By default, raise nothing."""

    # -- driven by the harness ---------------------------------------------------------------------

    @property
    def port(self) -> EnginePort:
        """Return the core's view of the simulation.

        The first access compiles the kernels. The engine need not record contact data before this access.
        """
        if not self._is_observed:
            self._is_observed = True
            prepare()
        return self._port

    @property
    def scale(self) -> float:
        """Return the profile's scale: a factor on the adapter's own lengths, for example on the size of the ground."""
        return self.info.profile.scale

    @property
    def is_observed(self) -> bool:
        """Return True after the first access to ``port``, because from then on the engine must record contact data."""
        return self._is_observed

    @property
    def reads_forces(self) -> bool:
        """Return whether the engine must record contact forces.

        True if ``port`` is in use, the engine reports forces, and ``Profile.forces`` is True.
        """
        return self.is_observed and self.info.profile.forces and self.capabilities.forces != "no"

    def spawn(self, brick: Brick) -> int:
        """Add a brick at rest to the world, live or moved by the host; return its id.

        Raises:
            ValueError: if a property of the brick is not valid, or the pose leaves the plane of a planar engine.
            NotImplementedError: if the adapter cannot build the brick; the message gives the reason.
        """
        check_mass(brick)
        check_body(brick)
        check_capable(self.engine, self.capabilities, self.world, (brick,))
        self._check_pose_in_plane(brick.position, brick.quaternion)
        body = self.bodies.new_id()
        (self._spawn_moved if brick.moved else self._spawn)(body, brick)
        self._port.add(body, brick)
        self.pair_friction.add(body, brick)
        self.bodies.add(body, brick)
        return body

    def remove(self, body: int) -> None:
        """Remove a body from the world.

        Raises:
            KeyError: if no body has this id.
        """
        self.bodies.check_known((body,))
        self._port.part_from_all(body)
        self._end_force(body)
        self._remove(body)
        self._port.remove(body)
        self.bodies.remove(body)

    def push(self, body: int, impulse: Vector) -> None:
        """Apply an impulse [N s] at the centre of mass of a live body; skip a frozen or moved body.

        Raises:
            KeyError: if no body has this id.
            ValueError: if the impulse is not finite, or leaves the plane of a planar engine.
        """
        self.bodies.check_known((body,))
        check_finite("impulse", impulse, "N s")
        self._check_vector_in_plane("an impulse", impulse, "N s")
        if body in self.bodies.live:
            self._push(body, impulse)

    def apply_force(self, body: int, force: Vector) -> None:
        """Set the steady force [N] at a body's centre of mass for all following steps.

        A force of zero ends the steady force. The force does not affect a moved body. The force affects a frozen body
        only when the body is live again.

        Raises:
            KeyError: if no body has this id.
            ValueError: if the force is not finite, or leaves the plane of a planar engine.
        """
        self.bodies.check_known((body,))
        check_finite("force", force, "N")
        self._check_vector_in_plane("a force", force, "N")
        if any(force):
            self.bodies.steady[body] = force
        else:
            self._end_force(body)

    def drive(self, body: int, linear: Vector, angular: Vector = (0.0, 0.0, 0.0)) -> None:
        """Set the velocity [m/s] and the spin [rad/s] of a body that the host moves, until the next call.

        Raises:
            KeyError: if no body has this id, or the host did not spawn the body with ``Brick.moved``.
            ValueError: if the velocities are not finite, or leave the plane of a planar engine.
        """
        if body not in self.bodies.moved:
            raise KeyError(
                f"drive() needs a body that the host moves, but body {body} is not among the moved bodies "
                f"{sorted(self.bodies.moved)}: pass the id of a moved body, or spawn the body as Brick(..., moved=True)"
            )
        if not (np.isfinite(linear).all() and np.isfinite(angular).all()):
            raise ValueError(
                f"velocities of body {body} must be finite, got {linear} m/s and {angular} rad/s; give finite numbers, "
                "and check for a division by zero"
            )
        if self.capabilities.planar and (linear[1] or angular[0] or angular[2]):
            raise ValueError(
                f"{self.engine} is planar: body {body} must have its velocity in the x-z plane and its spin along y, "
                f"got {linear} m/s and {angular} rad/s: set the other components to 0"
            )
        self.bodies.moved[body] = linear, angular

    def set_gravity(self, gravity: Vector) -> None:
        """Change gravity [m/s2] for all following steps, on live bodies and on bodies that become live later.

        Raises:
            ValueError: if gravity is not finite, or leaves the plane of a planar engine.
        """
        check_finite("gravity", gravity, "m/s2")
        self._check_vector_in_plane("gravity", gravity, "m/s2")
        self._set_gravity(gravity)
        self.world = replace(self.world, gravity=gravity)

    def move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set a body's pose, and stop the body. In the next step a moved body has the velocities of ``drive`` again.

        Raises:
            KeyError: if no body has this id.
            ValueError: if the position is not finite, the quaternion is not of unit length, or the pose leaves the
                plane of a planar engine.
        """
        self.bodies.check_known((body,))
        check_pose(position, quaternion)
        self._check_pose_in_plane(position, quaternion)
        self._port.part_from_all(body)
        self._move(body, position, quaternion)
        self._port.note_move(body)

    def step(self, seconds: float) -> None:
        """Advance the world by one frame of ``seconds``, in the profile's substeps."""
        self._port.forget_found()
        self._step(seconds)

    def solver_iterations(self) -> int | None:
        """Return the greatest number of solver iterations of any island in the latest engine step; None if unknown."""
        return self._solver_iterations()

    def find_contacts(self) -> None:
        """Detect the contacts of the present poses without moving anything.

        A host calls this method before the first step, so that the extension can judge stacks that start in place.
        Until the next step ``port.contacts()`` returns the contacts that this call detects:

        - A pair whose faces or parallel edges touch within 0.1 mm (for planks; in proportion to the size of other
          bricks) has the corners of its contact area. The corners come from the bricks' geometry
          (``BoxTable.with_exact_faces``), because at a gap of zero an engine may list no contact or a wrong normal.
        - Deeper overlaps and crossing edges have the contacts that the engine detects at the present poses.
        - Separations and relative velocities belong to the present poses and velocities. There are no forces,
          because no step has solved these contacts.
        - A later removal or move of a body deletes its contacts. A later new body has no contacts until the next step
          or call.

        The call changes no pose and no velocity by a bit. The simulation continues as without the call, unless the
        docstring of the adapter states an exception.
        """
        self._port.find_contacts()

    def poses(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Return ids (n,), positions (n, 3) [m] and quaternions (n, 4) of all live, frozen and moved bodies, by id."""
        bodies = self.bodies.ids()
        return bodies, *self._poses(bodies)

    def velocities(self) -> tuple[FloatArray, FloatArray]:
        """Return linear (n, 3) [m/s] and angular (n, 3) [rad/s] velocities, in the order of ``poses``.

        The rows of moved bodies depend on the engine. ``velocities_now`` returns the host's values for these bodies.
        """
        return self._velocities(self.bodies.ids())

    def read_knobs(self) -> Mapping[str, KnobValue]:
        """Return the engine's present values of the profile's knobs, by name, where its interface reports them.

        The engine reports knobs of bodies only after the host has spawned a body.
        """
        return self._read_knobs()

    def close(self) -> None:
        """Free the engine's memory. Call no other method afterwards."""
        self._close()

    def _check_vector_in_plane(self, quantity: str, value: Vector, unit: str) -> None:
        if self.capabilities.planar:
            check_vector_in_plane(self.engine, quantity, value, unit)

    def _check_pose_in_plane(self, position: Vector, quaternion: Quaternion) -> None:
        if self.capabilities.planar:
            check_pose_in_plane(self.engine, position, quaternion)

    def _end_force(self, body: int) -> None:
        """Delete a body's steady force, and end its effect in the engine if the body is live."""
        if self.bodies.steady.pop(body, None) and body in self.bodies.live:
            self._press(body, NO_FORCE)

    # -- for adapters ------------------------------------------------------------------------------

    def _fixed_boxes(self) -> Iterator[tuple[int, Brick]]:
        """Yield the ground, whose size grows with the scene, and the fixed bodies, each with its id in contacts."""
        middle = self.scale * self.info.profile.offset
        yield GROUND, ground_box((*self.expected, *self.world.fixed), self.scale, middle)
        for index, box in enumerate(self.world.fixed):
            yield fixed_id(index), box

    def _act_on_bodies(self, seconds: float) -> None:
        """Apply the steady forces and the velocities of moved bodies to the adapter's next step of ``seconds`` [s]."""
        for body, (linear, angular) in self.bodies.moved.items():
            self._drive(body, linear, angular, seconds)
        for body, force in self.bodies.steady.items():
            if body in self.bodies.live:
                self._press(body, force)

    def _twin(self) -> Self:
        """Open a second, weightless world of the engine: the same bodies under the same ids, at their present poses.

        All bodies are at rest in the second world, without joints and steady forces. The method serves engines that
        detect contacts only in a step, or whose state a query changes. The caller must close the second world.
        """
        twin = type(self)(self._unfitted, replace(self.world, gravity=(0.0, 0.0, 0.0)), "off", self.expected)
        positions, quaternions = self._poses(self.bodies.ids())
        places = zip(self.bricks.items(), positions.tolist(), quaternions.tolist(), strict=True)
        for (body, brick), (x, y, z), (w, i, j, k) in places:
            twin.bricks[body] = replace(brick, position=(x, y, z), quaternion=(w, i, j, k))
            if body in self.bodies.moved:
                twin._spawn_moved(body, twin.bricks[body])
            else:
                twin._spawn(body, twin.bricks[body])
            if body in self.frozen:
                twin._freeze(body)
        twin.bodies.frozen |= self.frozen
        twin.bodies.live.update(self.bodies.live)
        return twin
