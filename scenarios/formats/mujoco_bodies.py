"""Bricks and fixed bodies from the geometries of a compiled MuJoCo model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from scenarios.formats.imported import ImportRefusedError
from scenarios.formats.meshes import convex_parts, is_convex
from scenarios.geometry import FloatArray, rotation
from scenarios.model import Brick
from scenarios.solids import capsule, cylinder, moments_of, polyhedron, quaternion_of, sphere

SAME = 1e-9
"""Greatest relative difference of moments of inertia that count as those of the homogeneous shape."""
OFF_CENTER = 1e-6
"""Greatest distance of a centre of mass from its place in the shape, and greatest product of inertia, relative to the
extent and to the greatest moment, because MuJoCo keeps vertices of meshes in single precision."""


@dataclass(frozen=True, slots=True)
class Geom:
    """A collision geometry, in the file's pose."""

    name: str
    kind: int
    size: FloatArray
    position: FloatArray
    frame: FloatArray
    """Rotation matrix from the geometry's frame to the world's, shape (3, 3)."""
    friction: float
    mesh: int
    body_position: FloatArray
    """Origin of the body's frame [m], shape (3,)."""
    body_frame: FloatArray
    """Rotation matrix from the body's frame to the world's, shape (3, 3)."""


def read_geom(model: Any, data: Any, index: int) -> Geom:
    """Return the geometry ``index`` of a compiled model."""
    name = model.geom(index).name or f"geom {index} of body '{model.body(model.geom_bodyid[index]).name}'"
    friction = 0.0 if model.geom_condim[index] == 1 else float(model.geom_friction[index, 0])
    return Geom(
        name,
        int(model.geom_type[index]),
        np.array(model.geom_size[index]),
        np.array(data.geom_xpos[index]),
        np.array(data.geom_xmat[index]).reshape(3, 3),
        friction,
        int(model.geom_dataid[index]),
        np.array(data.xpos[model.geom_bodyid[index]]),
        np.array(data.xmat[model.geom_bodyid[index]]).reshape(3, 3),
    )


def free_brick(model: Any, data: Any, body: int, name: str, geoms: Sequence[Geom]) -> Brick:
    """Return a free body as a brick.

    Raises:
        ImportRefusedError: if the body has no geometry or several geometries, a brick cannot have the geometry's
            shape, or the mass properties do not fit the shape; the message names the body or geometry, and the fix.
    """
    if len(geoms) != 1:
        raise ImportRefusedError(
            f"body '{name}' has {len(geoms)} collision geometries, but a brick has one convex shape: give the body "
            "one collision geometry, for example a mesh of the body's convex hull (in MJCF, set contype and "
            "conaffinity of all other geometries to 0; in URDF, keep one <collision>)"
        )
    (geom,) = geoms
    parts = [index for index in range(1, model.nbody) if model.body_weldid[index] == body]
    mass = float(model.body_mass[parts].sum())
    center = (model.body_mass[parts, None] * data.xipos[parts]).sum(axis=0) / mass
    brick = replace(_shape(model, geom, mass), friction=geom.friction)
    extent = max(brick.size)
    if np.abs(center - brick.position).max() > OFF_CENTER * extent:
        raise ImportRefusedError(
            f"the centre of mass of body '{name}' is {np.linalg.norm(center - brick.position) * 1e3:.3g} mm from the "
            "centre of the body's shape: remove the body's <inertial>, or give the body's visual geometries mass 0"
        )
    frame = _frame(brick)
    inertial = np.array(data.ximat[body]).reshape(3, 3)
    if len(parts) == 1 and np.abs(frame.T @ inertial - np.eye(3)).max() <= OFF_CENTER:
        frame = inertial
    inertia = frame.T @ _inertia(model, data, parts, center) @ frame
    moments = np.diag(inertia)
    if np.abs(inertia - np.diag(moments)).max() > OFF_CENTER * moments.max():
        raise ImportRefusedError(
            f"the principal axes of inertia of body '{name}' differ from the axes of the body's shape: remove the "
            "body's <inertial>, or give the body's visual geometries mass 0"
        )
    x, y, z = center.tolist()
    placed = replace(brick, position=(x, y, z), quaternion=quaternion_of(frame))
    if np.abs(moments / np.array(moments_of(placed)) - 1).max() <= SAME:
        return placed
    first, second, third = moments.tolist()
    return replace(placed, moments=(first, second, third))


def _inertia(model: Any, data: Any, parts: Sequence[int], center: FloatArray) -> FloatArray:
    """Return the inertia [kg m2] of welded bodies about their centre of mass, along the world's axes."""
    total = np.zeros((3, 3))
    for part in parts:
        axes = np.array(data.ximat[part]).reshape(3, 3)
        arm = np.array(data.xipos[part]) - center
        total += axes @ np.diag(model.body_inertia[part]) @ axes.T
        total += model.body_mass[part] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return total


def _shape(model: Any, geom: Geom, mass: float) -> Brick:
    """Return a brick with shape and pose of a geometry."""
    x, y, z = geom.position.tolist()
    position, quaternion = (x, y, z), quaternion_of(geom.frame)
    radius, half = float(geom.size[0]), float(geom.size[1])
    match geom.kind:
        case mujoco.mjtGeom.mjGEOM_BOX:
            length, width, height = (2 * geom.size).tolist()
            return Brick((length, width, height), mass, position, quaternion)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return sphere(radius, position=position, quaternion=quaternion, mass=mass)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return capsule(radius, 2 * half, position=position, quaternion=quaternion, mass=mass)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return cylinder(radius, 2 * half, position=position, quaternion=quaternion, mass=mass)
        case mujoco.mjtGeom.mjGEOM_MESH:
            vertices, faces = _mesh(model, geom.mesh)
            if not is_convex(vertices, faces):
                raise ImportRefusedError(
                    f"mesh of '{geom.name}' is not convex, but a brick has one convex shape: replace the mesh by its "
                    "convex hull or by another convex shape"
                )
            return _hull(vertices, geom, mass)
    kind = str(mujoco.mjtGeom(geom.kind)).rpartition("mjGEOM_")[2].lower()
    raise ImportRefusedError(
        f"geometry '{geom.name}' is of type {kind}: use a box, sphere, capsule, cylinder or convex mesh"
    )


def fixed_bodies(model: Any, geom: Geom, notes: list[str]) -> list[Brick]:
    """Return a geometry as a fixed body, or a mesh that is not convex as its convex parts, with a note in ``notes``.

    Raises:
        ImportRefusedError: if a fixed body cannot have the geometry's type, CoACD, which splits meshes, is missing, or
            a convex hull is too flat or has more than ``polyhedra.MOST_VERTICES`` vertices.
    """
    if geom.kind == mujoco.mjtGeom.mjGEOM_MESH and not is_convex(*_mesh(model, geom.mesh)):
        parts = convex_parts(geom.name, *_mesh(model, geom.mesh))
        notes.append(f"mesh of '{geom.name}' is not convex: it became {len(parts)} convex fixed bodies")
        found = [_hull(part, geom, 1.0) for part in parts]
    else:
        found = [_shape(model, geom, 1.0)]
    return [replace(body, friction=geom.friction) for body in found]


def _hull(vertices: FloatArray, geom: Geom, mass: float) -> Brick:
    """Return the convex hull of ``vertices`` (v, 3) [m], which are in a geometry's frame, as a brick.

    The function converts the vertices to the frame of the geometry's body, because MuJoCo turns the frame of a mesh,
    and may exchange its axes.

    Raises:
        ImportRefusedError: if the hull is too flat, or has more than ``polyhedra.MOST_VERTICES`` vertices; the message
            names the geometry.
    """
    in_world = geom.position + vertices @ geom.frame.T
    x, y, z = geom.body_position.tolist()
    in_body = (in_world - geom.body_position) @ geom.body_frame
    try:
        return polyhedron(in_body, position=(x, y, z), quaternion=quaternion_of(geom.body_frame), mass=mass)
    except ValueError as error:
        raise ImportRefusedError(f"mesh of '{geom.name}': {error}") from error


def _mesh(model: Any, mesh: int) -> tuple[FloatArray, Any]:
    """Return vertices (v, 3) [m] and triangles (t, 3) of a mesh, in the geometry's frame."""
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    start, triangles = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    vertices: FloatArray = model.mesh_vert[first : first + count].astype(np.float64)
    return vertices, np.array(model.mesh_face[start : start + triangles])


def _frame(brick: Brick) -> FloatArray:
    frame: FloatArray = rotation(np.array([brick.quaternion]))[0]
    return frame
