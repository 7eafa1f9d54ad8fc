"""CPU time of a frame with ``attach`` on a user's world, against the suite's adapter on the same bricks.

    uv run python -m tests.benchmarks.attach_cost [ENGINE ...]

Both worlds hold the same planks, with the engine's settings as shipped, and take turns frame by frame, so that slow
drifts of the machine cancel out. A frame is the engine's steps and the extension's update. In each round a plank lands
on one of a hundred frozen planks and freezes.
"""

from __future__ import annotations

import statistics
import sys
from typing import Any, NamedTuple

from adapters import open_engine
from scenarios.model import Brick, World
from stability_core import StabilityExtension
from stability_core.ports import attach
from tests.benchmarks.attached.side import (
    ABOVE,
    FRAME_S,
    FRICTION,
    FROZEN,
    MASS,
    PARKED,
    PARKED_IN_PLANE,
    SIZE,
    Side,
    place,
    place_in_plane,
)

SUITE = {
    "pybullet": "bullet",
    "mujoco": "mujoco",
    "sapien": "physx",
    "rapier": "rapier",
    "pymunk": "pymunk",
    "dart": "dart",
}
"""The suite's name of each engine."""
FRAMES = 60
"""Frames of a round: a frame counts as landing while the plank is live in both worlds, as quiet once it is frozen in
both."""
ROUNDS = 12


class Adapter(Side):
    """The suite's adapter of an engine."""

    def __init__(self, engine: str) -> None:
        planar = engine == "pymunk"
        places = [*map(place_in_plane if planar else place, range(FROZEN)), PARKED_IN_PLANE if planar else PARKED]
        bricks = [Brick(SIZE, MASS, position) for position in places]
        self.simulation = open_engine(SUITE[engine], "default", world=World(friction=FRICTION), expected=bricks)
        self.extension = StabilityExtension(self.simulation.port, "equilibrium")
        self.falling = [self.simulation.spawn(brick) for brick in bricks][-1]
        self.build()

    def step(self) -> None:
        self.simulation.step(FRAME_S)

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.simulation.move(self.falling, ABOVE, (1.0, 0.0, 0.0, 0.0))


class AttachedPybullet(Side):
    """A user's world of PyBullet, with four steps a frame."""

    def __init__(self) -> None:
        import pybullet

        self.bullet, self.client = pybullet, pybullet.connect(pybullet.DIRECT)
        pybullet.setGravity(0, 0, -9.81, self.client)
        self._add((40, 40, 2), 0.0, (0, 0, -1))
        for index in range(FROZEN):
            self._add(SIZE, MASS, place(index))
        self.falling = self._add(SIZE, MASS, PARKED)
        self.extension = attach(self.client)
        self.build()

    def _add(self, size: tuple[float, ...], mass: float, position: tuple[float, ...]) -> int:
        shape = self.bullet.createCollisionShape(
            self.bullet.GEOM_BOX, halfExtents=[edge / 2 for edge in size], physicsClientId=self.client
        )
        body: int = self.bullet.createMultiBody(mass, shape, basePosition=position, physicsClientId=self.client)
        self.bullet.changeDynamics(body, -1, lateralFriction=FRICTION**0.5, physicsClientId=self.client)
        return body

    def step(self) -> None:
        for _ in range(4):
            self.bullet.stepSimulation(self.client)

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.bullet.resetBasePositionAndOrientation(self.falling, ABOVE, (0, 0, 0, 1), self.client)
        self.bullet.resetBaseVelocity(self.falling, (0, 0, 0), (0, 0, 0), self.client)


class AttachedMujoco(Side):
    """A user's simulation of MuJoCo, with as many steps a frame as the suite's profile ``default``."""

    def __init__(self, steps: int) -> None:
        import mujoco

        from stability_core.ports.mujoco import prepare

        half = " ".join(str(edge / 2) for edge in SIZE)
        planks = "".join(
            f'<body pos="{x} {y} {z}"><freejoint/><geom type="box" size="{half}" mass="{MASS}"/></body>'
            for x, y, z in [*map(place, range(FROZEN)), PARKED]
        )
        xml = f"""<mujoco><option timestep="{FRAME_S / steps!r}"/><default><geom friction="{FRICTION}"/></default>
            <worldbody><geom type="plane" size="0 0 1"/>{planks}</worldbody></mujoco>"""
        self.mujoco, self.steps = mujoco, steps
        self.model = prepare(mujoco.MjSpec.from_string(xml)).compile()
        self.data = mujoco.MjData(self.model)
        self.falling = FROZEN + 1
        self.extension = attach(self.data)
        self.build()

    def step(self) -> None:
        for _ in range(self.steps):
            self.mujoco.mj_step(self.model, self.data)

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.data.qpos[7 * FROZEN :] = [*ABOVE, 1.0, 0.0, 0.0, 0.0]
        self.data.qvel[6 * FROZEN :] = 0.0


class Cost(NamedTuple):
    """Median CPU times of a frame [us], with ``attach`` and with the suite's adapter."""

    attached: float
    adapter: float

    @property
    def ratio(self) -> float:
        """Return the time with ``attach`` over the time with the adapter."""
        return self.attached / self.adapter


def open_sides(engine: str) -> tuple[Side, Adapter]:
    """Open a user's world and the suite's world with the same planks."""
    adapter = Adapter(engine)
    steps = adapter.simulation.info.profile.substeps
    match engine:
        case "pybullet":
            return AttachedPybullet(), adapter
        case "mujoco":
            return AttachedMujoco(steps), adapter
        case "sapien":
            from tests.benchmarks.attached.sapien_world import AttachedSapien

            return AttachedSapien(steps), adapter
        case "rapier":
            from tests.benchmarks.attached.rapier_world import AttachedRapier

            return AttachedRapier(steps), adapter
        case "dart":
            from tests.benchmarks.attached.dart_world import AttachedDart

            return AttachedDart(steps), adapter
        case _:
            from tests.benchmarks.attached.pymunk_world import AttachedPymunk

            return AttachedPymunk(), adapter


def measure(engine: str, rounds: int = ROUNDS) -> dict[str, Cost]:
    """Return the cost of frames in which a plank lands, and of quiet frames."""
    sides = open_sides(engine)
    times: dict[str, tuple[list[int], list[int]]] = {"landing": ([], []), "quiet": ([], [])}
    for _ in range(rounds):
        for side in sides:
            side.drop()
        for frame in range(FRAMES):
            frozen = [side.is_quiet() for side in sides]
            order = (0, 1) if frame % 2 else (1, 0)
            spent = {index: sides[index].frame() for index in order}
            if frozen[0] == frozen[1]:
                for index in order:
                    times["quiet" if frozen[0] else "landing"][index].append(spent[index])
    return {kind: Cost(*(statistics.median(each) / 1e3 for each in pair)) for kind, pair in times.items()}


def main(engines: list[Any]) -> None:
    """Print a table."""
    print("engine    frames   attach us  adapter us  ratio")
    for engine in engines:
        for kind, cost in measure(engine).items():
            print(f"{engine:9} {kind:8} {cost.attached:9.0f}  {cost.adapter:10.0f}  {cost.ratio:5.2f}")


if __name__ == "__main__":
    main(sys.argv[1:] or list(SUITE))
