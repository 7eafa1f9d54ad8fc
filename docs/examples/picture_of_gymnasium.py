"""Draw the ends of two episodes of gymnasium_stacking.py, without and with the extension, to docs/pictures.

uv run python docs/examples/picture_of_gymnasium.py
"""

from pathlib import Path

import numpy as np
import pybullet
from gymnasium_stacking import StackingEnv, play
from PIL import Image

PICTURE = Path(__file__).parents[1] / "pictures" / "gymnasium_stacking.png"
WIDTH, HEIGHT = 256, 320


def drawn(env: StackingEnv) -> np.ndarray:
    """Return a picture of the world, shape (height, width, 3)."""
    view = pybullet.computeViewMatrix((1.0, -1.2, 0.7), (0, 0, 0.35), (0, 0, 1))
    lens = pybullet.computeProjectionMatrixFOV(45, WIDTH / HEIGHT, 0.1, 9)
    pixels = pybullet.getCameraImage(WIDTH, HEIGHT, view, lens, physicsClientId=env.client)[2]
    return np.reshape(np.array(pixels, np.uint8), (HEIGHT, WIDTH, 4))[:, :, :3]


if __name__ == "__main__":
    halves = []
    for extended in (False, True):
        with play(extended) as env:
            halves.append(drawn(env))
    Image.fromarray(np.hstack(halves)).save(PICTURE)
