"""Record of the bodies of a world: live bodies, frozen bodies, and bodies that the host moves."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from scenarios.model import Brick, Vector
from stability_core.port import FloatArray, IntArray

NO_FORCE: Vector = (0.0, 0.0, 0.0)
NO_VELOCITY: Vector = (0.0, 0.0, 0.0)


class Bodies:
    """Record of the live, frozen and moved bodies of a world. The record does not reuse an id.

    The public collections remain the same objects while the world exists, so that other objects may refer to them.
    """

    def __init__(self) -> None:
        self.count = 0
        """Number of ids assigned so far."""
        self.bricks: dict[int, Brick] = {}
        """Brick of every body as spawned, by rising id."""
        self.live: dict[int, float] = {}
        """Mass [kg] of every live body, by rising id."""
        self.frozen: set[int] = set()
        self.moved: dict[int, tuple[Vector, Vector]] = {}
        """Velocity [m/s] and spin [rad/s] of each body that the host moves."""
        self.steady: dict[int, Vector] = {}
        """Steady force [N] of each body on which a steady force acts."""
        self._removed: list[int] = []
        self._live_rows: tuple[IntArray, FloatArray] | None = None

    def new_id(self) -> int:
        """Return the id of the next body."""
        self.count += 1
        return self.count - 1

    def add(self, body: int, brick: Brick) -> None:
        """Record a new body, live or moved."""
        self.bricks[body] = brick
        if brick.moved:
            self.moved[body] = NO_VELOCITY, NO_VELOCITY
        else:
            self.live[body] = brick.mass
        self._live_rows = None

    def remove(self, body: int) -> None:
        """Delete the record of a body; the next ``take_removed`` returns its id."""
        del self.bricks[body]
        self.frozen.discard(body)
        self.live.pop(body, None)
        self.moved.pop(body, None)
        self._live_rows = None
        self._removed.append(body)

    def freeze(self, body: int) -> None:
        """Record the freeze of a live body."""
        self.frozen.add(body)
        del self.live[body]
        self._live_rows = None

    def unfreeze(self, body: int) -> None:
        """Record that a frozen body is live again; the caller must then call ``sort_live``."""
        self.frozen.remove(body)
        self.live[body] = self.bricks[body].mass

    def sort_live(self) -> None:
        """Sort the live bodies by id."""
        rising = sorted(self.live.items())
        self.live.clear()
        self.live.update(rising)
        self._live_rows = None

    def take_removed(self) -> list[int]:
        """Return the ids of the bodies removed since the previous call."""
        removed, self._removed = self._removed, []
        return removed

    def check_known(self, bodies: Iterable[int]) -> None:
        """Raise ``KeyError`` unless all ``bodies`` are in the world."""
        unknown = [body for body in bodies if body not in self.bricks]
        if unknown:
            body_or_bodies = "body" if len(unknown) == 1 else "bodies"
            raise KeyError(
                f"the world does not contain the {body_or_bodies} {', '.join(map(str, unknown))}, because the host "
                f"never spawned the {body_or_bodies}, or removed the {body_or_bodies}: use ids from poses()"
            )

    def ids(self) -> IntArray:
        """Return the ids (n,) of all bodies, in rising order."""
        return np.fromiter(self.bricks, np.int64, len(self.bricks))

    def live_rows(self) -> tuple[IntArray, FloatArray]:
        """Return the ids (m,), in rising order, and the masses (m,) [kg] of the live bodies.

        The method returns the same arrays until the live bodies change.
        """
        if self._live_rows is None:
            count = len(self.live)
            self._live_rows = (
                np.fromiter(self.live, np.int64, count),
                np.fromiter(self.live.values(), np.float64, count),
            )
        return self._live_rows

    def moving(self) -> IntArray:
        """Return the ids (k,) of the live bodies and of the bodies that the host moves, in rising order."""
        live, _ = self.live_rows()
        return np.union1d(live, np.fromiter(self.moved, np.int64, len(self.moved))) if self.moved else live

    def driven(self) -> list[int]:
        """Return the ids of the bodies that the host moves at a velocity other than zero, in rising order."""
        return sorted(body for body, (linear, angular) in self.moved.items() if any(linear) or any(angular))
