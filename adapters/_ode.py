"""ODE's QuickStep: projected Gauss-Seidel without warm starting, through the C API by ctypes and compiled code.

Library: the adapter loads Debian's ``libode8``, in double precision, if it is installed. Otherwise the adapter loads
the library in Panda3D's wheel, in single precision. The version in each record names the library (``_ode_library.py``).
The adapter does not use the exact solver, ``dWorldStep``, for two reasons. In single precision its errors end the
process, and its time grows with the cube of the number of contacts.

Freezing: the adapter stops and disables the body, so that ODE does not step it. A contact of a frozen body joins the
other body to the world. Otherwise ODE would enable the frozen body as soon as a contact joins it to a live body. A
kinematic body at rest also keeps its pose to the bit, but ODE steps it.

Contacts: ODE reports the contacts that the latest step solved, detected at the poses before that step. ODE lists
penetrating points only. The port adds the missing corners. ODE reports no approach speed, so that ``SubstepSimulation``
records the pose and the velocity of every live body before each substep. Forces are the feedback of the contact joints.

``find_contacts`` runs ODE's collision detection at the present poses. The call does not change later steps: the order
of ODE's space has no effect, because the adapter sorts contacts by their bodies.

Friction: each contact has the world's coefficient. The law is a pyramid (``dContactApprox1``) along two directions that
ODE chooses. On level faces these directions are the world's axes, so that along a diagonal friction holds up to 41 %
more.

Stiffness: a step corrects the fraction ``ERP`` of a penetration, and the bodies keep the speed of the correction. ODE
predicts no contacts, so that a falling brick penetrates by up to its travel in one step before ODE stops the brick.

Traps:

- QuickStep shuffles the constraints by a random generator that all worlds of the process share. Each world sets its
  own seed of the generator before a step, and stores the new seed after the step.
- As shipped, ODE pushes points apart until they no longer touch (``ContactSurfaceLayer`` 0), and the bodies then fall
  back.
- A state that is not finite ends the process by an assertion. If a position [m], speed [m/s] or spin [rad/s] of a live
  body reaches 1e12, the adapter stops stepping and reports NaN.
- The engine's own sleep does not end when the host removes a support.
- The default friction (without ``dContactApprox1``) has a force [N] as its bound, not a multiple of the normal force.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping

import numpy as np

from adapters._ode_knobs import KNOBS
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.live_pairs import of_live
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray

_SETTINGS = load_settings("ode", KNOBS.__contains__)


class OdeSimulation(SubstepSimulation):
    """One world of ODE."""

    engine = "ode"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "QuickStepNumIterations"
    solver_noise = 1e-4
    """Margin [m/s] of ``fastest_approach``. Without a margin the profile ``tuned`` reported 13 mm/s between a brick at
    rest and a platform that moved below the brick at 50 mm/s."""
    capabilities = Capabilities(
        contact_points="up to 8 points",
        near_contacts=False,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal and friction",
        freeze="disabled body, to which no contact is joined",
        frozen_contacts=False,
        friction_law="pyramid of 4 sides",
        moved="kinematic",
        deterministic="across processes",
    )

    @classmethod
    def check_installed(cls) -> None:
        """Raise ``ImportError`` if no usable library of ODE is installed."""
        importlib.import_module("adapters._ode_library")

    def _open(self) -> None:
        from adapters._ode_world import OdeWorld  # loads the library, without which this module can be read

        self._engine = OdeWorld(self.world, self.info.profile)
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs()

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._engine.place(body, position, quaternion)
        if body in self.bodies.live:
            self._wake(body)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        self._wake(body)
        _, _, linear, angular = self._engine.states(np.array([body]))
        after = linear[0] + np.array(impulse) / self.bricks[body].mass
        self._engine.set_velocity(body, tuple(after.tolist()), tuple(angular[0].tolist()))

    def _press(self, body: int, force: Vector) -> None:
        self._wake(body)
        self._engine.press(body, force)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        self._wake(body)
        self._engine.set_velocity(body, linear, angular)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)
        for body in self.bodies.live:
            self._wake(body)

    # -- time -----------------------------------------------------------------------------------------

    def _forces_of_substep(self) -> SubstepForces:
        contacts = self._engine.contacts
        return SubstepForces(*contacts.pairs, contacts.forces)

    def _substep(self) -> None:
        self._engine.step(self._substep_s, feedback=self.reads_forces)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        positions, quaternions, _, _ = self._engine.states(bodies)
        return positions, quaternions

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        _, _, linear, angular = self._engine.states(bodies)
        return linear, angular

    def _motions_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        positions, _, linear, angular = self._engine.states(bodies)
        return positions, *self.as_driven(bodies, linear, angular)

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._engine.freeze(body)

    def _unfreeze(self, body: int) -> None:
        self._engine.unfreeze(body)

    def _contacts(self) -> Contacts:
        contacts = self._engine.contacts
        force = contacts.forces if self.reads_forces else None
        return of_live(self._contacts_of_step(contacts.pairs, *contacts.geometry, force), self.bodies)

    def _find_contacts(self) -> Contacts:
        contacts = self._engine.contacts_now()
        return self._contacts_of_step(contacts.pairs, *contacts.geometry, None)

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _wake(self, body: int) -> None:
        """End the engine's own sleep of a body."""
        if self.info.sleeping != "off":
            self._engine.wake(body)
