"""Bricks of other shapes than boxes keep the contract, on every engine that builds them; a broken adapter is caught."""

from dataclasses import replace

import numpy as np
import pybullet
import pytest

from adapters import ENGINES, EngineNotInstalledError, capabilities
from adapters._bullet import BulletSimulation
from adapters.conformance import CHECKS, Check
from scenarios.model import Brick
from scenarios.solids import enlarged, moments_of
from stability_core.port import Contacts
from tests.adapters.broken import assert_caught

CHECK = {check.name: check for check in CHECKS if check.measure.__module__ == "adapters.conformance.shapes"}
OFTEN = {("rapier", "freezes_every_shape"), ("bullet", "seats_every_shape"), ("mujoco", "rolls_down_a_slope")}
"""Checks of the default suite: one engine each, because every check costs up to a second."""
KNOWN = {
    (
        "bullet",
        "game@scale=100",
        "reports_where_every_shape_stands",
    ): "Bullet keeps a point 3 mm behind a lying cylinder that rolls by itself",
    ("bullet", "game", "slides_on_every_flat_face"): "Bullet keeps outdated points on the rim of a sliding cylinder",
    ("bullet", "tuned", "slides_on_every_flat_face"): "Bullet keeps outdated points on the rim of a sliding cylinder",
    ("rapier", "tuned", "rolls_down_a_slope"): "Parry keeps the points of a rolling cylinder: it gains 93 %",
}


def cases() -> list[pytest.param]:
    return [
        pytest.param(
            engine, profile, check, marks=() if (engine, check) in OFTEN and profile == "game" else pytest.mark.full
        )
        for engine in ENGINES
        for profile in ("game", "tuned", "default", "game@scale=100")
        for check in CHECK
    ]


@pytest.mark.parametrize(("engine", "profile", "check"), cases())
def test_engine_keeps_the_contract_of_shapes(engine: str, profile: str, check: str) -> None:
    try:
        applies = len(capabilities(engine).shapes) > 1 and CHECK[check].applies(engine, profile)
    except EngineNotInstalledError:
        applies = False
    if not applies:
        pytest.skip("not asked of this engine under this profile")
    if (engine, profile, check) in KNOWN:
        pytest.xfail(KNOWN[engine, profile, check])
    CHECK[check].run(engine, profile)


class Shrunken(BulletSimulation):
    """Bodies of other shapes than boxes are a tenth too small."""

    def _spawn(self, body: int, brick: Brick) -> None:
        super()._spawn(body, brick if brick.shape == "box" else enlarged(brick, 0.9))


class GhostsWhenFrozen(BulletSimulation):
    """Nothing collides with a frozen body."""

    def _freeze(self, body: int) -> None:
        super()._freeze(body)
        pybullet.setCollisionFilterGroupMask(self._handles[body], -1, 0, 0, self._client)


class TiltedNormals(BulletSimulation):
    """Normals lean by 2 deg, as at outdated contacts."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        lean = np.array([[0.9994, 0.0, 0.0349], [0.0, 1.0, 0.0], [-0.0349, 0.0, 0.9994]])
        return replace(contacts, normal=contacts.normal @ lean)


class Smooth(BulletSimulation):
    def _spawn(self, body: int, brick: Brick) -> None:
        super()._spawn(body, replace(brick, friction=0.2))


class Hollow(BulletSimulation):
    """Moments of inertia are a third too large, as of a hollow body."""

    def _spawn(self, body: int, brick: Brick) -> None:
        first, second, third = moments_of(brick)
        super()._spawn(body, replace(brick, moments=(4 / 3 * first, 4 / 3 * second, 4 / 3 * third)))


class Drifting(BulletSimulation):
    """A frozen body stays live, without weight."""

    def _freeze(self, body: int) -> None:
        pybullet.changeDynamics(self._handles[body], -1, linearDamping=0.9, physicsClientId=self._client)


class FrictionOfTheWorld(BulletSimulation):
    def _spawn(self, body: int, brick: Brick) -> None:
        super()._spawn(body, replace(brick, friction=None))


class Dead(BulletSimulation):
    def _spawn(self, body: int, brick: Brick) -> None:
        super()._spawn(body, replace(brick, restitution=0.0))


BROKEN = [
    (Shrunken, "seats_every_shape"),
    (GhostsWhenFrozen, "carries_every_shape_on_every_shape"),
    (TiltedNormals, "reports_where_every_shape_stands"),
    (Smooth, "slides_on_every_flat_face"),
    (Hollow, "rolls_down_a_slope"),
    (Drifting, "freezes_every_shape"),
    (FrictionOfTheWorld, "has_the_friction_of_a_pair"),
    (Dead, "bounces_with_the_restitution_of_a_pair"),
]


@pytest.mark.parametrize(("broken", "check"), BROKEN)
def test_a_broken_adapter_is_caught(broken: type[BulletSimulation], check: str) -> None:
    assert_caught(broken, CHECK[check])


def test_every_check_of_shapes_is_known_to_catch_something() -> None:
    assert {check for _, check in BROKEN} == set(CHECK)
    assert all(isinstance(check, Check) for check in CHECK.values())
