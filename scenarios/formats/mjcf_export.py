"""Export of a scene as MJCF, MuJoCo's file format."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree as ET

from scenarios.formats.final_bricks import final_bricks
from scenarios.model import Brick, Scene, World
from scenarios.shapes import Polyhedron
from scenarios.solids import friction_of, moments_of

TORSION = "0.005 0.0001"
"""Torsional and rolling friction: the defaults of MuJoCo, which act in contacts of more dimensions only."""
GROUND_SIZE = "0 0 1"
"""An infinite plane; the last number is the spacing of its grid [m]."""


def to_mjcf(scene: Scene) -> str:
    """Return a scene as the text of an MJCF file.

    The file gives mass and moments of inertia of each brick except the moved bricks, which become mocap bodies. The
    file has no restitution, no actions, and no bricks that the scene removes or pulls out. A pair of bodies has the
    greater coefficient of friction in MuJoCo, but the geometric mean of both coefficients in a scene. Therefore the
    file has a contact pair for each brick and other body with unequal coefficients.
    """
    root = ET.Element("mujoco", model=scene.variant)
    root.append(ET.Comment(f" {scene.expectation.outcome}: {scene.expectation.theory} ".replace("--", "- -")))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    ET.SubElement(root, "option", gravity=_numbers(scene.world.gravity))
    assets, world = ET.SubElement(root, "asset"), ET.SubElement(root, "worldbody")
    plane = {"name": "ground", "type": "plane", "size": GROUND_SIZE}
    ET.SubElement(world, "geom", plane, friction=f"{scene.world.friction!r} {TORSION}")
    named = [(f"fixed_{index}", body) for index, body in enumerate(scene.world.fixed)]
    for name, body in named:
        pose = {"pos": _numbers(body.position), "quat": _numbers(body.quaternion)}
        ET.SubElement(world, "geom", _shape(name, body, assets) | pose, friction=_friction(body, scene.world))
    bricks = [(f"brick_{index}", brick) for index, brick in final_bricks(scene)]
    for name, brick in bricks:
        _add_brick(world, assets, name, brick, scene.world)
    _add_pairs(root, bricks, named, scene.world)
    if not len(assets):
        root.remove(assets)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_brick(world: ET.Element, assets: ET.Element, name: str, brick: Brick, surroundings: World) -> None:
    body = ET.SubElement(world, "body", name=name, pos=_numbers(brick.position), quat=_numbers(brick.quaternion))
    if brick.moved:
        body.set("mocap", "true")
    else:
        ET.SubElement(body, "freejoint", name=f"{name}_free")
        inertia = {"mass": repr(brick.mass), "diaginertia": _numbers(moments_of(brick))}
        ET.SubElement(body, "inertial", inertia, pos="0 0 0")
    ET.SubElement(body, "geom", _shape(name, brick, assets), friction=_friction(brick, surroundings))


def _shape(name: str, brick: Brick, assets: ET.Element) -> dict[str, str]:
    """Return the attributes of a body's geometry, and add the mesh of a polyhedron to ``assets``."""
    x, y, z = (edge / 2 for edge in brick.size)
    if isinstance(brick.shape, Polyhedron):
        vertices = " ".join(_numbers(vertex) for vertex in brick.shape.vertices)
        ET.SubElement(assets, "mesh", name=f"{name}_hull", vertex=vertices)
        return {"name": f"{name}_shape", "type": "mesh", "mesh": f"{name}_hull"}
    size = {"box": (x, y, z), "sphere": (x,), "cylinder": (x, z), "capsule": (x, z - x)}[brick.shape]
    return {"name": f"{name}_shape", "type": brick.shape, "size": _numbers(size)}


def _friction(brick: Brick, world: World) -> str:
    return f"{friction_of(brick, world)!r} {TORSION}"


def _add_pairs(
    root: ET.Element,
    bricks: Sequence[tuple[str, Brick]],
    fixed: Sequence[tuple[str, Brick]],
    world: World,
) -> None:
    """Add a contact pair with the geometric mean for each brick and other body with unequal coefficients."""
    own = [(f"{name}_shape", friction_of(brick, world)) for name, brick in bricks]
    others = [("ground", world.friction), *((f"{name}_shape", friction_of(body, world)) for name, body in fixed)]
    pairs = [
        (first, second)
        for index, first in enumerate(own)
        for second in (*own[index + 1 :], *others)
        if first[1] != second[1]
    ]
    if pairs:
        contact = ET.SubElement(root, "contact")
        for (first, one), (second, other) in pairs:
            mean = math.sqrt(one * other)
            ET.SubElement(contact, "pair", geom1=first, geom2=second, friction=f"{mean!r} {mean!r} {TORSION} 0.0001")


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
