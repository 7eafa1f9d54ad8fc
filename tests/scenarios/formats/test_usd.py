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
