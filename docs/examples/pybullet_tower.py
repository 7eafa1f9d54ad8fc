"""A tower in PyBullet, built one brick a second or set down as a whole: the example of docs/using_it_in_your_engine.md.

python pybullet_tower.py [--picture FILE.png]
"""

import sys

import pybullet
from pybullet_utils.bullet_client import BulletClient

from stability_core.ports import attach

STEP_S = 1 / 240
SIZE = (0.12, 0.06, 0.04)  # edges of a brick, m
LEVELS = 8


def open_world() -> BulletClient:
    """Open a world with gravity and a floor."""
    world = BulletClient(pybullet.DIRECT)
    world.setGravity(0, 0, -9.81)
    world.createMultiBody(0, world.createCollisionShape(pybullet.GEOM_PLANE))
    return world


def add_brick(world: BulletClient, level: int, gap: float = 0.0) -> int:
    """Add a brick of 0.5 kg to the tower; each second brick lies across."""
    shape = world.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[edge / 2 for edge in SIZE])
    turn = world.getQuaternionFromEuler((0, 0, 1.5708 * (level % 2)))
    brick = world.createMultiBody(0.5, shape, basePosition=(0, 0, (level + 0.5) * SIZE[2] + gap), baseOrientation=turn)
    world.changeVisualShape(brick, -1, rgbaColor=(0.93, 0.80, 0.55, 1) if level % 2 else (0.80, 0.55, 0.30, 1))
    return brick


def one_a_second(levels: int = LEVELS) -> list[int]:
    """Build the tower brick by brick; return the frozen bricks."""
    world = open_world()
    with attach(world) as extension:
        for level in range(levels):
            brick = add_brick(world, level, gap=0.001)
            for _ in range(240):
                world.stepSimulation()
                extension.update(STEP_S)
            print(f"brick {brick}: {extension.why(brick)}")
        frozen = extension.frozen.tolist()
    world.disconnect()
    return frozen


def prebuilt(levels: int = LEVELS, picture: str | None = None) -> list[int]:
    """Set the tower down as a whole, freeze it before the first step, and run for a second."""
    world = open_world()
    for level in range(levels):
        add_brick(world, level)
    with attach(world) as extension:
        extension.adopt()
        for _ in range(240):
            world.stepSimulation()
            extension.update(STEP_S)
        if picture:
            save_picture(world, picture)
        frozen = extension.frozen.tolist()
    world.disconnect()
    return frozen


def save_picture(world: BulletClient, file: str) -> None:
    """Write the view of PyBullet's software renderer to a file."""
    from PIL import Image

    view = world.computeViewMatrix((0.5, -0.6, 0.4), (0, 0, 0.15), (0, 0, 1))
    lens = world.computeProjectionMatrixFOV(40, 1.5, 0.1, 5)
    width, height, pixels, *_ = world.getCameraImage(480, 320, view, lens, renderer=pybullet.ER_TINY_RENDERER)
    Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB").save(file)


if __name__ == "__main__":
    print("one a second, frozen:", one_a_second())
    print("prebuilt, frozen:", prebuilt(picture=sys.argv[2] if sys.argv[1:2] == ["--picture"] else None))
