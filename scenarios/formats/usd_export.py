"""Export of a scene as OpenUSD with the physics schema: rigid bodies, colliders, masses, materials and gravity."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenarios.formats.final_bricks import final_bricks
from scenarios.formats.imported import ExportRefusedError
from scenarios.formats.openusd import MISSING, has_openusd
from scenarios.model import Brick, Scene, World
from scenarios.polyhedra import faces
from scenarios.shapes import Polyhedron
from scenarios.solids import friction_of, moments_of


def to_usd(scene: Scene) -> str:
    """Return a scene as the text of a USDA file, in metres and kilograms with z up.

    The file has restitution 0, no actions, and no bricks that the scene removes or pulls out. A pair of bodies has the
    arithmetic mean of both coefficients of friction in the physics schema, but the geometric mean in a scene. Both
    means are equal if both coefficients are equal.

    Raises:
        ExportRefusedError: if OpenUSD is missing; the message gives the command that installs OpenUSD.
    """
    if not has_openusd():
        raise ExportRefusedError(MISSING)
    from pxr import Gf, Usd, UsdGeom, UsdPhysics

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, "/scene")
    stage.SetDefaultPrim(root.GetPrim())
    physics = UsdPhysics.Scene.Define(stage, "/scene/physics")
    strength = float(np.linalg.norm(scene.world.gravity))
    physics.CreateGravityDirectionAttr(Gf.Vec3f(*(part / strength for part in scene.world.gravity)))
    physics.CreateGravityMagnitudeAttr(strength)
    materials = _Materials(stage)
    ground = UsdGeom.Plane.Define(stage, "/scene/ground")
    ground.CreateAxisAttr(UsdGeom.Tokens.z)
    UsdPhysics.CollisionAPI.Apply(ground.GetPrim())
    materials.bind(ground.GetPrim(), scene.world.friction)
    for index, body in enumerate(scene.world.fixed):
        _add_body(stage, f"/scene/fixed_{index}", body, scene.world, materials)
    for index, brick in final_bricks(scene):
        prim = _add_body(stage, f"/scene/brick_{index}", brick, scene.world, materials)
        rigid = UsdPhysics.RigidBodyAPI.Apply(prim)
        rigid.CreateKinematicEnabledAttr(brick.moved)
        mass = UsdPhysics.MassAPI.Apply(prim)
        mass.CreateMassAttr(brick.mass)
        mass.CreateCenterOfMassAttr(Gf.Vec3f(0.0))
        mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments_of(brick)))
        mass.CreatePrincipalAxesAttr(Gf.Quatf(1.0))
    text: str = stage.GetRootLayer().ExportToString()
    return text


class _Materials:
    """The physics materials of a stage: a material for each coefficient of friction."""

    def __init__(self, stage: Any) -> None:
        self._stage, self._made = stage, dict[float, Any]()

    def bind(self, prim: Any, friction: float) -> None:
        from pxr import UsdPhysics, UsdShade

        if friction not in self._made:
            made = UsdShade.Material.Define(self._stage, f"/scene/material_{len(self._made)}")
            physics = UsdPhysics.MaterialAPI.Apply(made.GetPrim())
            physics.CreateStaticFrictionAttr(friction)
            physics.CreateDynamicFrictionAttr(friction)
            physics.CreateRestitutionAttr(0.0)
            self._made[friction] = made
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(self._made[friction], materialPurpose="physics")


def _add_body(stage: Any, path: str, body: Brick, world: World, materials: _Materials) -> Any:
    """Add a body to the stage as a transform with a collider, and return the transform's prim."""
    from pxr import Gf, UsdGeom, UsdPhysics

    transform = UsdGeom.Xform.Define(stage, path)
    transform.AddTranslateOp().Set(Gf.Vec3d(*body.position))
    w, i, j, k = body.quaternion
    transform.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, i, j, k))
    shape = _add_shape(stage, f"{path}/shape", body)
    UsdPhysics.CollisionAPI.Apply(shape)
    materials.bind(shape, friction_of(body, world))
    return transform.GetPrim()


def _add_shape(stage: Any, path: str, body: Brick) -> Any:
    from pxr import Gf, UsdGeom, UsdPhysics

    x, _, z = body.size
    if isinstance(body.shape, Polyhedron):
        mesh = UsdGeom.Mesh.Define(stage, path)
        mesh.CreatePointsAttr([Gf.Vec3f(*vertex) for vertex in body.shape.vertices])
        loops = faces(body.shape)
        mesh.CreateFaceVertexCountsAttr([len(loop) for loop in loops])
        mesh.CreateFaceVertexIndicesAttr([vertex for loop in loops for vertex in loop])
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr("convexHull")
        return mesh.GetPrim()
    if body.shape == "box":
        cube = UsdGeom.Cube.Define(stage, path)
        cube.CreateSizeAttr(1.0)
        cube.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*body.size))
        return cube.GetPrim()
    if body.shape == "sphere":
        ball = UsdGeom.Sphere.Define(stage, path)
        ball.CreateRadiusAttr(x / 2)
        return ball.GetPrim()
    make, height = (UsdGeom.Capsule, z - x) if body.shape == "capsule" else (UsdGeom.Cylinder, z)
    round_shape = make.Define(stage, path)
    round_shape.CreateAxisAttr(UsdGeom.Tokens.z)
    round_shape.CreateRadiusAttr(x / 2)
    round_shape.CreateHeightAttr(height)
    return round_shape.GetPrim()
