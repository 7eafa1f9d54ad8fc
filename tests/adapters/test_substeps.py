"""The order of a frame's hooks, and what is recorded: only while the port is read and a body is live."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from adapters.profile import Capabilities, Profile
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, World
from stability_core.port import Contacts

BRICK = Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.05))


class Traced(SubstepSimulation):
    """Writes down which hook was called; its bodies move by their number of substeps."""

    engine: ClassVar[str] = "bullet"
    iterations: ClassVar[str] = "none"
    profiles: ClassVar = {"game": Profile("game", "", 3)}
    capabilities: ClassVar[Capabilities] = Capabilities(
        contact_points="", near_contacts=True, separation=True, relative_velocity="", forces="normal", freeze="",
        frozen_contacts=False, friction_law="", moved="", deterministic="across processes",
    )  # fmt: skip

    def __init__(self) -> None:
        super().__init__(self.profiles["game"], World(), "off", ())
        self.calls: list[str] = []
        self.steps = 0

    def _begin_frame(self, substep_s):
        self.calls.append(f"begin {substep_s:.3g}")

    def _forces_of_substep(self):
        self.calls.append("forces")

    def _substep(self):
        self.calls.append("substep")
        self.steps += 1

    def _end_frame(self):
        self.calls.append("end")

    def _press(self, body, force):
        self.calls.append("press")

    def _poses(self, bodies):
        return np.full((len(bodies), 3), float(self.steps)), np.tile((1.0, 0.0, 0.0, 0.0), (len(bodies), 1))

    def _velocities(self, bodies):
        return np.full((len(bodies), 3), 10.0 * self.steps), np.zeros((len(bodies), 3))

    def _contacts(self):
        return Contacts.empty()

    def _nothing(self, *_):
        pass

    _open = _spawn = _spawn_moved = _remove = _move = _push = _drive = _set_gravity = _freeze = _unfreeze = _close = (
        _nothing
    )
    _find_contacts = _contacts


def test_the_hooks_of_a_frame_come_in_this_order() -> None:
    simulation = Traced()
    assert simulation.port is not None
    body = simulation.spawn(BRICK)
    simulation.apply_force(body, (1.0, 0.0, 0.0))
    simulation.step(0.3)
    assert simulation.calls == [
        "begin 0.1", "press", "substep", "forces", "press", "substep", "forces", "press", "substep", "end",
    ]  # fmt: skip


@pytest.mark.parametrize("is_removed", [False, True])
def test_a_force_on_a_frozen_body_ends_without_a_call_of_the_engine(is_removed: bool) -> None:
    """It ended there when the body was frozen; PhysX reports a force on a kinematic body as a critical error."""
    simulation = Traced()
    body = simulation.spawn(BRICK)
    simulation.apply_force(body, (1.0, 0.0, 0.0))
    simulation.port.sleep([body])
    assert simulation.calls == ["press"]
    if is_removed:
        simulation.remove(body)
    else:
        simulation.apply_force(body, (0.0, 0.0, 0.0))
    assert simulation.calls == ["press"]


def test_motions_are_those_before_each_substep() -> None:
    simulation = Traced()
    assert simulation.port is not None
    simulation.spawn(BRICK)
    simulation.step(0.3)
    assert simulation._before is not None
    assert simulation._before.body.tolist() == [0]
    assert simulation._before.position[:, 0, 0].tolist() == [0.0, 1.0, 2.0]
    assert simulation._before.linear[:, 0, 0].tolist() == [0.0, 10.0, 20.0]


@pytest.mark.parametrize(("is_read", "is_live"), [(False, True), (True, False)])
def test_nothing_is_recorded_that_nobody_can_read(is_read: bool, is_live: bool) -> None:
    simulation = Traced()
    if is_read:
        assert simulation.port is not None
    body = simulation.spawn(BRICK)
    if not is_live:
        simulation.port.sleep([body])
    simulation.step(0.3)
    assert simulation.calls == ["begin 0.1", "substep", "substep", "substep", "end"]
    assert simulation._before is None


def test_a_moved_body_is_recorded_at_the_velocity_at_which_it_is_driven() -> None:
    simulation = Traced()
    assert simulation.port is not None
    simulation.spawn(BRICK)
    lift = simulation.spawn(Brick(BRICK.size, 1.0, (0.0, 0.0, 1.0), moved=True))
    simulation.drive(lift, (0.0, 0.0, 0.5), (0.0, 0.2, 0.0))
    simulation.step(0.3)
    assert simulation._before is not None
    assert simulation._before.linear[:, 1].tolist() == [[0.0, 0.0, 0.5]] * 3
    assert simulation._before.angular[:, 1].tolist() == [[0.0, 0.2, 0.0]] * 3
