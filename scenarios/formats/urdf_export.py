"""Export of a scene as URDF, the unified robot description format.

The floating links are the bricks. The fixed links are the fixed bodies and a box that stands for the ground.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.etree import ElementTree as ET

import numpy as np

from scenarios.formats.final_bricks import final_bricks
from scenarios.formats.imported import ExportRefusedError
from scenarios.geometry import rotation
from scenarios.model import Brick, Quaternion, Scene
from scenarios.shapes import name_of
from scenarios.solids import moments_of

GROUND: tuple[float, float, float] = (100.0, 100.0, 1.0)
"""Edge lengths [m] of the box that stands for the ground, because URDF has no plane."""


def to_urdf(scene: Scene) -> str:
    """Return a scene as the text of a URDF file.

    The file has gravity and the world's friction in a comment only. The file has no restitution, no actions, and no
    bricks that the scene removes or pulls out.

    Raises:
        ExportRefusedError: if a body is a capsule or a polyhedron, because URDF describes these shapes by mesh files
            only; the message names the body and the fix.
    """
    root = ET.Element("robot", name=scene.variant)
    root.append(ET.Comment(f" gravity {scene.world.gravity} m/s2, friction {scene.world.friction} for every pair "))
    ET.SubElement(root, "link", name="world")
    ground = Brick(GROUND, 1.0, (0.0, 0.0, -GROUND[2] / 2))
    for name, body in (("ground", ground), *((f"fixed_{i}", body) for i, body in enumerate(scene.world.fixed))):
        _add_link(root, name, body, is_free=False)
    for index, brick in final_bricks(scene):
        _add_link(root, f"brick_{index}", brick, is_free=True)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_link(root: ET.Element, name: str, body: Brick, *, is_free: bool) -> None:
    link = ET.SubElement(root, "link", name=name)
    if is_free:
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "mass", value=repr(body.mass))
        x, y, z = moments_of(body)
        ET.SubElement(inertial, "inertia", ixx=repr(x), iyy=repr(y), izz=repr(z), ixy="0", ixz="0", iyz="0")
    for part in ("visual", "collision"):
        _add_geometry(ET.SubElement(ET.SubElement(link, part), "geometry"), name, body)
    joint = ET.SubElement(root, "joint", name=f"{name}_joint", type="floating" if is_free else "fixed")
    ET.SubElement(joint, "parent", link="world")
    ET.SubElement(joint, "child", link=name)
    ET.SubElement(joint, "origin", xyz=_numbers(body.position), rpy=_numbers(_angles(body.quaternion)))


def _add_geometry(geometry: ET.Element, name: str, body: Brick) -> None:
    x, _, z = body.size
    match body.shape:
        case "box":
            ET.SubElement(geometry, "box", size=_numbers(body.size))
        case "cylinder":
            ET.SubElement(geometry, "cylinder", radius=repr(x / 2), length=repr(z))
        case "sphere":
            ET.SubElement(geometry, "sphere", radius=repr(x / 2))
        case _:
            raise ExportRefusedError(
                f"{name} is a {name_of(body.shape)}, which URDF describes by a mesh file only: export the scene as "
                "MJCF (bench export --mjcf)"
            )


def _angles(quaternion: Quaternion) -> tuple[float, float, float]:
    """Return the angles [rad] of a quaternion's turns about the world's axes x, y and z, in this order."""
    matrix = rotation(np.array([quaternion]))[0]
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    if math.hypot(matrix[0, 0], matrix[1, 0]) < 1e-9:  # straight up or down: x and z turn about the same axis
        return math.atan2(-matrix[1, 2], matrix[1, 1]), pitch, 0.0
    return math.atan2(matrix[2, 1], matrix[2, 2]), pitch, math.atan2(matrix[1, 0], matrix[0, 0])


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
