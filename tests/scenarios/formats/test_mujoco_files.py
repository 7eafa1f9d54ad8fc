"""MJCF and URDF: each element becomes what it says, or is refused; a round trip keeps poses, masses, inertia."""

import math
from dataclasses import replace

import numpy as np
import pytest

from scenarios.formats.imported import ImportRefusedError
from scenarios.formats.mjcf_export import to_mjcf
from scenarios.formats.mujoco_files import read_mujoco_file
from scenarios.formats.urdf_export import ExportRefusedError, to_urdf
from scenarios.model import Place, World
from scenarios.registry import build
from scenarios.solids import moments_of

KEPT = 1e-9
"""Relative error of a round trip: numbers have all their digits in the file."""
SINGLE = 1e-7
"""Relative error of a mesh's vertices, which MuJoCo keeps in single precision."""
FLOOR = "<geom type='plane' size='1 1 .1'/>"
BOX = "<geom type='box' size='.1 .1 .1' mass='1'/>"


@pytest.fixture
def read(tmp_path):
    def read(content: str, suffix: str = ".xml"):
        path = tmp_path / f"file{suffix}"
        path.write_text(content, encoding="utf-8")
        return read_mujoco_file(path)

    return read


def world(*bodies: str, rest: str = "") -> str:
    return f"<mujoco><worldbody>{FLOOR}{''.join(bodies)}</worldbody>{rest}</mujoco>"


def body(inside: str = BOX, name: str = "b", where: str = "pos='0 0 .1'") -> str:
    return f"<body name='{name}' {where}><freejoint/>{inside}</body>"


SCENES = [
    build("leaning_drums", drums=3),
    build("leaning_drums", drums=3, shape="hexagon"),
    build("groove", body="wedge"),
    build("groove"),
    build("ball_pyramid"),
    build("dome_ring", stones=5),
    build("log_pile", rows=2),
    build("card_house"),
]


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.variant)
def test_a_round_trip_keeps_poses_masses_and_inertia(scene, read):
    first = read(to_mjcf(scene))
    for found, planned in zip(first.bricks, scene.bricks, strict=True):
        assert found.position == pytest.approx(planned.position, abs=KEPT)
        sign = math.copysign(1.0, np.dot(found.quaternion, planned.quaternion))
        assert found.quaternion == pytest.approx(tuple(sign * part for part in planned.quaternion), abs=KEPT)
        assert found.mass == pytest.approx(planned.mass, rel=KEPT)
        assert moments_of(found) == pytest.approx(moments_of(planned), rel=KEPT)
        assert found.size == pytest.approx(planned.size, rel=SINGLE)
    assert first.world.friction == pytest.approx(scene.world.friction, rel=KEPT)
    assert first.world.gravity == scene.world.gravity
    assert len(first.world.fixed) == len(scene.world.fixed)
    again = read(to_mjcf(replace(scene, actions=(Place(0.0, first.bricks, 0.0),), world=first.world)))
    for found, before in zip(again.bricks, first.bricks, strict=True):
        assert found.position == pytest.approx(before.position, abs=KEPT)
        assert moments_of(found) == pytest.approx(moments_of(before), rel=KEPT)


def test_a_urdf_keeps_poses_masses_and_inertia(read):
    scene = build("log_pile", rows=2)
    for found, planned in zip(read(to_urdf(scene), ".urdf").bricks, scene.bricks, strict=True):
        assert found.position == pytest.approx(planned.position, abs=KEPT)
        assert moments_of(found) == pytest.approx(moments_of(planned), rel=KEPT)
    with pytest.raises(ExportRefusedError, match=r"brick_0 is a polyhedron, .* export --mjcf"):
        to_urdf(build("groove", body="wedge"))


def test_unequal_friction_becomes_contact_pairs():
    scene = build("leaning_drums", drums=2)
    actions = tuple(replace(action, bricks=(replace(action.bricks[0], friction=0.2),)) for action in scene.actions)
    text = to_mjcf(replace(scene, actions=actions, world=World(friction=0.8)))
    assert text.count("<pair") == 2  # each drum on the ground; both drums have the same coefficient
    assert f'friction="{math.sqrt(0.2 * 0.8)!r}' in text


def test_an_inertia_given_by_hand_is_kept(read):
    given = "<inertial pos='0 0 0' mass='2' diaginertia='.01 .02 .025'/><geom type='box' size='.1 .1 .1'/>"
    (brick,) = read(world(body(given))).bricks
    assert (brick.mass, brick.moments) == (2.0, pytest.approx((0.01, 0.02, 0.025)))
    off = given.replace("0 0 0", "0 0 .02")
    with pytest.raises(
        ImportRefusedError, match=r"centre of mass of body 'b' is 20 mm .* remove the body's <inertial>"
    ):
        read(world(body(off)))
    turned = given.replace("mass", "quat='.9 .1 .4 0' mass")
    with pytest.raises(
        ImportRefusedError, match=r"principal axes of inertia of body 'b' .* remove the body's <inertial>"
    ):
        read(world(body(turned)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (world(body(), rest="<actuator><general name='a' body='b'/></actuator>"), "actuator 'a'.* remove the actuator"),
        (
            world(
                body(),
                body(name="c", where="pos='1 0 .1'"),
                rest="<equality><weld name='w' body1='b' body2='c'/></equality>",
            ),
            "equality constraint 'w'",
        ),
        (world("<body name='b'><joint name='j' type='slide'/>" + BOX + "</body>"), "slide joint 'j' of body 'b'"),
        (world(body("<geom type='ellipsoid' size='.1 .1 .2' name='egg'/>")), "'egg' is of type ellipsoid: use a box"),
        (world(body(BOX + BOX)), "body 'b' has 2 collision geometries, .* contype and conaffinity"),
        (world(BOX), "no body with a free joint"),
        (
            world(body(), "<geom name='ramp' type='plane' size='1 1 1' euler='0 10 0'/>"),
            "plane 'ramp' is not level or faces down, with the normal .0.17",
        ),
        ("<mujoco><worldbody", "MuJoCo cannot read the file"),
    ],
)
def test_a_refusal_names_the_element_and_the_fix(content, message, read):
    with pytest.raises(ImportRefusedError, match=message):
        read(content)


def test_a_root_link_is_free_unless_it_is_the_world(read):
    inertia = "<mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    shape = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
    base = f"<link name='base'><inertial>{inertia}</inertial>{shape}</link>"
    assert len(read(f"<robot name='r'>{base}</robot>", ".urdf").bricks) == 1
    fixed = "<joint name='j' type='fixed'><parent link='world'/><child link='base'/></joint>"
    with pytest.raises(ImportRefusedError, match="no body with a free joint"):
        read(f"<robot name='r'><link name='world'/>{base}{fixed}</robot>", ".urdf")


@pytest.mark.slow
def test_a_fixed_mesh_that_is_not_convex_is_split(read):
    pytest.importorskip("coacd")
    from scenarios.scenes.from_file import EXAMPLES

    bracket = (EXAMPLES / "bracket.xml").read_text(encoding="utf-8")
    fixed = bracket.replace('<body name="bracket"><freejoint/>', "").replace("</body>", body(where="pos='0 0 1'"))
    content = read(fixed)
    assert 2 <= len(content.world.fixed) <= 8
    assert "became" in content.notes[0]


def test_a_floating_joint_below_a_named_root_is_refused(read):
    """MuJoCo's own message names neither the joint nor the fix."""
    inertia = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
    box = f"<link name='box'>{inertia}<collision><geometry><box size='1 1 1'/></geometry></collision></link>"
    joint = "<joint name='free' type='floating'><parent link='base'/><child link='box'/></joint>"
    text = f"<robot name='r'><link name='base'/>{box}{joint}</robot>"
    with pytest.raises(ImportRefusedError, match=r"floating joint 'free' .* name the root link 'world'"):
        read(text, ".urdf")
    assert len(read(text.replace("'base'", "'world'"), ".urdf").bricks) == 1
