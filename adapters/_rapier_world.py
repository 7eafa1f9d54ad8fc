"""A world of Rapier with the settings of a profile, and its bodies."""

from __future__ import annotations

import math
from collections.abc import Iterable
from operator import attrgetter

import numpy as np
import rapier3d

from adapters.profile import KnobValue, Profile
from adapters.shared.face_pieces import face_pieces
from adapters.shared.vectors import half_edges, scalar_last
from scenarios.model import Brick, Vector, World
from scenarios.shapes import Polyhedron
from scenarios.solids import friction_of, moments_of, restitution_of
from stability_core.port import FloatArray
from stability_core.ports.rapier_rotation import settle_rotation

BODY_KNOBS = ("body.can_sleep", "body.activation.linear_threshold", "body.activation.angular_threshold")
"""Knobs that are settings of each body. All other knobs are settings of the world."""


VERTICES_OF_A_FACE = 4
"""Greatest number of vertices of a face that Parry (Rapier's collision library) uses: the first four of a hexagon cover
half of its area."""
AXIS_FROM_Y_TO_Z: Vector = (math.pi / 2, 0.0, 0.0)
"""Rotation vector [rad] from the axis of Rapier's cylinder to the axis of a brick."""

WELD_HERTZ = 120.0
"""Stiffness of a fixed joint [Hz]. With 1 MHz as shipped joints and contacts threw a pile of bricks apart, and with
240 Hz a 4-stack without its top trembled until its joints parted."""
WELD_DAMPING = 5.0
"""Damping ratio of a fixed joint. With 1 as shipped, and 240 Hz, a leaning tower slid sideways by 49 um/s; now by 1.3
um/s. With 10 bricks in a mould tremble, so that joints part at rest."""
_UNTURNED = (0.0, 0.0, 0.0, 1.0)


def knows(knob: str) -> bool:
    """Return whether a knob of this name may exist. Rapier itself rejects an unknown setting of the world."""
    return not knob.startswith("body.") or knob in BODY_KNOBS


class RapierWorld:
    """A world, with the handles, views and colliders of its bodies. A view of a removed body raises an error."""

    def __init__(self, world: World, profile: Profile) -> None:
        self.world = rapier3d.PhysicsWorld(gravity=world.gravity)
        self.handles: dict[int, rapier3d.RigidBodyHandle] = {}
        self.views: dict[int, rapier3d.RigidBody] = {}
        self.colliders: dict[int, rapier3d.ColliderHandle] = {}
        self.body_of: dict[rapier3d.ColliderHandle, int] = {}
        """Id of the body, the ground or the fixed body of each collider."""
        self.fixed_poses: tuple[FloatArray, FloatArray] = np.empty((0, 3)), np.empty((0, 4))
        """Positions (k, 3) [m] and quaternions (k, 4) of fixed bodies and ground, by rising id."""
        self.turned: set[int] = set()
        """Ids of the cylinders. Their colliders are turned, because Rapier's cylinders have their axis along y."""
        self._joints: dict[tuple[int, int], rapier3d.ImpulseJointHandle] = {}  # of each joined pair
        self._world = world
        values = profile.values
        self._can_sleep = bool(values.get("body.can_sleep", True))
        self._activation = {name.rpartition(".")[2]: value for name, value in values.items() if "activation" in name}
        for name, value in values.items():
            self._configure(name, value)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts, lower than all earlier ids."""
        fixed = rapier3d.RigidBody.fixed().position((box.position, scalar_last(box.quaternion)))
        if box.shape == "cylinder":  # which needs a body, in which its collider is turned
            self.turned.add(body)
            handle = self.world.add_body(fixed, [self._collider(box)])
            (collider,) = self.world.rigid_bodies[handle].colliders
        else:
            builder = self._collider(box).position((box.position, scalar_last(box.quaternion)))
            collider = self.world.add_collider(builder)
        self.body_of[collider] = body
        positions, quaternions = self.fixed_poses
        self.fixed_poses = np.vstack([[box.position], positions]), np.vstack([[box.quaternion], quaternions])

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        place = brick.position, scalar_last(brick.quaternion)
        self._add(body, brick, rapier3d.RigidBody.dynamic().position(place))

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        place = brick.position, scalar_last(brick.quaternion)
        self._add(body, brick, rapier3d.RigidBody.kinematic_velocity_based().position(place))

    def remove(self, body: int) -> None:
        """Remove a body."""
        del self.views[body]
        self.turned.discard(body)
        del self.body_of[self.colliders.pop(body)]
        self.world.remove_body(self.handles.pop(body))

    def replace_by_fixed(self, body: int, brick: Brick) -> None:
        """Replace a body by a new fixed body at the same pose, because Rapier's steps skip a body created as fixed."""
        position = self.views[body].position
        self.remove(body)
        self._add(body, brick, rapier3d.RigidBody.fixed().position(position))
        settle_rotation(self.views[body])

    def join(self, pair: tuple[int, int]) -> None:
        """Join two bodies by a fixed joint at the middle between their centres."""
        frames = [self.views[body].position for body in pair]
        x, y, z = np.mean([frame.translation.to_tuple() for frame in frames], axis=0).tolist()
        middle = rapier3d.Isometry3((x, y, z), _UNTURNED)
        first, second = (frame.inverse() * middle for frame in frames)
        builder = rapier3d.FixedJointBuilder().local_frame1(first).local_frame2(second).contacts_enabled(True)
        joint = builder.softness(rapier3d.SpringCoefficients(WELD_HERTZ, WELD_DAMPING)).build()
        first_handle, second_handle = (self.handles[body] for body in pair)
        self._joints[pair] = self.world.impulse_joints.insert(first_handle, second_handle, joint, True)

    def part(self, pair: tuple[int, int]) -> None:
        """Remove the joint of two bodies."""
        self.world.impulse_joints.remove(self._joints.pop(pair), True)

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow, and wake all bodies."""
        self.world.gravity = rapier3d.Vec3(*gravity)
        self.world.wake_up_all()

    def find_anew(self, body: int) -> None:
        """Make Rapier detect the contacts of a body again in the next step."""
        collider = self.world.colliders[self.colliders[body]]
        collider.shape = collider.shape

    def close(self) -> None:
        """Free the world."""
        self.views.clear()
        del self.world

    def read_knobs(self, names: Iterable[str]) -> dict[str, KnobValue]:
        """Return the present values of the named knobs that are settings of the world, except ``num_threads``."""
        own = (name for name in names if name not in BODY_KNOBS and name != "num_threads")
        return {name: attrgetter(name)(self.world.integration_parameters) for name in own}

    def _configure(self, name: str, value: KnobValue) -> None:
        """Set a knob of the world; skip a knob of bodies."""
        parameters = self.world.integration_parameters
        owner, _, attribute = name.rpartition(".")
        if name == "num_threads":
            self.world.set_num_threads(int(value))
        elif not owner:
            setattr(parameters, name, value)
        elif name not in BODY_KNOBS:
            coefficients = getattr(parameters, owner)  # a copy, which must be assigned back
            setattr(coefficients, attribute, value)
            setattr(parameters, owner, coefficients)

    def _collider(self, brick: Brick) -> rapier3d.ColliderBuilder:
        """Return a collider of the brick's shape, friction and restitution."""
        x, _, z = half_edges(brick.size)
        make = rapier3d.Collider
        if isinstance(brick.shape, Polyhedron):
            builder = _polyhedron(brick.shape)
        elif brick.shape == "cylinder":
            builder = make.cylinder(z, x).rotation(AXIS_FROM_Y_TO_Z)
        elif brick.shape == "capsule":
            builder = make.capsule_z(z - x, x)
        elif brick.shape == "sphere":
            builder = make.ball(x)
        else:
            builder = make.cuboid(*half_edges(brick.size))
        builder = builder.friction(friction_of(brick, self._world))
        if brick.friction is not None:
            builder = builder.friction_combine_rule(rapier3d.CoefficientCombineRule.GEOMETRIC_MEAN)
        if brick.restitution is not None or self._world.restitution:
            builder = builder.restitution(restitution_of(brick, self._world))
            builder = builder.restitution_combine_rule(rapier3d.CoefficientCombineRule.GEOMETRIC_MEAN)
        return builder

    def _add(self, body: int, brick: Brick, builder: rapier3d.RigidBodyBuilder) -> None:
        """Add the body that ``builder`` describes, with the shape and the mass of the brick."""
        weighed = _with_mass(self._collider(brick), brick)
        handle = self.world.add_body(builder.can_sleep(self._can_sleep), [weighed])
        view = self.world.rigid_bodies[handle]
        if self._activation:
            activation = view.activation  # a copy, which must be assigned back
            for name, value in self._activation.items():
                setattr(activation, name, value)
            view.activation = activation
        (collider,) = view.colliders
        if brick.shape == "cylinder":
            self.turned.add(body)
        self.handles[body], self.views[body], self.colliders[body] = handle, view, collider
        self.body_of[collider] = body


def _polyhedron(shape: Polyhedron) -> rapier3d.ColliderBuilder:
    """Return a convex hull, or a compound of pieces if a face has more vertices than Parry uses."""
    pieces = face_pieces(shape, VERTICES_OF_A_FACE)
    if len(pieces) == 1:
        return rapier3d.Collider.convex_hull(shape.array)
    pose, hull = rapier3d.Isometry3.identity(), rapier3d.SharedShape.convex_hull
    return rapier3d.Collider.compound([(pose, hull(piece.array)) for piece in pieces])


def _with_mass(collider: rapier3d.ColliderBuilder, brick: Brick) -> rapier3d.ColliderBuilder:
    """Return the collider with the mass of the brick, and with the brick's inertia where Rapier's own is not exact.

    The inertia of a cylinder is along the axes of its collider.
    """
    if brick.moments is None and brick.shape in ("box", "sphere"):
        return collider.mass(brick.mass)
    x, y, z = moments_of(brick)
    moments = (x, z, y) if brick.shape == "cylinder" else (x, y, z)
    center, upright = rapier3d.Vec3.zeros(), rapier3d.Rotation3.identity()
    return collider.mass_properties(rapier3d.MassProperties(center, brick.mass, rapier3d.Vec3(*moments), upright))
