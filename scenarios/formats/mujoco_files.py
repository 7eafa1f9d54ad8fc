"""Import of MJCF and URDF through MuJoCo's own parser and compiler.

- A body with a free joint becomes a brick with the body's mass and inertia. In a URDF file, joints of the type
  "floating" are free, and the root link is free unless its name is "world".
- A body without joints to the world becomes fixed bodies: a body for each collision geometry, or for each convex part
  of a mesh.
- A level plane that faces up becomes the ground. Without a plane the ground is z = 0, or the height of the lowest
  point of the free bodies if this point is below z = 0. The import shifts all bodies so that the ground is z = 0.
- The import leaves out visual geometries (without contact bits), fixed bodies below the ground, cameras, lights,
  sensors and keyframes.

A scene cannot hold

- joints that are not free, actuators, tendons, equality constraints, contact pairs, flexes (soft bodies) and skins;
- a moving body of several collision geometries.

The message of ``ImportRefusedError`` names the element and the fix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from scenarios.formats.imported import Imported, ImportRefusedError, with_common_friction
from scenarios.formats.mujoco_bodies import Geom, fixed_bodies, free_brick, read_geom
from scenarios.geometry import Boxes, height_above_ground, height_of_top
from scenarios.model import Brick, World

REFUSED = {
    "actuators": "actuator",
    "tendons": "tendon",
    "equalities": "equality constraint",
    "flexes": "flex",
    "pairs": "contact pair",
    "skins": "skin",
}
"""Elements that a scene cannot hold, by the attribute of MuJoCo's specification."""
BELOW = 1e-6
"""Height above the ground [m] up to which a fixed body counts as below the ground."""
EXACT = 1e-9
"""Height of the ground [m] that counts as zero."""
LEVEL = 1e-9
"""Greatest horizontal part of the unit normal of a plane that counts as level."""


def read_mujoco_file(path: Path) -> Imported:
    """Return the content of an MJCF or URDF file.

    Raises:
        ImportRefusedError: if MuJoCo cannot read the file, or a scene cannot hold an element of the file.
    """
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        is_urdf = path.suffix.lower() == ".urdf"
        if is_urdf:
            _free_root(spec, path)
        _refuse_elements(spec)
        model = spec.compile()
    except ImportRefusedError:
        raise
    except (ValueError, OSError) as error:
        raise ImportRefusedError(f"MuJoCo cannot read the file: {error}; correct the file") from error
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    content = _content(model, data)
    if is_urdf:
        note = f"URDF has no friction: every pair has MuJoCo's default of {content.world.friction:g}"
        content = replace(content, notes=(note, *content.notes))
    return content


def _free_root(spec: Any, path: Path) -> None:
    """Give the root link of a URDF file a free joint, unless the link's name is "world".

    MuJoCo makes a link with the name "world" its own world. MuJoCo has free joints at this world only.

    Raises:
        ImportRefusedError: if a floating joint has another parent than "world".
    """
    spec.compiler.fusestatic = False
    tree = ET.parse(path).getroot()
    for joint in tree.iterfind("joint[@type='floating']"):
        parent = joint.find("parent")
        if parent is not None and parent.get("link") != "world":
            raise ImportRefusedError(
                f"floating joint '{joint.get('name')}' has the parent link '{parent.get('link')}', but a free body "
                "must have the parent 'world': name the root link 'world', and make 'world' the parent of the joint"
            )
    children = {child.get("link") for child in tree.iterfind("joint/child")}
    links = {link.get("name") for link in tree.iterfind("link")}
    for root in spec.worldbody.bodies:
        if root.name in links - children and not list(root.joints):
            root.add_freejoint()


def _refuse_elements(spec: Any) -> None:
    for attribute, kind in REFUSED.items():
        for element in getattr(spec, attribute):
            name = f"the {kind} '{element.name}'" if element.name else f"the first {kind}, which has no name"
            raise ImportRefusedError(f"{name}: a scene holds only free and fixed bodies; remove the {kind}")
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_FREE:
            kind = str(joint.type).rpartition("mjJNT_")[2].partition(":")[0].lower()
            name = f" '{joint.name}'" if joint.name else ""
            raise ImportRefusedError(
                f"{kind} joint{name} of body '{joint.parent.name}': a scene holds only free and fixed bodies; "
                "use a freejoint, or remove the joint (in URDF, use the type floating or fixed)"
            )


def _content(model: Any, data: Any) -> Imported:
    notes: list[str] = []
    ground, fixed = _split_planes([read_geom(model, data, index) for index in _colliding(model, 0, notes)])
    bricks, names = [], []
    for body in range(1, model.nbody):
        if model.body_weldid[body] == body and model.body_jntnum[body]:
            name = model.body(body).name or f"body {body}"
            geoms = [read_geom(model, data, index) for index in _colliding(model, body, notes)]
            bricks.append(free_brick(model, data, body, name, geoms))
            names.append(name)
    if not bricks:
        raise ImportRefusedError(
            "the file has no body with a free joint: give each body that may move a <freejoint/>, or in URDF a joint "
            "of the type floating"
        )
    bodies = [part for geom in fixed for part in fixed_bodies(model, geom, notes)]
    height = float(ground.position[2]) if ground is not None else min(0.0, _lowest(bricks))
    height = height if abs(height) > EXACT else 0.0
    if abs(height) > EXACT:
        notes.append(f"all bodies shifted by {-height:g} m along z, so that the ground is z = 0")
    shifted = [_at_height(brick, -height) for brick in bricks]
    shifted_fixed = [_at_height(body, -height) for body in bodies]
    fixed_above = [body for body in shifted_fixed if _highest(body) > BELOW]
    if len(fixed_above) < len(shifted_fixed):
        notes.append(f"{len(shifted_fixed) - len(fixed_above)} fixed bodies below the ground left out")
    friction = ground.friction if ground is not None else shifted[0].friction
    assert friction is not None
    x, y, z = model.opt.gravity.tolist()
    world = World(friction, (x, y, z), tuple(fixed_above))
    world, bricks_of_world = with_common_friction(world, shifted)
    if any(brick.friction is not None for brick in (*bricks_of_world, *world.fixed)):
        notes.append("a pair has the geometric mean of both coefficients of friction; MuJoCo takes the greater one")
    return Imported(
        model.names[: model.names.index(b"\0")].decode() or "scene", world, bricks_of_world, tuple(names), tuple(notes)
    )


def _colliding(model: Any, root: int, notes: list[str]) -> list[int]:
    """Return the indices of the geometries with contact bits of a root body and of all bodies welded to the root.

    The function adds a note about the geometries without contact bits to ``notes``.
    """
    found = [index for index in range(model.ngeom) if model.body_weldid[model.geom_bodyid[index]] == root]
    visual = [index for index in found if not (model.geom_contype[index] or model.geom_conaffinity[index])]
    if visual:
        notes.append(f"{len(visual)} visual geometries of '{model.body(root).name}' left out")
    return [index for index in found if index not in visual]


def _split_planes(geoms: Sequence[Geom]) -> tuple[Geom | None, list[Geom]]:
    """Return the first plane, or None without planes, and the geometries that are no planes.

    Raises:
        ImportRefusedError: if a plane is not level or faces down, or the planes have different heights.
    """
    planes = [geom for geom in geoms if geom.kind == mujoco.mjtGeom.mjGEOM_PLANE]
    for plane in planes:
        if np.hypot(*plane.frame[:2, 2]) > LEVEL or plane.frame[2, 2] < 0:
            normal = plane.frame[:, 2].round(6).tolist()
            raise ImportRefusedError(
                f"plane '{plane.name}' is not level or faces down, with the normal {normal}: "
                "use a level plane that faces up (with tilted gravity for a slope), or a fixed box"
            )
    if len({round(float(plane.position[2]), 9) for plane in planes}) > 1:
        heights = ", ".join(f"'{plane.name}' at z = {plane.position[2]:.9g} m" for plane in planes)
        raise ImportRefusedError(f"planes have different heights ({heights}), but a scene has one: keep one plane")
    return (planes[0] if planes else None), [geom for geom in geoms if geom not in planes]


def _lowest(bricks: Sequence[Brick]) -> float:
    """Return the height [m] of the lowest point of the bricks."""
    return float(height_above_ground(Boxes.of(bricks)).min())


def _highest(body: Brick) -> float:
    """Return the height [m] of the highest point of a body."""
    return float(height_of_top(Boxes.of([body]))[0])


def _at_height(brick: Brick, shift: float) -> Brick:
    x, y, z = brick.position
    return replace(brick, position=(x, y, z + shift))
