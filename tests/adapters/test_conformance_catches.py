"""The checks are worth something only if they fail on a wrong adapter: each is shown adapters broken in one way."""

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pybullet
import pytest

from adapters._bullet import BulletSimulation
from adapters.conformance import CHECKS
from adapters.hooks import EngineHooks
from adapters.port import EnginePort
from adapters.profile import Knob, Profile, Sleeping
from adapters.shared.contact_completion import BoxTable
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses
from stability_core.ports.shared.approach import Motions
from tests.adapters.broken import assert_caught

ELSEWHERE = ("adapters.conformance.shapes", "adapters.conformance.welds")
"""Checks of ``test_conformance_shapes`` and ``test_conformance_welds``."""
CHECK = {check.name: check for check in CHECKS if check.measure.__module__ not in ELSEWHERE}


NOT_COMPLETED = replace(BulletSimulation.capabilities, near_contacts=True)
"""Claims to list what nearly touches, so that the port adds nothing."""


class OtherSettings(BulletSimulation):
    """Its engine has another value than the profile."""

    def _read_knobs(self) -> dict[str, float | int | str | bool]:
        return {"contactERP": 1.01 * float(self.info.profile.values["contactERP"])}


class FlippedNormals(BulletSimulation):
    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, normal=-contacts.normal)


class SwappedVelocity(BulletSimulation):
    """Velocity of a against b."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, relative_velocity=-contacts.relative_velocity)


class VelocityAfterSolve(BulletSimulation):
    def _step(self, seconds: float) -> None:
        super()._step(seconds)
        bodies = self.bodies.live_rows()[0]
        self._before = Motions(bodies, self._positions(bodies)[None], *(v[None] for v in self._velocities(bodies)))


class VelocityAfterGravity(BulletSimulation):
    def _step(self, seconds: float) -> None:
        super()._step(seconds)
        if self._before is not None:
            gravity = np.array(self.world.gravity) * seconds / self.info.profile.substeps
            self._before = replace(self._before, linear=self._before.linear + gravity)


class PointsInMillimetres(BulletSimulation):
    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, point=1000 * contacts.point)


class OnePointAPair(BulletSimulation):
    capabilities = NOT_COMPLETED

    def _listed(self) -> list[tuple[Any, ...]]:
        return list({pair[:2]: pair for pair in super()._listed()}.values())


class PenetratingPointsOnly(BulletSimulation):
    """Tuned, so that a brick penetrates by micrometres only, and stands on fewer corners."""

    capabilities = NOT_COMPLETED

    def __init__(self, _profile: Profile, *args: Any) -> None:
        super().__init__(BulletSimulation.profiles["tuned"], *args)


class PositiveOverlap(BulletSimulation):
    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, separation=-contacts.separation)


class FrictionOfOneBody(BulletSimulation):
    """Reports the square root of the pair's coefficient."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, friction=np.sqrt(contacts.friction))


class ForcesOnTheOther(BulletSimulation):
    """Forces on body a."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, force=None if contacts.force is None else -contacts.force)


class ForcesOfOneSubstep(BulletSimulation):
    """Impulses of one of two substeps over the whole frame's time."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, force=None if contacts.force is None else contacts.force / 2)


class ForcesWithoutFriction(BulletSimulation):
    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, force=None if contacts.force is None else contacts.force * (0.0, 0.0, 1.0))


class ForcesThatCancel(BulletSimulation):
    """Neighbouring contacts pull against each other, beyond their friction; in sum nothing changes."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        if contacts.force is None or len(contacts) < 2:
            return contacts
        force = contacts.force.copy()
        pair = np.flatnonzero((contacts.body_a == contacts.body_a[0]) & (contacts.body_b == contacts.body_b[0]))[:2]
        force[pair, 1] += np.array([0.06, -0.06])[: len(pair)]
        return replace(contacts, force=force)


class ForcesAcrossGaps(BulletSimulation):
    """Bodies bear load a fifth of a millimetre before they touch."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, separation=contacts.separation + 0.2e-3)


class ForceForOneStep(BulletSimulation):
    """A blow: the force acts in the first step only."""

    def apply_force(self, body: int, force: Vector) -> None:
        super().apply_force(body, force)
        self._press(body, force)
        self.bodies.steady.clear()


class GravityAsBefore(BulletSimulation):
    def _set_gravity(self, gravity: Vector) -> None: ...


class PushedAside(BulletSimulation):
    """A moved body that gives way, and that slides below what lies on it."""

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        super()._drive(body, linear, angular, seconds)
        pybullet.changeDynamics(self._handles[body], -1, lateralFriction=0.0, physicsClientId=self._client)
        x, y, z = linear
        pybullet.resetBaseVelocity(self._handles[body], (x, y, 0.9 * z), angular, self._client)


class MovedBodyGluesItsLoad(BulletSimulation):
    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        super()._drive(body, linear, angular, seconds)
        pybullet.changeDynamics(self._handles[body], -1, lateralFriction=2.0, physicsClientId=self._client)


class MovedBodyNotListed(EnginePort):
    def masses(self) -> Masses:
        masses = super().masses()
        return Masses(masses.body[np.isfinite(masses.mass)], masses.mass, masses.center_of_mass, masses.removed)


class DrivenUnseenByFrozen(EnginePort):
    def _with_driven(self, contacts: Contacts, driven: list[int]) -> Contacts:
        return contacts


class DrivenStoppedByFrozen(BulletSimulation):
    """Lets the solver see a moved body against frozen bricks, and remember the impulses that stopped it."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        let_collide = self._engine.let_collide

        def let_frozen_collide(handle: int, other: int, *, do: bool) -> None:
            if do or other not in {self._handles[body] for body in self.bodies.live}:
                let_collide(handle, other, do=do)

        self._engine.let_collide = let_frozen_collide


class NothingAhead(EnginePort):
    def _with_approaching(self, contacts: Contacts) -> Contacts:
        return contacts


class EverythingAhead(EnginePort):
    """Sweeps boxes three times as large."""

    def __init__(self, engine: EngineHooks) -> None:
        super().__init__(engine)
        self._boxes = LargerBoxes()


class LargerBoxes(BoxTable):
    def add(self, body: int, size: Vector) -> None:
        x, y, z = size
        super().add(body, (3 * x, 3 * y, 3 * z))


class ForcesFoundWithoutAStep(EnginePort):
    def find_contacts(self) -> None:
        super().find_contacts()
        if self._found is not None:
            self._found = replace(self._found, force=np.zeros(self._found.point.shape))


class NoContactsWithFrozen(BulletSimulation):
    capabilities = NOT_COMPLETED

    def _listed(self) -> list[tuple[Any, ...]]:
        return [pair for pair in super()._listed() if not {*pair[:2]} & self.frozen]


class FrozenPairsListed(BulletSimulation):
    def _listed(self) -> list[tuple[Any, ...]]:
        every = pybullet.getContactPoints(physicsClientId=self._client)
        return [(self._engine.body_of[row[1]], self._engine.body_of[row[2]], row) for row in every]


class FlickeringContacts(BulletSimulation):
    capabilities = NOT_COMPLETED

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._frame = itertools.count()

    def _listed(self) -> list[tuple[Any, ...]]:
        return [] if next(self._frame) % 7 == 6 else super()._listed()


class ChangedBricks(BulletSimulation):
    """Every body gets one more property."""

    change: dict[str, float]

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._change_all()

    def _spawn(self, *args: Any) -> None:
        super()._spawn(*args)
        self._change_all()

    def _spawn_moved(self, *args: Any) -> None:
        super()._spawn_moved(*args)
        self._change_all()

    def _change_all(self) -> None:
        for handle in self._engine.body_of:
            pybullet.changeDynamics(handle, -1, **self.change, physicsClientId=self._client)


class FrictionSquared(ChangedBricks):
    change = {"lateralFriction": 0.45}  # noqa: RUF012


class FrictionRooted(ChangedBricks):
    change = {"lateralFriction": 0.45**0.25}  # noqa: RUF012


class Frictionless(ChangedBricks):
    change = {"lateralFriction": 0.0}  # noqa: RUF012


class Damped(ChangedBricks):
    change = {"linearDamping": 0.04}  # noqa: RUF012


class Bouncing(ChangedBricks):
    change = {"restitution": 0.7}  # noqa: RUF012


class Sleepy(BulletSimulation):
    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, "native", expected)


class SlowToRecover(BulletSimulation):
    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        knobs = {**profile.knobs, "contactERP": Knob(0.01, "recovers too slowly")}
        super().__init__(replace(profile, knobs=knobs), world, sleeping, expected)


class DriftingFreeze(BulletSimulation):
    def _step(self, seconds: float) -> None:
        super()._step(seconds)
        for body in self.frozen:
            (x, y, z), turn = pybullet.getBasePositionAndOrientation(self._handles[body], self._client)
            pybullet.resetBasePositionAndOrientation(self._handles[body], (x, y, z + 1e-12), turn, self._client)


class MerelyAsleep(BulletSimulation):
    """The engine's own sleep, which the next touch ends."""

    def _freeze(self, body: int) -> None:
        self._engine.stop(self._handles[body])
        asleep = pybullet.ACTIVATION_STATE_SLEEP
        pybullet.changeDynamics(self._handles[body], -1, activationState=asleep, physicsClientId=self._client)


class SpeedKeptThroughFreeze(BulletSimulation):
    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._kept: dict[int, Any] = {}

    def _freeze(self, body: int) -> None:
        self._kept[body] = pybullet.getBaseVelocity(self._handles[body], self._client)
        super()._freeze(body)

    def _unfreeze(self, body: int) -> None:
        super()._unfreeze(body)
        pybullet.resetBaseVelocity(self._handles[body], *self._kept.pop(body), self._client)


class MassLostOnWaking(BulletSimulation):
    def _unfreeze(self, body: int) -> None:
        super()._unfreeze(body)
        pybullet.changeDynamics(self._handles[body], -1, mass=1.0, physicsClientId=self._client)


class InertiaLostOnWaking(BulletSimulation):
    def _unfreeze(self, body: int) -> None:
        super()._unfreeze(body)
        inertia = (1e-5, 2e-5, 1e-5)
        pybullet.changeDynamics(self._handles[body], -1, localInertiaDiagonal=inertia, physicsClientId=self._client)


class NeverWakes(BulletSimulation):
    def _unfreeze(self, body: int) -> None:
        pass


class GhostLeftBehind(BulletSimulation):
    """A removed brick goes on stopping others."""

    def _remove(self, body: int) -> None:
        self._handles.pop(body)


class ContactsOutliveTheirBricks(BulletSimulation):
    """Contacts are those of the latest step, whatever was removed since."""

    def _step(self, seconds: float) -> None:
        super()._step(seconds)
        self._stepped = super()._contacts()

    def _contacts(self) -> Contacts:
        return self._stepped


class MoveIgnored(BulletSimulation):
    def _move(self, body: int, *args: Any) -> None:
        self._engine.stop(self._handles[body])


class QuaternionsAsInBullet(BulletSimulation):
    """(x, y, z, w)."""

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        positions, quaternions = super()._poses(bodies)
        return positions, np.roll(quaternions, -1, axis=1)


class RemovalToldTwice(EnginePort):
    def masses(self) -> Masses:
        masses = super().masses()
        self._bodies._removed = list(masses.removed)
        return masses


class WithoutFixedBoxes(BulletSimulation):
    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, replace(world, fixed=()), sleeping, expected)


class FlippedNormalsOfFixedBoxes(BulletSimulation):
    """The ground's own are right."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        of_fixed = np.minimum(contacts.body_a, contacts.body_b) < GROUND
        return replace(contacts, normal=np.where(of_fixed[:, None], -contacts.normal, contacts.normal))


class FixedBoxesTooSmooth(BulletSimulation):
    """Their material has the pair's coefficient; Bullet multiplies it by the brick's."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        for handle, body in self._engine.body_of.items():
            if body < GROUND:
                friction = self.world.friction
                pybullet.changeDynamics(handle, -1, lateralFriction=friction, physicsClientId=self._client)


class FixedBoxesAside(BulletSimulation):
    """Off by a tenth of a brick's length, as if a corner were meant for the centre."""

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        moved = [replace(box, position=tuple(np.add(box.position, (0.0117, 0.0, 0.0)))) for box in world.fixed]
        super().__init__(profile, replace(world, fixed=tuple(moved)), sleeping, expected)


class Shaken(BulletSimulation):
    """Every world differs from the one before by a hair."""

    _worlds = itertools.count()

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        pybullet.setGravity(0.0, 1e-9 * next(self._worlds), -9.81, self._client)


class DisturbedByReading(BulletSimulation):
    """The engine solves its contacts less well in a world that is read."""

    def _step(self, seconds: float) -> None:
        if self.is_observed:
            pybullet.setPhysicsEngineParameter(numSolverIterations=1, physicsClientId=self._client)
        super()._step(seconds)


class FoundNormalsUpright(EnginePort):
    def _with_exact_faces(self, contacts: Contacts) -> Contacts:
        contacts = super()._with_exact_faces(contacts)
        return replace(contacts, normal=np.tile((0.0, 0.0, 1.0), (len(contacts), 1)))


class StepsToFind(BulletSimulation):
    """Finds contacts by a step and goes on from there."""

    def _find_contacts(self) -> Contacts:
        pybullet.stepSimulation(self._client)
        return self._contacts()


class FindsThoseOfTheStep(BulletSimulation):
    """Returns the contacts of the latest step, wherever the bricks are now."""

    def _find_contacts(self) -> Contacts:
        return self._contacts()


class LeavesFacesToTheEngine(EnginePort):
    """Leaves gaps of exactly zero to the engine."""

    def _with_exact_faces(self, contacts: Contacts) -> Contacts:
        return contacts


class FoundNormalsFlipped(EnginePort):
    def _with_exact_faces(self, contacts: Contacts) -> Contacts:
        found = super()._with_exact_faces(contacts)
        return replace(found, normal=-found.normal)


class FoundAtRest(EnginePort):
    def _velocities_at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        return np.zeros(points.shape)


class FoundContactsStay(EnginePort):
    """Contacts that were found outlive the next step."""

    def forget_found(self) -> None:
        pass


class FoundContactsOutliveTheirBricks(EnginePort):
    def _of_live(self, contacts: Contacts) -> Contacts:
        return contacts


class SmoothOnceAsked(BulletSimulation):
    """Finding contacts takes the bricks' friction away, and gravity leans."""

    def _find_contacts(self) -> Contacts:
        found = super()._find_contacts()
        pybullet.setGravity(0.1, 0.0, -9.81, self._client)
        for handle in self._handles.values():
            pybullet.changeDynamics(handle, -1, lateralFriction=0.0, physicsClientId=self._client)
        return found


class ClaimsToBePlanar(BulletSimulation):
    """Goes round the checks that all planar engines share."""

    capabilities = replace(BulletSimulation.capabilities, planar=True)

    def _check_vector_in_plane(self, quantity: str, value: Vector, unit: str) -> None:
        pass

    def _check_pose_in_plane(self, position: Vector, quaternion: Quaternion) -> None:
        pass


class FacesCalledEdges(BulletSimulation):
    capabilities = replace(BulletSimulation.capabilities, ridge_normal="edge")


class ForcesAgainstItsWord(BulletSimulation):
    capabilities = replace(BulletSimulation.capabilities, forces="no")

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, force=np.zeros(contacts.point.shape))


class FoundFacesOfTheEngine(OnePointAPair):
    port_type = LeavesFacesToTheEngine


BROKEN: list[tuple[type[BulletSimulation | EnginePort], list[str]]] = [
    (
        FlippedNormals,
        [
            "reports_a_resting_brick",
            "reports_the_speed_of_impact",
            "finds_an_overlap",
        ],
    ),
    (FoundNormalsFlipped, ["finds_the_contacts_of_a_tower", "finds_contacts_with_fixed_boxes"]),
    (FoundNormalsUpright, ["finds_the_contacts_of_an_inverted_v", "finds_contacts_with_fixed_boxes"]),
    (StepsToFind, ["finds_the_contacts_of_a_tower", "finds_contacts_among_moving_and_frozen_bricks"]),
    (FindsThoseOfTheStep, ["finds_contacts_among_moving_and_frozen_bricks"]),
    (FoundFacesOfTheEngine, ["finds_the_contacts_of_a_tower", "finds_the_contacts_of_an_inverted_v"]),
    (FoundAtRest, ["finds_contacts_among_moving_and_frozen_bricks"]),
    (FoundContactsStay, ["forgets_found_contacts_with_the_next_step"]),
    (FoundContactsOutliveTheirBricks, ["finds_contacts_among_moving_and_frozen_bricks"]),
    (SmoothOnceAsked, ["stands_as_if_never_asked"]),
    (SwappedVelocity, ["reports_the_speed_of_impact"]),
    (VelocityAfterSolve, ["reports_the_speed_of_impact", "shows_pushes_against_a_frozen_brick"]),
    (VelocityAfterGravity, ["reports_a_resting_brick_in_every_frame"]),
    (PointsInMillimetres, ["reports_a_resting_brick", "finds_an_overlap"]),
    (OnePointAPair, ["reports_a_resting_brick"]),
    (PenetratingPointsOnly, ["reports_whole_faces_on_uneven_supports", "reports_a_support_a_hair_below"]),
    (PositiveOverlap, ["reports_the_overlap", "finds_an_overlap"]),
    (FrictionOfOneBody, ["reports_a_resting_brick", "finds_an_overlap"]),
    (NoContactsWithFrozen, ["reports_every_pair", "reports_a_resting_brick", "seats_on_frozen_bricks"]),
    (FrozenPairsListed, ["reports_every_pair"]),
    (FlickeringContacts, ["reports_a_resting_brick_in_every_frame"]),
    (
        FrictionSquared,
        [
            "slides_on_the_ground_above_the_friction_angle",
            "slides_on_a_frozen_brick_above_the_friction_angle",
            "slides_sideways_above_the_friction_angle",
            "is_braked_by_friction_between_live_bricks",
        ],
    ),
    (
        FrictionRooted,
        ["slides_on_the_ground_above_the_friction_angle", "is_braked_by_friction_between_live_bricks"],
    ),
    (Frictionless, ["holds_an_inverted_v", "slides_on_the_ground_above_the_friction_angle"]),
    (Damped, ["falls_freely", "moves_by_impulse_over_mass"]),
    (Bouncing, ["does_not_bounce"]),
    (Sleepy, ["falls_when_its_support_is_removed"]),
    (SlowToRecover, ["seats_on_the_ground"]),
    (DriftingFreeze, ["stays_frozen", "freezes_in_flight", "freezes_before_its_first_step"]),
    (MerelyAsleep, ["stays_frozen", "carries_a_live_brick"]),
    (SpeedKeptThroughFreeze, ["freezes_in_flight"]),
    (MassLostOnWaking, ["tumbles_as_if_never_frozen"]),
    (InertiaLostOnWaking, ["tumbles_as_if_never_frozen"]),
    (NeverWakes, ["freezes_before_its_first_step", "wakes_to_live_again"]),
    (GhostLeftBehind, ["removes_a_frozen_brick"]),
    (ContactsOutliveTheirBricks, ["forgets_a_removed_brick"]),
    (MoveIgnored, ["moves_a_live_brick", "moves_a_frozen_brick"]),
    (QuaternionsAsInBullet, ["keeps_poses_and_ids"]),
    (RemovalToldTwice, ["reports_masses"]),
    (Shaken, ["repeats_bit_for_bit"]),
    (DisturbedByReading, ["moves_alike_unread_and_read"]),
    (
        WithoutFixedBoxes,
        [
            "rests_on_a_fixed_box",
            "slides_on_a_fixed_slope_above_the_friction_angle",
            "leans_on_a_fixed_wall",
            "stops_at_a_fixed_ceiling",
            "freezes_on_a_fixed_box",
            "finds_contacts_with_fixed_boxes",
        ],
    ),
    (
        FlippedNormalsOfFixedBoxes,
        [
            "rests_on_a_fixed_box",
            "leans_on_a_fixed_wall",
            "stops_at_a_fixed_ceiling",
        ],
    ),
    (OtherSettings, ["has_the_settings_of_its_profile"]),
    (ForcesOnTheOther, ["carries_a_resting_brick", "carries_each_level"]),
    (ForcesOfOneSubstep, ["carries_a_resting_brick", "carries_each_level"]),
    (ForcesWithoutFriction, ["resists_a_steady_push"]),
    (ForcesThatCancel, ["keeps_forces_within_the_laws_of_contact"]),
    (ForcesAcrossGaps, ["keeps_forces_within_the_laws_of_contact"]),
    (ForceForOneStep, ["accelerates_by_force_over_mass"]),
    (GravityAsBefore, ["falls_along_gravity_that_changes"]),
    (PushedAside, ["goes_where_it_is_driven", "carries_what_lies_on_it"]),
    (MovedBodyGluesItsLoad, ["slides_on_a_tilted_platform_above_the_friction_angle"]),
    (MovedBodyNotListed, ["reports_moved_bodies"]),
    (DrivenUnseenByFrozen, ["shows_what_it_moves_below_frozen_bricks"]),
    (DrivenStoppedByFrozen, ["shows_what_it_moves_below_frozen_bricks"]),
    (NothingAhead, ["lists_what_is_about_to_strike"]),
    (EverythingAhead, ["does_not_list_what_passes_by"]),
    (ClaimsToBePlanar, ["refuses_what_leaves_its_plane"]),
    (ForcesAgainstItsWord, ["reports_no_forces"]),
    (FacesCalledEdges, ["reports_the_normal_at_a_ridge"]),
    (ForcesFoundWithoutAStep, ["forgets_forces_without_a_step"]),
    (FixedBoxesTooSmooth, ["slides_on_a_fixed_slope_above_the_friction_angle"]),
    (FixedBoxesAside, ["rests_on_a_fixed_box", "leans_on_a_fixed_wall", "finds_contacts_with_fixed_boxes"]),
]


@pytest.mark.parametrize(("broken", "check"), [(broken, check) for broken, checks in BROKEN for check in checks])
def test_a_broken_adapter_is_caught(broken: type[BulletSimulation | EnginePort], check: str) -> None:
    assert_caught(broken, CHECK[check])


def test_every_check_is_known_to_catch_something() -> None:
    caught = {check for _, checks in BROKEN for check in checks}
    # What the shared base class checks for every adapter cannot be broken from within an adapter.
    assert set(CHECK) - caught == {"refuses_bad_input"}
