"""A gripper in MuJoCo that stacks cylinders and convex meshes, and topples them: docs/using_it_in_your_engine.md.

python mujoco_gripper.py [--picture FILE.png]      (a picture needs OpenGL: MUJOCO_GL=egl without a screen)
"""

import sys
from pathlib import Path

import mujoco

from stability_core.ports import attach
from stability_core.ports.mujoco import prepare

SCENE = Path(__file__).parent / "gripper.xml"
PARTS, HEIGHT, SPACING, STACK_X = 4, 0.05, 0.14, 0.3  # as in the scene, m


class Cell:
    """The simulation, its extension, and the targets of the hand."""

    def __init__(self) -> None:
        self.model = prepare(mujoco.MjSpec.from_file(str(SCENE))).compile()
        self.data = mujoco.MjData(self.model)
        self.extension = attach(self.data)
        self.extension.adopt()
        self.parts = [self.model.body(f"part{k}").id for k in range(PARTS)]

    def go(self, x: float, z: float, grip: float, seconds: float = 0.5) -> None:
        """Move the hand to a place of its finger tips, and the fingers to ``grip``, in equal steps."""
        start, target = self.data.ctrl.copy(), [x, z - 0.41, grip, grip]
        steps = round(seconds / self.model.opt.timestep)
        for step in range(1, steps + 1):
            self.data.ctrl[:] = start + (target - start) * min(1.0, 1.5 * step / steps)
            mujoco.mj_step(self.model, self.data)
            self.extension.update(self.model.opt.timestep)

    def stack(self, level: int) -> None:
        """Pick a part from the floor and set it down on the stack; the extension leaves it alone while it is held."""
        part, x, z = self.parts[level], -SPACING * level, HEIGHT / 2
        for place in (0.3, z):
            self.go(x, place, 0.0)
        self.extension.disturb([part])
        self.go(x, z, 0.04)
        for here, place in ((x, 0.4), (STACK_X, 0.4), (STACK_X, z + level * HEIGHT + 0.002)):
            self.go(here, place, 0.04)
        self.go(STACK_X, z + level * HEIGHT + 0.002, 0.0)
        self.extension.release([part])
        self.go(STACK_X, 0.4, 0.0)

    def topple(self) -> None:
        """Push the stack over with the closed hand."""
        for x, z in ((0.1, 0.4), (0.1, 0.13), (0.5, 0.13)):
            self.go(x, z, 0.05, seconds=1.0)

    def heights(self) -> list[float]:
        """Return the heights of the parts [m]."""
        return self.data.xpos[self.parts, 2].round(3).tolist()


def main(picture: str | None = None) -> tuple[list[float], list[float]]:
    """Stack, then topple; return the heights of the parts after each."""
    cell = Cell()
    for level in range(PARTS):
        cell.stack(level)
    stacked = cell.heights()
    print("stacked:", stacked, *(cell.extension.why(part) for part in cell.parts), sep="\n  ")
    if picture:
        from PIL import Image

        renderer = mujoco.Renderer(cell.model, 320, 480)
        renderer.update_scene(cell.data, "side")
        Image.fromarray(renderer.render()).save(picture)
    cell.topple()
    print("toppled:", cell.heights())
    return stacked, cell.heights()


if __name__ == "__main__":
    main(sys.argv[2] if sys.argv[1:2] == ["--picture"] else None)
