"""CPU time of a frame with ``attach`` on a user's world, against the suite's adapter on the same bricks.

    uv run python -m tests.benchmarks.attach_cost [ENGINE ...]

Both worlds hold the same planks, with the engine's settings as shipped, and take turns frame by frame, so that slow
drifts of the machine cancel out. A frame is the engine's steps and the extension's update. In each round a plank lands
on one of a hundred frozen planks and freezes.
"""

from __future__ import annotations

import statistics
import sys
import time
from abc import ABC, abstractmethod
from typing import Any, NamedTuple

from adapters import open_engine
from scenarios.model import Brick, World
from stability_core import StabilityExtension
from stability_core.ports import attach

ENGINES = ("pybullet", "mujoco", "pymunk")
SUITE = {"pybullet": "bullet", "mujoco": "mujoco", "pymunk": "pymunk"}
"""The suite's name of each engine."""
SIZE, MASS = (0.117, 0.0234, 0.0078), 0.0119
FROZEN = 100
FRAME_S = 1 / 60
FRAMES = 60
"""Frames of a round: a frame counts as landing while the plank is live in both worlds, as quiet once it is frozen in
both."""
ROUNDS = 12
PARKED = (3.5, 0.0, SIZE[2] / 2)
FRICTION = 0.45


def place(index: int) -> tuple[float, float, float]:
    """Return the place of a plank in a grid on the ground [m]."""
    row, column = divmod(index, 20)
    return 0.15 * column, 0.05 * row, SIZE[2] / 2


def place_in_plane(index: int) -> tuple[float, float, float]:
    """Return the place of a plank in a row on the ground of a planar engine [m]."""
    return 0.15 * index, 0.0, SIZE[2] / 2


PARKED_IN_PLANE = (-1.0, 0.0, SIZE[2] / 2)
ABOVE = (0.0, 0.0, 1.5 * SIZE[2] + 5e-4)


class Side(ABC):
    """One of two worlds that take turns."""

    extension: StabilityExtension
    falling: int

    def build(self) -> None:
        """Freeze the planks of the grid."""
        self.frames(60)
        assert len(self.extension.frozen) == FROZEN + 1, len(self.extension.frozen)

    def frames(self, count: int) -> None:
        """Play some frames."""
        for _ in range(count):
            self.frame()

    def frame(self) -> int:
        """Play a frame; return its CPU time [ns]."""
        start = time.thread_time_ns()
        self.step()
        self.extension.update(FRAME_S)
        return time.thread_time_ns() - start

    def is_quiet(self) -> bool:
        """Return True if the loose plank is frozen."""
        return self.extension.why(self.falling).startswith("frozen")

    @abstractmethod
    def step(self) -> None:
        """Make the engine's steps of a frame."""

    @abstractmethod
    def drop(self) -> None:
        """Let the loose plank fall on the first plank of the grid."""


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


class AttachedPymunk(Side):
    """A user's space of pymunk in millimetres, as in the suite's adapter, with one step a frame.

    The planks lie side by side, because the space is a plane. A landing plank lands on the first of them.
    """

    def __init__(self) -> None:
        import pymunk

        self.pymunk, self.space = pymunk, pymunk.Space()
        self.space.gravity = 0.0, -9810.0
        floor = pymunk.Poly(self.space.static_body, [(-20000, -1000), (20000, -1000), (20000, 0), (-20000, 0)])
        floor.friction = FRICTION**0.5
        self.space.add(floor)
        for index in range(FROZEN):
            self._add(place_in_plane(index))
        self.plank = self._add(PARKED_IN_PLANE)
        self.extension = attach(self.space)
        self.falling = self.extension.id_of(self.plank)
        self.build()

    def _add(self, position: tuple[float, ...]) -> Any:
        width, height = 1e3 * SIZE[0], 1e3 * SIZE[2]
        body = self.pymunk.Body(MASS, self.pymunk.moment_for_box(MASS, (width, height)))
        body.position = 1e3 * position[0], 1e3 * position[2]
        shape = self.pymunk.Poly.create_box(body, (width, height))
        shape.friction = FRICTION**0.5
        self.space.add(body, shape)
        return body

    def step(self) -> None:
        self.space.step(FRAME_S)

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.plank.position, self.plank.angle = (1e3 * ABOVE[0], 1e3 * ABOVE[2]), 0.0
        self.plank.velocity, self.plank.angular_velocity = (0.0, 0.0), 0.0


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
    match engine:
        case "pybullet":
            return AttachedPybullet(), adapter
        case "mujoco":
            return AttachedMujoco(adapter.simulation.info.profile.substeps), adapter
        case _:
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
    main(sys.argv[1:] or list(ENGINES))
