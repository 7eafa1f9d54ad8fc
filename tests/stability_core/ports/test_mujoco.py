"""An extension on a MuJoCo simulation that a user owns."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from stability_core.ports import Attachment, attach  # noqa: E402
from stability_core.ports.mujoco import prepare  # noqa: E402

HEIGHT = 0.06
HEXAGON = " ".join(
    f"{0.05 * np.cos(angle)} {0.05 * np.sin(angle)} {z}" for z in (-0.03, 0.03) for angle in np.arange(6) * np.pi / 3
)
GEOMS = {
    "box": '<geom type="box" size=".05 .05 .03" mass=".5"/>',
    "cylinder": '<geom type="cylinder" size=".05 .03" mass=".5"/>',
    "mesh": '<geom type="mesh" mesh="hexagon" mass=".5"/>',
}


def brick(name: str, x: float, z: float, kind: str = "box") -> str:
    return f'<body name="{name}" pos="{x} 0 {z}"><freejoint/>{GEOMS[kind]}</body>'


def world(*bodies: str, more: str = "", option: str = "") -> str:
    return f"""<mujoco><option {option}/><asset><mesh name="hexagon" vertex="{HEXAGON}"/></asset>
        <worldbody><geom type="plane" size="0 0 1"/>{"".join(bodies)}</worldbody>{more}</mujoco>"""


def tower(count: int, kind: str = "box") -> str:
    return "".join(brick(f"brick{level}", 0.0, (level + 0.5) * HEIGHT, kind) for level in range(count))


def prepared(xml: str, bodies: list[str] | None = None) -> Any:
    spec = prepare(mujoco.MjSpec.from_string(xml), bodies)
    return mujoco.MjData(spec.compile())


def run(data: Any, extension: Attachment, seconds: float) -> None:
    for _ in range(round(seconds / data.model.opt.timestep)):
        mujoco.mj_step(data.model, data)
        extension.update(data.model.opt.timestep)


def place(data: Any, name: str, x: float, z: float) -> int:
    """Set a body down at rest; return its id."""
    body = data.model.body(name).id
    joint = data.joint(int(data.model.body_jntadr[body]))
    joint.qpos[:], joint.qvel[:] = [x, 0.0, z, 1.0, 0.0, 0.0, 0.0], 0.0
    return body


@pytest.mark.parametrize("kind", GEOMS)
def test_a_prebuilt_tower_freezes_before_its_first_step_and_does_not_move(kind: str) -> None:
    data = prepared(world(tower(4, kind)))
    with attach(data) as extension:
        assert len(extension.adopt().frozen) == 4
        before = data.qpos.copy()
        run(data, extension, 0.2)
        mujoco.mj_forward(data.model, data)
        np.testing.assert_array_equal(data.qpos, before)


@pytest.mark.parametrize("kind", GEOMS)
def test_bodies_that_come_one_by_one_stand_on_default_contacts(kind: str) -> None:
    """MuJoCo's contacts are soft as shipped: a box of 0.5 kg sinks by a third of a millimetre, and rests there."""
    data = prepared(world(*(brick(f"brick{k}", 1.0 + k, HEIGHT / 2, kind) for k in range(3))))
    with attach(data, bodies=[]) as extension:
        top = 0.0
        for level in range(3):
            body = place(data, f"brick{level}", 0.0, top + HEIGHT / 2 + 0.0005)
            extension.add([body])
            run(data, extension, 1.0)
            assert body in extension.frozen, extension.why(body)
            top = float(data.xpos[body][2]) + HEIGHT / 2


def test_an_overhang_beyond_the_edge_stays_live_and_falls() -> None:
    """The centre of the upper box lies 1 cm outside its support."""
    data = prepared(world(brick("lower", 0.0, HEIGHT / 2), brick("upper", 0.06, 1.5 * HEIGHT)))
    with attach(data) as extension:
        extension.adopt()
        run(data, extension, 1.0)
        assert data.body("upper").xpos[2] < HEIGHT


def test_other_bodies_touch_a_frozen_body_as_before() -> None:
    """A ball dropped on a frozen tower rests on its ghosts; it is not controlled."""
    sphere = '<geom size=".02" mass=".05" condim="6" friction="1 .01 .01"/>'
    ball = f'<body name="ball" pos="0 0 .3"><freejoint/>{sphere}</body>'
    data = prepared(world(tower(2), ball), ["brick0", "brick1"])
    with attach(data) as extension:
        extension.adopt()
        run(data, extension, 1.0)
        assert data.body("ball").xpos[2] == pytest.approx(2 * HEIGHT + 0.02, abs=2e-3)


def test_a_mocap_platform_that_the_user_lowers_takes_its_tower_along() -> None:
    platform = '<body name="lift" mocap="true" pos="0 0 .5"><geom type="box" size=".1 .1 .03"/></body>'
    data = prepared(world(platform, brick("load", 0.0, 0.5 + HEIGHT)))
    with attach(data) as extension:
        assert len(extension.adopt().frozen) == 1
        for frame in range(250):
            data.mocap_pos[0, 2] = 0.5 - frame * 2e-4
            run(data, extension, 0.002)
        run(data, extension, 0.5)
        assert data.body("load").xpos[2] == pytest.approx(0.5 - 249 * 2e-4 + HEIGHT, abs=2e-3)


def test_a_frozen_body_that_the_user_moves_is_live_at_its_new_place() -> None:
    data = prepared(world(tower(2)))
    with attach(data) as extension:
        extension.adopt()
        body = place(data, "brick1", 1.0, 0.5)
        run(data, extension, 0.1)
        assert body not in extension.frozen
        assert data.body("brick1").xpos[0] == pytest.approx(1.0)
        run(data, extension, 1.0)
        assert data.body("brick1").xpos[2] == pytest.approx(HEIGHT / 2, abs=1e-3)


def test_a_force_on_a_frozen_body_wakes_it() -> None:
    data = prepared(world(tower(1)))
    with attach(data) as extension:
        extension.adopt()
        data.xfrc_applied[data.model.body("brick0").id, 0] = 20.0  # its weight is 4.9 N
        run(data, extension, 0.3)
        assert data.body("brick0").xpos[0] > 0.1


def test_close_returns_every_body_with_its_collisions_and_weight() -> None:
    data = prepared(world(tower(2)))
    model = data.model
    names = (
        "geom_contype",
        "geom_conaffinity",
        "body_contype",
        "body_conaffinity",
        "body_gravcomp",
        "tree_sleep_policy",
    )
    before = [getattr(model, name).copy() for name in names]
    extension = attach(data)
    assert len(extension.adopt().frozen) == 2
    extension.close()
    for name, value in zip(names, before, strict=True):
        np.testing.assert_array_equal(getattr(model, name), value, err_msg=name)


ARM = """<body name="mount" pos="0 .3 0"><body name="arm" pos=".3 0 .3"><joint name="hinge" axis="0 1 0"/>
    <geom type="capsule" size=".02 .1" mass="1"/>
    <body pos="0 0 .12"><joint name="slide" type="slide" axis="0 0 1" range="0 .1" limited="true" stiffness="50"/>
    <geom name="tip" size=".03" mass=".2"/><site name="tip"/></body></body></body>"""
DRIVEN = """<actuator><motor joint="hinge"/></actuator><sensor><accelerometer site="tip"/><jointpos joint="slide"/>
    </sensor>"""


def arm_trajectory(data: Any, extension: Attachment | None) -> np.ndarray:
    rows = []
    for frame in range(500):
        data.ctrl[0] = np.sin(frame / 20)
        mujoco.mj_step(data.model, data)
        if extension is not None:
            extension.update(data.model.opt.timestep)
        rows.append(np.concatenate([data.qpos, data.qvel, data.sensordata]))
    return np.array(rows)


def test_arm_joints_and_sensors_keep_their_trajectories_to_the_bit_while_nothing_is_frozen() -> None:
    """Two boxes fall beside a driven arm. The policy freezes nothing, because no update lists a body at rest."""
    xml = world(ARM, brick("a", 0.0, 3.0), brick("b", -1.0, 5.0), more=DRIVEN)
    alone, attached = prepared(xml, ["a", "b"]), prepared(xml, ["a", "b"])
    with attach(attached) as extension:
        trajectory = arm_trajectory(attached, extension)
        assert not len(extension.frozen)
    np.testing.assert_array_equal(arm_trajectory(alone, None), trajectory)


def test_preparing_a_model_changes_no_motion() -> None:
    """Ghosts and sleep flags leave arm, sensors and falling boxes as in the model that was not prepared."""
    xml = world(ARM, brick("a", 0.0, 0.5), more=DRIVEN)
    plain = mujoco.MjData(mujoco.MjSpec.from_string(xml).compile())
    np.testing.assert_array_equal(arm_trajectory(plain, None), arm_trajectory(prepared(xml, ["a"]), None))


def test_a_cylinder_on_its_side_rolls_down_a_slope_of_two_degrees() -> None:
    """It rests on a line. Within a second it rolls by g sin(2 deg) / 3 = 11 cm; 5 cm at least."""
    body = f'<body name="log" pos="0 0 .05" euler="90 0 0"><freejoint/>{GEOMS["cylinder"]}</body>'
    data = prepared(world(body, option=f'gravity="{9.81 * np.sin(np.radians(2))} 0 -9.81"'))
    with attach(data) as extension:
        assert not extension.adopt().frozen
        run(data, extension, 1.0)
        assert data.body("log").xpos[0] > 0.05
