"""Import of OpenUSD with the physics schema through OpenUSD's own Python package.

- A prim with RigidBodyAPI becomes a brick. The prim must have one collider: Cube, Sphere, Capsule, Cylinder or a convex
  Mesh.
- A collider outside rigid bodies, except a Plane, becomes a fixed body.
- A Plane outside rigid bodies becomes the ground. The Plane's normal must be z, and all Planes must have one height.
- The import converts lengths by metersPerUnit and masses by kilogramsPerUnit. The up axis must be z.
- The import leaves out visual prims, cameras and lights.
- The import refuses joints: the error names the joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.formats.imported import Imported, ImportRefusedError, with_common_friction
from scenarios.formats.meshes import is_convex
from scenarios.formats.openusd import MISSING, has_openusd
from scenarios.geometry import FloatArray
from scenarios.model import Brick, World
from scenarios.planks import DENSITY, GRAVITY, MU
from scenarios.solids import capsule, cylinder, moments_of, polyhedron, quaternion_of, sphere, volume_of

SKEW = 1e-6
"""Greatest relative difference of scales across a round shape, greatest skew of a transform, and greatest difference of
the ground's normal from z."""
LEVEL = 1e-6
"""Greatest difference of height between planes that count as one ground [m], because OpenUSD keeps some transforms in
single precision."""
SAME = 1e-6
"""Greatest relative difference of moments of inertia that count as those of the homogeneous shape, because OpenUSD
keeps them in single precision."""


def read_usd(path: Path) -> Imported:
    """Return the content of a USD file.

    Raises:
        ImportRefusedError: if OpenUSD is missing or cannot read the file, or a scene cannot hold a prim or the stage.
    """
    if not has_openusd():
        raise ImportRefusedError(MISSING)
    from pxr import Tf, Usd, UsdGeom, UsdPhysics

    try:
        stage = Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        raise ImportRefusedError(f"OpenUSD cannot read the file: {error}; correct the file") from error
    if UsdGeom.GetStageUpAxis(stage) != UsdGeom.Tokens.z:
        raise ImportRefusedError("the up axis of the stage is y: set upAxis to Z, and turn the stage's content")
    prims = list(stage.Traverse())
    for prim in prims:
        if prim.IsA(UsdPhysics.Joint):
            raise ImportRefusedError(
                f"joint '{prim.GetPath()}': a scene holds only free and fixed bodies; remove the joint"
            )
    unit, mass_unit = UsdGeom.GetStageMetersPerUnit(stage), UsdPhysics.GetStageKilogramsPerUnit(stage)
    rigid = [prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    colliders = [prim for prim in prims if prim.HasAPI(UsdPhysics.CollisionAPI)]
    owner = {prim: _owner(prim, rigid) for prim in colliders}
    bricks = [_brick(body, [prim for prim in colliders if owner[prim] == body], unit, mass_unit) for body in rigid]
    if not bricks:
        raise ImportRefusedError("the file has no rigid body: apply RigidBodyAPI to each prim that may move")
    loose = [prim for prim in colliders if owner[prim] is None]
    planes = [prim for prim in loose if prim.IsA(UsdGeom.Plane)]
    height = _ground_height(planes, unit)
    fixed = [replace(_shape(prim, unit, 1.0), friction=_friction(prim)) for prim in loose if prim not in planes]
    friction = (_friction(planes[0]) if planes else bricks[0].friction) or 0.0
    world = World(friction, _gravity(prims, unit), tuple(_lowered(body, height) for body in fixed))
    world, found = with_common_friction(world, [_lowered(brick, height) for brick in bricks])
    notes = (f"all bodies shifted by {-height:g} m along z, so that the ground is z = 0",) if height else ()
    return Imported(path.stem, world, found, tuple(str(prim.GetPath()) for prim in rigid), notes)


def _owner(prim: Any, rigid: Sequence[Any]) -> Any:
    """Return the rigid body of a collider; None for a fixed collider."""
    while prim and prim not in rigid:
        prim = prim.GetParent()
    return prim if prim in rigid else None


def _ground_height(planes: Sequence[Any], unit: float) -> float:
    """Return the height [m] of the level ``planes``; 0 without planes.

    Raises:
        ImportRefusedError: if a plane is not level, or the planes have different heights.
    """
    from pxr import UsdGeom

    heights = []
    for plane in planes:
        frame, origin, _ = _transform(plane)
        normal = frame @ _turn_to(UsdGeom.Plane(plane).GetAxisAttr().Get())[:, 2]
        if np.abs(normal - (0.0, 0.0, 1.0)).max() > SKEW:
            raise ImportRefusedError(
                f"plane '{plane.GetPath()}' has the normal {normal.round(6).tolist()}, but the ground of a scene is "
                "level: turn the plane's normal to z, or replace the plane by a fixed Cube"
            )
        heights.append(float(origin[2]) * unit)
        if abs(heights[-1] - heights[0]) > LEVEL:
            raise ImportRefusedError(
                f"planes '{planes[0].GetPath()}' and '{plane.GetPath()}' have different heights, {heights[0]:.9g} m "
                f"and {heights[-1]:.9g} m, but a scene has one ground: replace one of the planes by a fixed Cube"
            )
    return heights[0] if heights else 0.0


def _brick(body: Any, colliders: Sequence[Any], unit: float, mass_unit: float) -> Brick:
    from pxr import UsdPhysics

    path = body.GetPath()
    if len(colliders) != 1:
        raise ImportRefusedError(
            f"rigid body '{path}' has {len(colliders)} colliders, but a brick has one convex shape: give the "
            "body one collider, for example a mesh of the body's convex hull"
        )
    shape = _shape(colliders[0], unit, 1.0)
    given = UsdPhysics.MassAPI(body)
    mass = float(given.GetMassAttr().Get() or 0.0) * mass_unit
    density = float(given.GetDensityAttr().Get() or 0.0) * mass_unit / unit**3
    mass = mass or (density or DENSITY) * volume_of(shape.shape, shape.size)
    brick = replace(shape, mass=mass, friction=_friction(colliders[0]))
    moments = np.array(given.GetDiagonalInertiaAttr().Get() or (0.0, 0.0, 0.0), np.float64) * mass_unit * unit**2
    if not moments.any() or np.abs(moments / moments_of(brick) - 1).max() <= SAME:
        return brick
    x, y, z = moments.tolist()
    return replace(brick, moments=(x, y, z))


def _shape(prim: Any, unit: float, mass: float) -> Brick:
    """Return a brick with the shape and the pose of a collider.

    Raises:
        ImportRefusedError: if a brick cannot have the collider's type, shape or scales, or a mesh's convex hull is too
            flat or has more than ``polyhedra.MOST_VERTICES`` vertices.
    """
    from pxr import UsdGeom

    frame, origin, scale = _transform(prim)
    x, y, z = (origin * unit).tolist()
    scale = scale * unit
    if prim.IsA(UsdGeom.Cube):
        length, width, height = (scale * UsdGeom.Cube(prim).GetSizeAttr().Get()).tolist()
        return Brick((length, width, height), mass, (x, y, z), quaternion_of(frame))
    if prim.IsA(UsdGeom.Mesh):
        mesh = UsdGeom.Mesh(prim)
        points = np.array(mesh.GetPointsAttr().Get(), np.float64) * scale
        counts, indices = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()
        if not is_convex(points, _triangles(counts, indices)):
            raise ImportRefusedError(
                f"mesh '{prim.GetPath()}' is not convex: replace the mesh by its convex hull, or a fixed mesh by "
                "convex parts"
            )
        try:
            return polyhedron(points, position=(x, y, z), quaternion=quaternion_of(frame), mass=mass)
        except ValueError as error:
            raise ImportRefusedError(f"mesh '{prim.GetPath()}': {error}") from error
    if np.ptp(scale) > SKEW * scale.max():
        raise ImportRefusedError(
            f"'{prim.GetPath()}' has the unequal scales {(scale / unit).round(6).tolist()}, but only a Cube or a Mesh "
            "may have unequal scales: make the scales equal"
        )
    if prim.IsA(UsdGeom.Sphere):
        radius = float(UsdGeom.Sphere(prim).GetRadiusAttr().Get() * scale[0])
        return sphere(radius, position=(x, y, z), quaternion=quaternion_of(frame), mass=mass)
    for kind, make in ((UsdGeom.Capsule, capsule), (UsdGeom.Cylinder, cylinder)):
        if prim.IsA(kind):
            round_shape = kind(prim)
            turned = frame @ _turn_to(round_shape.GetAxisAttr().Get())
            radius, height = (
                float(part.Get() * scale[0]) for part in (round_shape.GetRadiusAttr(), round_shape.GetHeightAttr())
            )
            return make(radius, height, position=(x, y, z), quaternion=quaternion_of(turned), mass=mass)
    raise ImportRefusedError(
        f"'{prim.GetPath()}' is of type {prim.GetTypeName() or 'unknown'}: use a Cube, Sphere, Capsule, Cylinder or "
        "convex Mesh"
    )


def _transform(prim: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the frame (3, 3), the origin (3,) and the scales (3,) of a prim in the world, in the stage's units.

    Raises:
        ImportRefusedError: if the prim is skewed or mirrored.
    """
    from pxr import Usd, UsdGeom

    matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    rows = matrix[:3, :3]  # OpenUSD multiplies rows
    scale = np.linalg.norm(rows, axis=1)
    frame = (rows / scale[:, None]).T
    if np.abs(frame.T @ frame - np.eye(3)).max() > SKEW or np.linalg.det(frame) < 0:
        raise ImportRefusedError(
            f"'{prim.GetPath()}' is skewed or mirrored: use rotations, and positive scales along the prim's own axes"
        )
    return frame, matrix[3, :3], scale


def _turn_to(axis: str) -> FloatArray:
    """Return the rotation matrix (3, 3) that turns the z axis to an ``axis`` "X", "Y" or "Z"."""
    matrices = {
        "X": [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        "Y": [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        "Z": np.eye(3),
    }
    return np.array(matrices[axis])


def _triangles(counts: Sequence[int], indices: Sequence[int]) -> list[tuple[int, int, int]]:
    found, start = [], 0
    for count in counts:
        loop = indices[start : start + count]
        found += [(loop[0], loop[k], loop[k + 1]) for k in range(1, count - 1)]
        start += count
    return found


def _friction(prim: Any) -> float:
    """Return the static friction of a collider's physics material; ``MU`` without a physics material."""
    from pxr import UsdPhysics, UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    if material and material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return round(float(UsdPhysics.MaterialAPI(material.GetPrim()).GetStaticFrictionAttr().Get()), 7)
    return MU


def _gravity(prims: Sequence[Any], unit: float) -> tuple[float, float, float]:
    from pxr import UsdPhysics

    for prim in prims:
        if prim.IsA(UsdPhysics.Scene):
            scene = UsdPhysics.Scene(prim)
            direction = np.array(scene.GetGravityDirectionAttr().Get(), np.float64)
            strength = float(scene.GetGravityMagnitudeAttr().Get())
            if direction.any() and np.isfinite(strength) and strength >= 0:
                x, y, z = (round(strength, 6) * unit * direction / np.linalg.norm(direction)).tolist()
                return x, y, z
    return 0.0, 0.0, -GRAVITY


def _lowered(body: Brick, height: float) -> Brick:
    x, y, z = body.position
    return replace(body, position=(x, y, z - height))
