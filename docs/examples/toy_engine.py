"""A toy engine of vertical motion with a port: the example of docs/tutorial.md, run by tests/test_tutorial.py."""

# begin imports
from collections.abc import Sequence

import numpy as np

from stability_core import GROUND, Contacts, Masses, StabilityExtension, check_port

GRAVITY = 9.81  # m/s2, downwards
FRAME_S = 1 / 60
LENGTH, WIDTH, THICKNESS = 0.117, 0.0234, 0.0078  # edges of a plank, m
MASS = 0.0119  # kg
FRICTION = 0.45
# end imports


# begin engine
class ToyEngine:
    """A column of flat planks that move up and down only; index 0 lies lowest."""

    def __init__(self, heights: Sequence[float]) -> None:
        self.height = np.array(heights)  # centres, m
        self.speed = np.zeros(len(heights))  # m/s, upwards
        self.approach = np.zeros(len(heights))  # speed at each plank's lower contact before it is stopped, m/s
        self.is_fixed = np.zeros(len(heights), np.bool_)

    def step(self, seconds: float = FRAME_S) -> None:
        """Advance by one step: fall, then stop at whatever lies below."""
        below, below_speed = 0.0, 0.0  # the ground
        self.approach[:] = 0.0
        for plank in range(len(self.height)):
            if not self.is_fixed[plank]:
                self.speed[plank] -= GRAVITY * seconds
                self.height[plank] += self.speed[plank] * seconds
                lowest = below + THICKNESS / 2
                if self.height[plank] <= lowest:
                    self.approach[plank] = self.speed[plank] - below_speed
                    self.height[plank], self.speed[plank] = lowest, below_speed
            below, below_speed = self.height[plank] + THICKNESS / 2, self.speed[plank]


# end engine


# begin port
class ToyPort:
    """The four calls that the stability core makes."""

    def __init__(self, engine: ToyEngine) -> None:
        self.engine = engine

    def contacts(self) -> Contacts:
        """Return four corner points for each plank that touches what lies below it."""
        engine = self.engine
        upper_face_below = np.concatenate([[0.0], engine.height[:-1] + THICKNESS / 2])
        gap = engine.height - THICKNESS / 2 - upper_face_below
        planks = np.flatnonzero(gap < 1e-4)
        corners = np.array([[x, y] for x in (-LENGTH / 2, LENGTH / 2) for y in (-WIDTH / 2, WIDTH / 2)])
        upper = np.repeat(planks, 4)
        count = len(upper)
        zeros = np.zeros(count)
        return Contacts(
            body_a=np.where(upper == 0, GROUND, upper - 1),
            body_b=upper,
            point=np.column_stack([np.tile(corners, (len(planks), 1)), upper_face_below[upper]]),
            normal=np.tile([0.0, 0.0, 1.0], (count, 1)),  # from a to b: upwards
            separation=gap[upper],
            relative_velocity=np.column_stack([zeros, zeros, engine.approach[upper]]),
            friction=np.full(count, FRICTION),
        )

    def masses(self) -> Masses:
        """Return every plank: mass and centre of mass."""
        count = len(self.engine.height)
        center = np.column_stack([np.zeros(count), np.zeros(count), self.engine.height])
        return Masses(body=np.arange(count), mass=np.full(count, MASS), center_of_mass=center)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze planks exactly where they are."""
        self.engine.is_fixed[list(bodies)] = True
        self.engine.speed[list(bodies)] = 0.0

    def wake(self, bodies: Sequence[int]) -> None:
        """Return planks to the engine, at rest."""
        self.engine.is_fixed[list(bodies)] = False


# end port


# begin check
def check() -> list[str]:
    """Check the port on a plank that comes to rest."""
    engine = ToyEngine([THICKNESS / 2 + 0.01])
    return check_port(ToyPort(engine), engine.step)


# end check


# begin main
def freeze_first_plank() -> int:
    """Drop a plank from 10 mm and return the frame in which it freezes."""
    engine = ToyEngine([THICKNESS / 2 + 0.01])
    with StabilityExtension(ToyPort(engine), policy="paper") as extension:
        for frame in range(120):
            engine.step()
            change = extension.update(FRAME_S)
            if change.frozen:
                print(f"frame {frame}: {dict(change.reasons)}")
                return frame
        raise RuntimeError(extension.why(0))


if __name__ == "__main__":
    print("\n".join(check()))
    freeze_first_plank()
# end main
