"""An engine that needs no engine: bricks stay where they are put unless a test moves them.

And one that misbehaves (``rogue/``), in a suite that runs apart from the tests, so that it may crash and be killed.
"""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from adapters.base import Simulation
from adapters.profile import Capabilities, Profile
from reports.records.trial import TrialRecord
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import Contacts, FloatArray, IntArray


class FakeSimulation(Simulation):
    """Bricks hang where they were let go; ``on_step(simulation, step)`` may move them by hand or raise."""

    engine: ClassVar[str] = "bullet"  # a registered name, so that records can be made
    capabilities: ClassVar[Capabilities] = Capabilities(
        contact_points="none",
        near_contacts=True,
        separation=True,
        relative_velocity="reported",
        forces="no",
        freeze="exact",
        frozen_contacts=False,
        friction_law="none",
        moved="no",
        deterministic="across processes",
    )
    profiles: ClassVar[Mapping[str, Profile]] = {"game": Profile("game", "", 1)}

    def __init__(self, on_step=lambda *_: None) -> None:
        super().__init__(self.profiles["game"], World(), "off", ())
        self.pose: dict[int, tuple[Vector, Quaternion]] = {}
        self.steps = 0
        self.pushed: list[int] = []
        self.pressed: dict[int, Vector] = {}
        self._on_step = on_step

    def _open(self) -> None: ...

    def _spawn(self, body: int, brick: Brick) -> None:
        self.pose[body] = brick.position, brick.quaternion

    def _spawn_moved(self, body, brick) -> None:
        self._spawn(body, brick)

    def _drive(self, body, linear, angular, seconds) -> None: ...

    def _remove(self, body: int) -> None:
        del self.pose[body]

    def _push(self, body: int, impulse: Vector) -> None:
        self.pushed.append(body)

    def _press(self, body: int, force: Vector) -> None:
        self.pressed[body] = force

    def _set_gravity(self, gravity: Vector) -> None: ...

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self.pose[body] = position, quaternion

    def _step(self, seconds: float) -> None:
        self.steps += 1
        self._act_on_bodies(seconds)
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

    def _find_contacts(self) -> Contacts:
        return Contacts.empty()

    def _freeze(self, body: int) -> None: ...

    def _unfreeze(self, body: int) -> None: ...

    def _close(self) -> None: ...


@pytest.fixture
def fake_engine() -> type[FakeSimulation]:
    return FakeSimulation


class RogueSuite:
    """The command line in a process of its own, with the misbehaving engine registered."""

    SCRIPT = Path(__file__).parent / "rogue" / "rogue_bench.py"
    ROOT = Path(__file__).parents[2]

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.out = folder / "out"
        self.environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(self.ROOT), str(self.SCRIPT.parent)])}

    def write_study(self, profiles: Sequence[str] = ("game",), **fields: object) -> None:
        """A study of the misbehaving engine; ``fields`` are added to it, limits under their own names."""
        lines = ["name = 'rogues'", "engines = ['rogue']", "policies = ['none']", f"profiles = {list(profiles)}"]
        lines += [f"{name} = {_toml(value)}" for name, value in fields.items()]
        lines += ["[[scenario]]", "name = 'leaning_tower'", "parameters = { levels = 2 }"]
        (self.folder / "rogues.toml").write_text("\n".join(lines) + "\n")

    def start(self, *options: str, **popen) -> subprocess.Popen[str]:
        """Begin ``bench run`` on the study."""
        return subprocess.Popen(
            [*self.command(*options)],
            cwd=self.folder,
            env=self.environment,
            **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **popen},
        )

    def command(self, *options: str) -> list[str]:
        return [sys.executable, str(self.SCRIPT), "run", "rogues.toml", "--out", str(self.out), *options]

    def run(self, *options: str, status: int = 0) -> str:
        """Run ``bench run``; return its output on one line."""
        process = self.start(*options)
        output, errors = process.communicate(timeout=900)
        assert process.returncode == status, errors
        return " ".join((output + errors).split())


COSTS = {"wall_s", "realtime_factor", "memory_mib", "core_instructions"}
CIRCUMSTANCES = COSTS | {"core"} | {name for name in TrialRecord.model_fields if "_ms" in name}


@pytest.fixture
def untimed():
    """Returns the fields of records, by trial, that depend neither on the clock, the memory nor the processor core."""
    return lambda records: {record.trial: record.model_dump(exclude=CIRCUMSTANCES) for record in records}


@pytest.fixture
def rogue_suite(tmp_path) -> RogueSuite:
    return RogueSuite(tmp_path)


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {_toml(item)}" for name, item in value.items()) + " }"
    return str(value)
