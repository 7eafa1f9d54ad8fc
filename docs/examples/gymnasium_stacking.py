"""A Gymnasium environment that stacks bricks in PyBullet, with the extension or without."""

import gymnasium
import numpy as np
import pybullet as bullet

from stability_core.ports import attach

SIZE = np.array([0.06, 0.06, 0.04])  # edges of a brick, m
LEVELS, FRAME_S, FRAMES = 20, 1 / 60, 60  # a brick a second


class StackingEnv(gymnasium.Env):
    """Each action sets a brick down on the tower; the episode ends when a brick has left its level."""

    action_space = gymnasium.spaces.Box(
        -1.0, 1.0, (2,), np.float32
    )  # offset from the brick below, in tenths of an edge
    observation_space = gymnasium.spaces.Box(-10.0, 10.0, (LEVELS, 3), np.float32)  # centres, m; zero before it comes

    def __init__(self, extended: bool = True) -> None:
        self.extended, self.client, self.bricks, self.extension = extended, -1, [], None

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        """Empty the world; return the observation and no information."""
        super().reset(seed=seed, options=options)
        self.close()
        self.client, self.bricks = bullet.connect(bullet.DIRECT), []
        bullet.setGravity(0, 0, -9.81, self.client)
        floor = bullet.createCollisionShape(bullet.GEOM_PLANE, physicsClientId=self.client)
        bullet.createMultiBody(0, floor, physicsClientId=self.client)
        self.shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=SIZE / 2, physicsClientId=self.client)
        self.extension = attach(self.client) if self.extended else None
        return self.places(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Set a brick down and run for a second; the reward is 1 while the tower stands."""
        below = self.places()[len(self.bricks) - 1] if self.bricks else np.array([0, 0, -SIZE[2] / 2])
        place = below + np.array([*(0.1 * SIZE[:2] * action), SIZE[2] + 5e-4])
        self.bricks.append(bullet.createMultiBody(0.2, self.shape, basePosition=place, physicsClientId=self.client))
        for _ in range(FRAMES):
            for _ in range(4):
                bullet.stepSimulation(self.client)
            if self.extension:
                self.extension.update(FRAME_S)
        heights = self.places()[: len(self.bricks), 2]
        stands = bool((abs(heights - (np.arange(len(heights)) + 0.5) * SIZE[2]) < SIZE[2] / 2).all())
        return self.places(), float(stands), not stands, len(self.bricks) == LEVELS, {}

    def places(self) -> np.ndarray:
        """Return the centres of the bricks [m]."""
        found = np.zeros((LEVELS, 3), np.float32)
        for level, brick in enumerate(self.bricks):
            found[level] = bullet.getBasePositionAndOrientation(brick, self.client)[0]
        return found

    def close(self) -> None:
        """Let the world go."""
        if self.extension:
            self.extension.close()
        if self.client >= 0:
            bullet.disconnect(self.client)
        self.client, self.extension = -1, None


def play(extended: bool) -> StackingEnv:
    """Play an episode without offsets; return the environment at its end, still open."""
    env = StackingEnv(extended)
    env.reset(seed=0)
    while not any(env.step(np.zeros(2))[2:4]):
        pass
    return env


if __name__ == "__main__":
    for extended in (False, True):
        with play(extended) as env:
            print(f"{'with' if extended else 'without'} the extension: {len(env.bricks)} bricks")
