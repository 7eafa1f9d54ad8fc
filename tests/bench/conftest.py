"""An engine that needs no engine: bricks stay where they are put unless a test moves them."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import pytest

from adapters.base import Capabilities, Profile, Simulation
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import Contacts, FloatArray, IntArray


class FakeSimulation(Simulation):
    """Bricks hang where they were let go; ``on_step(simulation, step)`` may move them by hand or raise."""

    engine: ClassVar[str] = "bullet"  # a registered name, so that records can be made
    capabilities: ClassVar[Capabilities] = Capabilities("none", True, "reported", False, "exact", False, "none", "yes")
    profiles: ClassVar[Mapping[str, Profile]] = {"game": Profile("game", "", 1)}

    def __init__(self, on_step=lambda *_: None) -> None:
        super().__init__(self.profiles["game"], World(), "off", ())
        self.pose: dict[int, tuple[Vector, Quaternion]] = {}
        self.steps = 0
        self.pushed: list[int] = []
        self._on_step = on_step

    @staticmethod
    def _version() -> str:
        return "1.0"

    def _spawn(self, body: int, brick: Brick) -> None:
        self.pose[body] = brick.position, brick.quaternion

    def _remove(self, body: int) -> None:
        del self.pose[body]

    def _push(self, body: int, impulse: Vector) -> None:
        self.pushed.append(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self.pose[body] = position, quaternion

    def _step(self, seconds: float) -> None:
        self.steps += 1
        self._on_step(self, self.steps)

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        poses = [self.pose[body] for body in bodies.tolist()]
        return (
            np.array([position for position, _ in poses]).reshape(-1, 3),
            np.array([quaternion for _, quaternion in poses]).reshape(-1, 4),
        )

    def _velocities(self, bodies: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        return np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))

    def _contacts(self) -> Contacts:
        return Contacts.empty()

    def _freeze(self, body: int) -> None: ...

    def _thaw(self, body: int) -> None: ...

    def _close(self) -> None: ...


@pytest.fixture
def fake_engine() -> type[FakeSimulation]:
    return FakeSimulation
