"""OpenUSD there and back, in single precision where the physics schema is."""

import pytest

from scenarios.formats.usd_export import to_usd
from scenarios.formats.usd_import import ImportRefusedError, read_usd
from scenarios.registry import build
from scenarios.solids import moments_of

pytest.importorskip("pxr")

SINGLE = 1e-6
"""Relative error of numbers in single precision."""


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("leaning_drums", {"drums": 2}),
        ("leaning_drums", {"drums": 2, "shape": "hexagon"}),
        ("log_pile", {"rows": 2}),
        ("ball_pyramid", {}),
        ("dome_ring", {"stones": 5}),
    ],
)
def test_a_round_trip_keeps_the_bodies(name, parameters, tmp_path):
    scene = build(name, **parameters)
    path = tmp_path / "scene.usda"
    path.write_text(to_usd(scene), encoding="utf-8")
    found = read_usd(path)
    assert len(found.world.fixed) == len(scene.world.fixed)
    assert found.world.friction == pytest.approx(scene.world.friction, rel=SINGLE)
    assert found.world.gravity == pytest.approx(scene.world.gravity, rel=SINGLE)
    for brick, planned in zip(found.bricks, scene.bricks, strict=True):
        assert brick.position == pytest.approx(planned.position, abs=1e-7)
        assert brick.mass == pytest.approx(planned.mass, rel=SINGLE)
        assert moments_of(brick) == pytest.approx(moments_of(planned), rel=2 * SINGLE)
        assert brick.size == pytest.approx(planned.size, rel=SINGLE)


def test_a_joint_is_refused_by_name(tmp_path):
    path = tmp_path / "scene.usda"
    text = to_usd(build("leaning_drums", drums=2))
    path.write_text(
        text.rstrip().removesuffix("}") + '    def PhysicsFixedJoint "weld"\n    {\n    }\n}\n', encoding="utf-8"
    )
    with pytest.raises(ImportRefusedError, match=r"joint '/scene/weld': .* remove the joint"):
        read_usd(path)


def test_a_stage_with_y_up_is_refused(tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text(to_usd(build("leaning_drums", drums=2)).replace('upAxis = "Z"', 'upAxis = "Y"'), encoding="utf-8")
    with pytest.raises(ImportRefusedError, match="up axis of the stage is y: set upAxis to Z"):
        read_usd(path)


def test_masses_in_grams_become_kilograms(tmp_path):
    """The schema gives masses, densities and moments of inertia in kilogramsPerUnit."""
    scene = build("leaning_drums", drums=2)
    path = tmp_path / "scene.usda"
    path.write_text(to_usd(scene).replace("kilogramsPerUnit = 1", "kilogramsPerUnit = 0.001"), encoding="utf-8")
    for brick, planned in zip(read_usd(path).bricks, scene.bricks, strict=True):
        assert brick.mass == pytest.approx(planned.mass / 1000, rel=SINGLE)
        assert moments_of(brick) == pytest.approx([m / 1000 for m in moments_of(planned)], rel=2 * SINGLE)


def with_plane(position: str, axis: str) -> str:
    """Return the text of a scene with a second plane."""
    text = to_usd(build("leaning_drums", drums=2)).rstrip().removesuffix("}")
    return f"""{text}    def Plane "second" (prepend apiSchemas = ["PhysicsCollisionAPI"])
    {{
        uniform token axis = "{axis}"
        double3 xformOp:translate = {position}
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }}
}}
"""


@pytest.mark.parametrize(
    ("position", "axis", "message"),
    [
        ("(0, 0, 0)", "X", r"plane '/scene/second' has the normal \[1.0, 0.0, 0.0\].* turn the plane's normal to z"),
        ("(0, 0, 0.5)", "Z", r"planes '/scene/ground' and '/scene/second' have different heights.* fixed Cube"),
    ],
)
def test_a_plane_that_cannot_be_the_ground_is_refused(position, axis, message, tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text(with_plane(position, axis), encoding="utf-8")
    with pytest.raises(ImportRefusedError, match=message):
        read_usd(path)


def test_two_planes_of_one_height_are_one_ground(tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text(with_plane("(3, 0, 0)", "Z"), encoding="utf-8")
    assert read_usd(path).world.fixed == ()
