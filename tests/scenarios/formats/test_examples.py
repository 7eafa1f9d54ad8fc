"""Small files of the kind that people stack with, written for this suite, from the file to the judge's answer."""

import importlib.util

import pytest

from scenarios.registry import build
from scenarios.scenes.from_file import EXAMPLES

NEEDS_USD = pytest.mark.skipif(importlib.util.find_spec("pxr") is None, reason="OpenUSD is not installed (group usd)")


@pytest.mark.parametrize(
    ("file", "bricks", "fixed", "outcome"),
    [
        ("robot_cubes.xml", 2, 1, "stand"),
        ("four_blocks.xml", 4, 0, "fall"),
        ("cans.xml", 3, 1, "stand"),
        ("prisms.xml", 3, 0, "stand"),
        ("logs.xml", 3, 2, "stand"),
        ("jenga_block.urdf", 1, 0, "stand"),
        ("jenga_levels.urdf", 6, 0, "stand"),
        pytest.param("crates.usda", 3, 0, "stand", marks=NEEDS_USD),
    ],
)
def test_a_file_becomes_a_judged_scene(file, bricks, fixed, outcome):
    scene = build("own_scene", file=file)
    assert (len(scene.bricks), len(scene.world.fixed)) == (bricks, fixed)
    assert scene.expectation.outcome == outcome
    assert scene.variant.startswith(f"own_scene-{file.partition('.')[0]}-")


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("arm_and_cube.xml", "hinge joint 'shoulder' of body 'arm': .* use a freejoint, or remove the joint"),
        ("bracket.xml", "mesh of 'bracket' is not convex, .* replace the mesh by its convex hull"),
        ("box_world.sdf", "SDF has no maintained parser .* convert the file to URDF or MJCF"),
    ],
)
def test_a_refusal_names_the_element_and_the_fix(file, message):
    with pytest.raises(ValueError, match=message):
        build("own_scene", file=file)


def test_every_change_is_reported():
    cubes = build("own_scene", file="robot_cubes.xml").look_for
    assert "visual geometries of 'cube_a' left out" in cubes
    assert "cube_a moved by (0.000, 0.000, -0.500) mm" in cubes
    assert "shifted by 0.5 m along z" in build("own_scene", file="four_blocks.xml").look_for
    assert "geometric mean" in build("own_scene", file="cans.xml").look_for


def test_no_example_was_forgotten():
    others = {path.name for path in EXAMPLES.iterdir() if path.suffix != ".toml"}
    assert len(others) == 11
