"""Frames as sequences of substeps, with a record of the motions and forces that the core needs.

The core needs the approach speeds before the solver stops the bodies, and the mean forces of the frame. Most engines
report neither. Therefore ``SubstepSimulation`` records motions before each substep and forces after each substep, but
only while the port is in use and a body is live.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from adapters.base import Simulation
from adapters.profile import Profile, Sleeping
from adapters.shared.bodies import NO_FORCE
from adapters.shared.contact_forces import SubstepForces, mean_force
from scenarios.model import Brick, World
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions, fastest_approach
from stability_core.ports.shared.friction_forces import Borne, with_friction


class SubstepSimulation(Simulation):
    """A simulation that steps its engine by substeps, with the additional hooks ``_begin_frame`` to ``_end_frame``."""

    solver_noise: ClassVar[float] = 0.0
    """Margin [m/s] by which an approach must be faster to replace the approach of an earlier substep.

    The margin is needed, because the substeps of bodies at rest differ by the solver's noise: see ``fastest_approach``.
    """

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        self._substep_s = 0.0  # length of a substep of the latest frame
        self._recorded: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self._before: Motions | None = None
        self._earlier_forces: list[SubstepForces] = []  # of all substeps of the frame except the last
        super().__init__(profile, world, sleeping, expected)  # must come last, because it opens the engine's world

    def _step(self, seconds: float) -> None:
        self._substep_s = seconds / self.info.profile.substeps
        self._begin_frame(self._substep_s)
        is_read = self.is_observed and bool(self.bodies.live)
        bodies = self.bodies.moving()
        self._earlier_forces.clear()
        self._recorded.clear()
        for substep in range(self.info.profile.substeps):
            if is_read and substep:
                self._record_ended_substep()
            self._act_on_bodies(self._substep_s)
            if is_read:
                self._record_motions(bodies)
            self._substep()
        self._before = Motions(bodies, *map(np.stack, zip(*self._recorded, strict=True))) if self._recorded else None
        self._end_frame()

    # -- hooks, in the order in which a frame calls them -------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        """Prepare a frame of substeps of ``substep_s`` seconds.

        ``_step`` calls this hook once, before the first substep.
        """

    def _record_ended_substep(self) -> None:
        """Record the data of the ended substep for ``_contacts``.

        ``_step`` calls this hook after each substep except the last, if the port is in use and a body is live.
        """
        if self.reads_forces:
            self._earlier_forces.append(self._forces_of_substep())

    def _forces_of_substep(self) -> SubstepForces:
        """Return the contact forces of the ended substep, for pairs that touch a live body.

        The class calls this hook only if ``reads_forces`` is true, so that an engine without forces need not override
        it. The arrays must be copies.
        """
        raise NotImplementedError(
            f"{self.engine}: the capabilities state forces, but the adapter has no method _forces_of_substep; add this "
            "method"
        )

    def _record_motions(self, bodies: IntArray) -> None:
        """Record the motions of ``bodies`` (k,) before a substep.

        ``_step`` calls this method only if the port is in use and a body is live.
        """
        self._recorded.append(self._motions_now(bodies))

    def _motions_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return positions [m], velocities [m/s] and spins [rad/s] of ``bodies`` (k,), each of shape (k, 3).

        Override this hook for an engine that returns all three in one call.
        """
        return self._positions(bodies), *self.velocities_now(bodies)

    @abstractmethod
    def _substep(self) -> None:
        """Make one step of ``_substep_s`` seconds. The forces and the velocities of moved bodies are already set."""

    def _end_frame(self) -> None:
        """Finish a frame. ``_step`` calls this hook once, after the last substep and after it has set ``_before``."""

    # -- for _contacts -----------------------------------------------------------------------------

    def _contacts_of_step(
        self,
        pairs: tuple[IntArray, IntArray],
        point: FloatArray,
        normal: FloatArray,
        separation: FloatArray,
        force: FloatArray | None,
    ) -> Contacts:
        """Return the contacts of the latest step, with approach velocities and the mean forces of the frame.

        Args:
            pairs: bodies a and b, each of shape (n,).
            point: contact points [m], shape (n, 3).
            normal: unit normals from a to b, shape (n, 3).
            separation: gaps [m], negative in an overlap, shape (n,).
            force: forces [N] on bodies b in the last substep, shape (n, 3); None if the engine need not record forces.
        """
        if force is not None:
            force = mean_force(SubstepForces(*pairs, force), normal, self._earlier_forces)
        approach = fastest_approach(self._before, *pairs, point, normal, self.solver_noise)
        friction = self.pair_friction.of(*pairs)
        return Contacts(*pairs, point, normal, separation, approach, friction, force)

    def _motions_before(self) -> Motions | None:
        return self._before

    def _with_friction(self, contacts: Contacts) -> Contacts:
        """Add friction forces from the bodies' change of momentum, for an engine that reports normal forces only."""
        if contacts.force is None or self._before is None:
            return contacts
        borne = self._borne(self._before, self._substep_s * self.info.profile.substeps)
        pairs = contacts.body_a, contacts.body_b
        force = with_friction(pairs, contacts.point, contacts.normal, contacts.force, contacts.friction, borne)
        return replace(contacts, force=force)

    def _borne(self, before: Motions, seconds: float) -> Borne:
        """Return what the contacts of the live bodies bear, by their changed motion in the frame, without host forces.

        Args:
            before: motions in the frame, of which the first counts.
            seconds: length of the frame.
        """
        rows = np.flatnonzero([body in self.bodies.live for body in before.body.tolist()])
        live = before.body[rows]
        mass = np.array([self.bodies.live[body] for body in live.tolist()])
        steady = np.array([self.bodies.steady.get(body, NO_FORCE) for body in live.tolist()]).reshape(-1, 3)
        linear, angular = self._velocities(live)
        gained = (linear - before.linear[0, rows]) / seconds
        turned = (angular - before.angular[0, rows]) / seconds
        force = mass[:, None] * (gained - np.array(self.world.gravity)) - steady
        return Borne(live, force, self._positions(live), mass * np.linalg.norm(turned, axis=1))
