"""``ReferenceSimulation``: the hooks that both reference engines share. A subclass solves the contacts of a step.

Freezing: a frozen box is a fixed box. Nothing changes its pose, and the contact problem has no unknowns for this box.

Contacts: ``_contacts`` detects the contacts at the present poses. A force of the latest step belongs to the nearest
present point of the same pair.

Divergence: no step leads from a state that is not finite back to a finite state. In such a state the adapter makes no
step, and reports all poses as NaN.
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from adapters.reference.boxes import FIXED, LIVE, MOVED, BoxArrays
from adapters.reference.contact_rows import EARTH, ContactRows, contact_rows, set_velocities
from adapters.reference.detector import BoxDetector, FoundContacts
from adapters.reference.impulse_matching import moved_to
from adapters.reference.motion import advance, displace
from adapters.shared.contact_forces import SubstepForces
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray


class ReferenceSimulation(SubstepSimulation):
    """One world of a reference engine."""

    @abstractmethod
    def _solve(self, problem: ContactRows, found: FoundContacts) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the solution of a step's contact problem.

        Returns:
            Three arrays:

            - the scaled velocities (m, 6) after the contacts;
            - the impulses (n, 3) along the rows, in units of ``problem.impulse_unit``;
            - the corrections of the poses (m, 6), as scaled velocities that act for one step.
        """

    def _open(self) -> None:
        self._boxes = BoxArrays(len(self.world.fixed))
        self._detector = BoxDetector(self.scale)
        self._gravity = np.array(self.world.gravity, np.float64)
        self._solved: tuple[FoundContacts, FloatArray] | None = None  # contacts and impulses [N s] of the latest step
        for body, box in self._fixed_boxes():
            self._boxes.add(body, box, FIXED)
        self._prepare()

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._boxes.add(body, brick, LIVE)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._boxes.add(body, brick, MOVED)

    def _remove(self, body: int) -> None:
        self._boxes.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._boxes.place(body, position, quaternion)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        row = body + self._boxes.first
        self._boxes.velocity[row] += np.array(impulse) / self._boxes.mass[row]

    def _press(self, body: int, force: Vector) -> None:
        self._boxes.force[body + self._boxes.first] = force

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        row = body + self._boxes.first
        self._boxes.velocity[row], self._boxes.spin[row] = linear, angular

    def _set_gravity(self, gravity: Vector) -> None:
        self._gravity = np.array(gravity, np.float64)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:  # noqa: ARG002
        self._solved = None

    def _forces_of_substep(self) -> SubstepForces:
        if self._solved is None:
            return SubstepForces(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)))
        found, impulse = self._solved
        first = self._boxes.first
        return SubstepForces(found.row_a - first, found.row_b - first, impulse / self._substep_s)

    def _substep(self) -> None:
        if not self._boxes.is_finite():
            return
        if self.bodies.live:
            self._solve_contacts(self._substep_s)
        advance(self._boxes, self._substep_s)

    def _solve_contacts(self, seconds: float) -> None:
        """Set the velocities after the contacts of a step, and correct the poses."""
        boxes = self._boxes
        found = self._detector.find(boxes, self._gravity, seconds)
        problem = contact_rows(boxes, found, self._gravity, seconds, EARTH * self.scale * seconds)
        scaled, impulse, correction = self._solve(problem, found)
        self._solved = found, (impulse[:, :, None] * problem.axes).sum(axis=1) * problem.impulse_unit
        if correction.any():
            set_velocities(boxes, problem, correction)
            shift, turn = boxes.velocity[problem.rows] * seconds, boxes.spin[problem.rows] * seconds
            displace(boxes, problem.rows, shift, turn)
        set_velocities(boxes, problem, scaled)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._boxes.rows(bodies)
        position, quaternion = self._boxes.position[rows], self._boxes.quaternion[rows]
        if not self._boxes.is_finite():
            position[:], quaternion[:] = np.nan, np.nan
        return position, quaternion

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._boxes.position[self._boxes.rows(bodies)]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._boxes.rows(bodies)
        return self._boxes.velocity[rows], self._boxes.spin[rows]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._boxes.set_state(body, FIXED)

    def _unfreeze(self, body: int) -> None:
        self._boxes.set_state(body, LIVE)

    def _contacts(self) -> Contacts:
        found = self._detector.find(self._boxes, self._gravity, 0.0)
        force = None
        if self.reads_forces and self._solved is not None:
            force = moved_to(found, *self._solved) / self._substep_s
        first = self._boxes.first
        pairs = found.row_a - first, found.row_b - first
        return self._contacts_of_step(pairs, found.point, found.normal, found.gap, force)

    _find_contacts = _contacts

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._boxes = BoxArrays(0)

    # -- helpers --------------------------------------------------------------------------------------

    def _prepare(self) -> None:
        """Compile the kernels, or load the kernels from the cache, before the first timed frame."""
        held = self._boxes
        self._boxes = BoxArrays(0)
        self._boxes.add(-1, Brick((1.0, 1.0, 1.0), 1.0, (0.0, 0.0, -0.5)), FIXED)
        for body in range(2):
            self._boxes.add(body, Brick((1.0, 1.0, 1.0), 1.0, (0.0, 0.0, 0.4995 + body)), LIVE)
        for _ in range(2):
            self._solve_contacts(1 / 60)
            advance(self._boxes, 1 / 60)
        self._solved = None
        self._boxes = held
