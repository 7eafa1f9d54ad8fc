"""Rapier: soft contacts in small substeps, in single precision.

Freezing: the body is stopped and made ``FIXED``; made ``DYNAMIC`` again it has the mass and inertia of its collider.
Rapier scales a body's quaternion back to unit length when its type changes, and would go on doing so, a bit this way
and a bit that, wherever single precision has no quaternion of exactly that length: a freeze settles the rotation first.

Contacts are points in the two colliders' own frames, found at the start of the latest substep or earlier: Rapier keeps
a manifold while the pair has hardly moved, and with it a stale distance. So points and normals are carried along with
the bodies, and the separation is measured between them, at the poses after the step. Rapier lists points within its
prediction distance as well; those that are further apart than a tenth of a millimetre are left out.

Friction: as shipped a pair has the mean of both colliders' coefficients, and all colliders have the world's. The
shipped model has one friction constraint a manifold and one against twist; "coulomb" has one a point.

Traps: softness and tolerances are scaled by ``length_unit``, which is a metre as shipped: planks may then overlap by
5 mm uncured. A state that is not finite is put back and the body silently disabled: its pose is reported as NaN. A view
of a removed body raises. Worker threads are off, as every other engine runs on one.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
import rapier3d

from adapters.base import Capabilities, Knob, Profile, Simulation, Sleeping
from adapters.motions import Motions, fastest_approach
from adapters.vectors import dot, rotate
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

GROUND_HALF_EXTENTS = (2.0, 2.0, 0.5)
"""Half the ground's edges [m]: room for any scene of planks, and thick enough that nothing falls through."""

_GROUND_POSE = (0.0, 0.0, -GROUND_HALF_EXTENTS[2], 1.0, 0.0, 0.0, 0.0)
_NEAR = 1e-4
"""Points further apart than this [m] do not touch."""

_THREADS: Mapping[str, Knob] = {"num_threads": Knob(1, "one processor core, as every other engine; and repeatable")}

PROFILES: Mapping[str, Profile] = {
    profile.name: profile
    for profile in (
        Profile("default", "as shipped: one step a frame, four solver substeps", substeps=1, knobs=_THREADS),
        Profile(
            "game",
            "one step a frame",
            substeps=1,
            knobs=_THREADS | {"length_unit": Knob(0.01, "x")},
            tuned_by="Stillstack, on the 4-stack and the inverted V",
        ),
        Profile(
            "tuned",
            "two steps",
            substeps=2,
            knobs=_THREADS
            | {
                "length_unit": Knob(0.01, "x"),
                "num_solver_iterations": Knob(16, "x"),
                "contact_softness.natural_frequency": Knob(240.0, "x"),
                "contact_softness.damping_ratio": Knob(5.0, "x"),
                "static_contact_softness.natural_frequency": Knob(240.0, "x"),
                "static_contact_softness.damping_ratio": Knob(5.0, "x"),
            },
            tuned_by="Stillstack, on the 4-stack and the inverted V",
        ),
    )
}

_SLEEP_KNOBS: Mapping[Sleeping, Mapping[str, Knob]] = {
    "off": {"can_sleep": Knob(False, "the engine's own sleeping is off")},
    "native": {},
    "raised": {
        "activation.linear_threshold": Knob(0.2, "four times as shipped, times length_unit [m/s]"),
        "activation.angular_threshold": Knob(2.0, "four times as shipped [rad/s]"),
    },
}


class RapierSimulation(Simulation):
    """One world of Rapier."""

    engine: ClassVar[str] = "rapier"
    profiles: ClassVar[Mapping[str, Profile]] = PROFILES
    capabilities: ClassVar[Capabilities] = Capabilities(
        contact_points="up to 4 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces=True,
        freeze="fixed body",
        frozen_contacts=True,
        friction_law="cone",
        deterministic="across processes",
    )

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        profile = replace(profile, knobs={**profile.knobs, **_SLEEP_KNOBS[sleeping]})
        super().__init__(profile, world, sleeping, expected)
        self._engine = rapier3d.PhysicsWorld(gravity=world.gravity)
        self._handles: dict[int, rapier3d.RigidBodyHandle] = {}
        self._views: dict[int, rapier3d.RigidBody] = {}
        self._colliders: dict[int, rapier3d.ColliderHandle] = {}
        self._body_of: dict[rapier3d.ColliderHandle, int] = {}
        self._before: Motions | None = None
        self._has_diverged = False
        self._engine.set_num_threads(1)
        for name, knob in profile.knobs.items():
            self._configure(name, knob.value)
        ground = rapier3d.Collider.cuboid(*GROUND_HALF_EXTENTS).translation(_GROUND_POSE[:3])
        self._body_of[self._engine.add_collider(ground.friction(world.friction))] = GROUND

    @staticmethod
    def _version() -> str:
        return importlib.metadata.version("rapier3d")

    def _configure(self, name: str, value: float | int | str | bool) -> None:
        parameters = self._engine.integration_parameters
        owner, _, attribute = name.rpartition(".")
        if owner in ("contact_softness", "static_contact_softness"):
            softness = getattr(parameters, owner)  # a copy
            setattr(softness, attribute, value)
            setattr(parameters, owner, softness)
        elif name == "friction_model":
            parameters.friction_model = getattr(rapier3d.FrictionModel, str(value))
        elif hasattr(parameters, name):
            setattr(parameters, name, value)

    # -- driven by the harness ---------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        knobs = self.info.profile.knobs
        half_x, half_y, half_z = (edge / 2 for edge in brick.size)
        box = rapier3d.Collider.cuboid(half_x, half_y, half_z).mass(brick.mass).friction(self.world.friction)
        free = rapier3d.RigidBody.dynamic().position((brick.position, _to_rapier(brick.quaternion)))
        free.can_sleep("can_sleep" not in knobs)
        if "soft_ccd_prediction" in knobs:
            free.soft_ccd_prediction(knobs["soft_ccd_prediction"].value)
        handle = self._engine.add_body(free, [box])
        view = self._engine.rigid_bodies[handle]
        (collider,) = view.colliders
        self._handles[body], self._views[body], self._colliders[body] = handle, view, collider
        self._body_of[collider] = body

    def _remove(self, body: int) -> None:
        del self._views[body]
        del self._body_of[self._colliders.pop(body)]
        self._engine.remove_body(self._handles.pop(body))

    def _push(self, body: int, impulse: Vector) -> None:
        self._views[body].apply_impulse(impulse)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        view = self._views[body]
        view.position = position, _to_rapier(quaternion)
        self._stop(view)
        view.wake_up()
        if body in self.frozen:
            _settle_rotation(view)

    @staticmethod
    def _stop(view: rapier3d.RigidBody) -> None:
        view.linvel = view.angvel = rapier3d.Vec3.zeros()

    def _step(self, seconds: float) -> None:
        substeps = self.info.profile.substeps
        self._engine.integration_parameters.dt = seconds / substeps
        bodies = np.fromiter(self._live, np.int64, len(self._live))
        before = []
        for _ in range(substeps):
            if self.is_observed:
                before.append((self._positions(bodies), *self._velocities(bodies)))
            self._engine.step()
            self._has_diverged |= not self._engine.quarantine.is_empty()
        self._before = Motions(bodies, *map(np.stack, zip(*before, strict=True))) if before else None

    def _positions(self, bodies: IntArray) -> FloatArray:
        views = self._views
        return _rows([views[body].translation.to_tuple() for body in bodies.tolist()], 3)

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        views = [self._views[body] for body in bodies.tolist()]
        rows = _rows([view.translation.to_tuple() + view.rotation.to_tuple() for view in views], 7)
        if self._has_diverged:
            rows[:] = np.nan
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        views = [self._views[body] for body in bodies.tolist()]
        rows = _rows([view.linvel.to_tuple() + view.angvel.to_tuple() for view in views], 6)
        return rows[:, :3], rows[:, 3:]

    def _close(self) -> None:
        self._views.clear()
        del self._engine

    # -- driven by the core, through the port ------------------------------------------------------

    def _freeze(self, body: int) -> None:
        view = self._views[body]
        self._stop(view)  # a fixed body that still has a velocity flies on
        view.body_type = rapier3d.RigidBodyType.FIXED
        _settle_rotation(view)

    def _thaw(self, body: int) -> None:
        view = self._views[body]
        view.body_type = rapier3d.RigidBodyType.DYNAMIC
        view.wake_up()

    def _contacts(self) -> Contacts:
        pairs, rows = [], []
        for body_a, body_b, pair in self._live_pairs():
            for manifold in pair.manifolds:
                normal = manifold.local_n1.to_tuple()
                for point in manifold.points:
                    pairs.append((body_a, body_b))
                    rows.append(normal + point.local_p1.to_tuple() + point.local_p2.to_tuple())
        if not rows:
            return Contacts.empty()
        body_a, body_b = np.array(pairs, np.int64).T
        local = np.array(rows)
        normal, point_a, point_b = self._in_world(body_a, body_b, local)
        separation = dot(point_b - point_a, normal)
        near = np.flatnonzero(separation <= _NEAR)
        body_a, body_b, normal = body_a[near], body_b[near], normal[near]
        point = (point_a[near] + point_b[near]) / 2
        return Contacts(
            body_a,
            body_b,
            point,
            normal,
            separation[near],
            fastest_approach(self._before, body_a, body_b, point, normal),
            np.full(len(near), self.world.friction),
        )

    def _live_pairs(self) -> Iterator[tuple[int, int, rapier3d.ContactPair]]:
        """Every pair of colliders close to each other that touches a live body, each once, with its bodies' ids."""
        live, body_of, narrow_phase = self._live, self._body_of, self._engine.narrow_phase
        if 2 * len(live) > len(self.bricks):
            for pair in narrow_phase.contact_pairs():
                a, b = body_of.get(pair.collider1), body_of.get(pair.collider2)
                if a is not None and b is not None and (a in live or b in live):
                    yield a, b, pair
            return
        for body in live:
            for pair in narrow_phase.contact_pairs_with(self._colliders[body]):
                a, b = body_of.get(pair.collider1), body_of.get(pair.collider2)
                if a is None or b is None:
                    continue
                other = b if a == body else a
                if other < body or other not in live:  # a pair of live bodies is met twice
                    yield a, b, pair

    def _in_world(
        self, body_a: IntArray, body_b: IntArray, local: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Normals, points on a and points on b [m], each (n, 3), of rows (n, 9) in the colliders' own frames."""
        bodies, place = np.unique(np.concatenate([body_a, body_b]), return_inverse=True)
        positions, quaternions = self._poses(bodies[bodies != GROUND])
        if bodies[0] == GROUND:  # the least id
            positions = np.vstack([_GROUND_POSE[:3], positions])
            quaternions = np.vstack([_GROUND_POSE[3:], quaternions])
        place_a, place_b = place[: len(body_a)], place[len(body_a) :]
        return (
            rotate(quaternions[place_a], local[:, :3]),
            positions[place_a] + rotate(quaternions[place_a], local[:, 3:6]),
            positions[place_b] + rotate(quaternions[place_b], local[:, 6:]),
        )


def _to_rapier(quaternion: Quaternion) -> Quaternion:
    """Rapier's order of components is (x, y, z, w)."""
    w, x, y, z = quaternion
    return x, y, z, w


def _settle_rotation(view: rapier3d.RigidBody) -> None:
    """Bring a body's quaternion to where Rapier's scaling to unit length no longer changes a bit of it."""
    before = None
    while before != (before := view.rotation.to_tuple()):
        view.rotation = before


def _rows(rows: list[tuple[float, ...]], width: int) -> FloatArray:
    """Rows as an array of shape (n, width), also for n = 0."""
    return np.array(rows, np.float64).reshape(len(rows), width)
