"""Mistakes of a MuJoCo user: each ends in a message that names the fix."""

from __future__ import annotations

from typing import Any

import pytest

mujoco = pytest.importorskip("mujoco")

from stability_core import ports  # noqa: E402
from stability_core.ports import attach  # noqa: E402
from stability_core.ports.mujoco import prepare  # noqa: E402

BOX = '<geom name="{0}_geom" type="box" size=".05 .05 .05" mass="1"/>'
ARM = '<body name="arm" pos="0 0 1"><joint axis="0 1 0"/><geom size=".05" mass="1"/></body>'


def world(more: str = "", body: str = "cup") -> str:
    return f"""<mujoco><worldbody><geom name="floor" type="plane" size="0 0 1"/>{ARM}
        <body name="{body}" pos="0 0 .05"><freejoint/>{BOX.format(body)}</body></worldbody>{more}</mujoco>"""


def spec_of(xml: str) -> Any:
    return mujoco.MjSpec.from_string(xml)


@pytest.fixture
def data() -> Any:
    return mujoco.MjData(prepare(spec_of(world())).compile())


def test_a_model_without_ghosts() -> None:
    with pytest.raises(ValueError, match=r"no ghosts.*prepare\(spec\); model = spec.compile\(\)"):
        attach(mujoco.MjData(spec_of(world()).compile()))


def test_the_model_in_place_of_its_data(data: Any) -> None:
    with pytest.raises(TypeError, match=r"needs MuJoCo's MjData, got MjModel"):
        attach(data.model)


def test_preparing_twice() -> None:
    with pytest.raises(ValueError, match=r"ghosts already: call prepare\(\) once"):
        prepare(prepare(spec_of(world())))


def test_preparing_an_unknown_body() -> None:
    with pytest.raises(ValueError, match=r"no body 'cop': pass names of bodies that can freeze: 'cup'"):
        prepare(spec_of(world()), ["cop"])


def test_preparing_a_robot() -> None:
    with pytest.raises(ValueError, match=r"'arm' has no free joint.*leaves robots alone"):
        prepare(spec_of(world()), ["arm"])


def test_preparing_a_world_of_robots() -> None:
    with pytest.raises(ValueError, match=r"no body that could freeze.*<freejoint/>"):
        prepare(spec_of(f"<mujoco><worldbody>{ARM}</worldbody></mujoco>"))


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ('<contact><pair geom1="cup_geom" geom2="floor"/></contact>', "explicit contact pair.*delete the <pair>"),
        ('<equality><weld body1="cup" body2="arm"/></equality>', "equality constraint.*delete the constraint"),
    ],
)
def test_preparing_a_body_that_something_else_holds(more: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        prepare(spec_of(world(more)), ["cup"])


def test_a_body_that_was_not_prepared(data: Any) -> None:
    with pytest.raises(ValueError, match=r"body 'arm' has no ghost.*pass one of 'cup'"):
        attach(data, bodies=["arm"])


def test_a_wrong_time(data: Any) -> None:
    with attach(data) as extension:
        for _ in range(2):
            mujoco.mj_step(data.model, data)
        with pytest.raises(ValueError, match=r"advanced by 0.004 s.*dt is 0.002 s: call update"):
            extension.update(0.002)


def test_an_update_before_the_step(data: Any) -> None:
    with attach(data) as extension, pytest.raises(ValueError, match=r"advanced by 0 s.*after mj_step"):
        extension.update(0.002)


def test_a_reset_behind_its_back(data: Any) -> None:
    with attach(data) as extension:
        mujoco.mj_step(data.model, data)
        extension.update(0.002)
        mujoco.mj_resetData(data.model, data)
        with pytest.raises(ValueError, match=r"went back.*call close\(\) of the extension before a reset"):
            extension.update(0.002)


def test_a_velocity_that_is_not_finite(data: Any) -> None:
    with attach(data) as extension:
        mujoco.mj_step(data.model, data)
        data.qvel[-1] = float("nan")
        with pytest.raises(ValueError, match=r"body .cup. of this .*diverged or .*: use a smaller timestep"):
            extension.update(0.002)


def test_two_attachments(data: Any) -> None:
    with attach(data), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(data)


def test_no_gravity() -> None:
    model = prepare(spec_of(world())).compile()
    model.opt.gravity[:] = 0.0
    with pytest.raises(ValueError, match="no gravity"):
        attach(mujoco.MjData(model))


def test_gravity_along_y_is_followed() -> None:
    """The floor is a wall, and the box stands on it."""
    xml = """<mujoco><option gravity="0 -9.81 0"/><worldbody><geom type="plane" size="0 0 1" zaxis="0 1 0"/>
        <body pos="0 .05 2"><freejoint/><geom type="box" size=".05 .05 .05" mass="1"/></body></worldbody></mujoco>"""
    data = mujoco.MjData(prepare(spec_of(xml)).compile())
    with attach(data) as extension:
        assert len(extension.adopt().frozen) == 1


def test_an_engine_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named {name!r}", name="mujoco")

    monkeypatch.setattr(ports.importlib, "import_module", missing)
    with pytest.raises(ImportError, match=r"pip install 'stability-core\[mujoco\]'"):
        ports.__getattr__("mujoco")


def test_a_port_that_does_not_exist() -> None:
    with pytest.raises(AttributeError, match="use one of the ports pybullet, mujoco, sapien, rapier"):
        _ = ports.havok
