"""The checks of joints are worth something only if they fail on a wrong adapter: each is shown one that is broken."""

from collections.abc import Iterable

import numpy as np
import pybullet
import pytest

from adapters._bullet import BulletSimulation
from adapters.conformance import CHECKS
from adapters.hooks import Pair
from adapters.port import EnginePort
from stability_core.port import Contacts
from tests.adapters.broken import assert_caught

CHECK = {check.name: check for check in CHECKS if check.measure.__module__ == "adapters.conformance.welds"}


class FixedConstraint(BulletSimulation):
    """Joins by Bullet's own fixed constraint, which ignores orientations."""

    def _join(self, pair: Pair) -> None:
        first, second = (self._handles[body] for body in pair)
        a, b = (pybullet.getBasePositionAndOrientation(handle, self._client) for handle in (first, second))
        place, turn = pybullet.multiplyTransforms(*pybullet.invertTransform(*a), *b)
        kind, none = pybullet.JOINT_FIXED, (0.0, 0.0, 0.0)
        joint = pybullet.createConstraint(
            first, -1, second, -1, kind, none, place, none, turn, physicsClientId=self._client
        )
        self._engine._joints[pair] = [joint]


class OnePoint(BulletSimulation):
    """A hinge in all directions."""

    def _join(self, pair: Pair) -> None:
        super()._join(pair)
        for joint in self._engine._joints[pair][1:]:
            pybullet.removeConstraint(joint, self._client)
        del self._engine._joints[pair][1:]


class NeverParts(BulletSimulation):
    def _part(self, pair: Pair) -> None: ...


class NeverJoins(BulletSimulation):
    def _join(self, pair: Pair) -> None: ...

    def _part(self, pair: Pair) -> None: ...


class ForgetsItsPairs(EnginePort):
    """Joins a joined pair once more."""

    def join(self, pairs: Iterable[Pair]) -> None:
        for a, b in pairs:
            self._joined.discard((min(a, b), max(a, b)))
            super().join([(a, b)])


class KeepsJoints(EnginePort):
    """Joints outlive the freezing of their bodies."""

    def part_from_all(self, body: int) -> None: ...


class DropsContacts(EnginePort):
    """Lists no contact of a joined pair once a joint of one of its bodies was parted."""

    def part(self, pairs: Iterable[Pair]) -> None:
        listed = list(pairs)
        super().part(listed)
        self._filtered = {body for pair in listed for body in pair}

    def contacts(self) -> Contacts:
        contacts, filtered = super().contacts(), getattr(self, "_filtered", set())
        bodies = zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
        is_kept = [(a, b) not in self._joined or filtered.isdisjoint((a, b)) for a, b in bodies]
        return contacts.chosen(np.array(is_kept, np.bool_))


class RefusesNothing(EnginePort):
    def join(self, pairs: Iterable[Pair]) -> None: ...


BROKEN = [
    (FixedConstraint, "keeps_the_turn_of_a_joined_plank"),
    (OnePoint, "holds_an_overhanging_plank"),
    (OnePoint, "moves_as_one_body"),
    (OnePoint, "holds_a_chain_of_ten"),
    (NeverJoins, "holds_an_overhanging_plank"),
    (NeverParts, "holds_an_overhanging_plank"),
    (ForgetsItsPairs, "joins_once"),
    (DropsContacts, "keeps_the_contacts_of_joined_planks"),
    (KeepsJoints, "ends_joints_with_their_bodies"),
    (RefusesNothing, "refuses_to_join_what_is_not_live"),
    (RefusesNothing, "refuses_to_join"),
]


@pytest.mark.parametrize(("broken", "check"), BROKEN)
def test_a_broken_joint_is_caught(broken: type[BulletSimulation | EnginePort], check: str) -> None:
    assert_caught(broken, CHECK[check])


def test_every_check_of_joints_is_known_to_catch_something() -> None:
    assert {check for _, check in BROKEN} == set(CHECK)
