"""Table of the bodies that joints may hold: place, size, time at rest, and failed reviews of each."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from bench.welding.settings import CORE
from stability_core.port import FloatArray, IntArray, Masses

_ROW = np.dtype(
    [
        ("id", "i8"),
        ("mass", "f8"),  # kg
        ("center", "f8", 3),  # m
        ("speed", "f8"),  # of the centre, m/s
        ("size", "f8"),  # distance of the farthest contact point so far from the centre, m; 0 without a contact
        ("rest_s", "f8"),  # time at rest, s
        ("failures", "i8"),  # number of reviews in succession that the body failed
        ("held", "?"),  # True while a user holds the body
    ]
)
NOBODY = -1
"""Row of a body that is not in the table, such as the ground or a body that the host moves."""


class BodyTable:
    """Table of the m bodies that joints may hold, with a row per body, by rising id."""

    def __init__(self) -> None:
        self.rows: npt.NDArray[np.void] = np.zeros(0, _ROW)

    def rows_of(self, ids: IntArray) -> IntArray:
        """Return the row of each id, ``NOBODY`` for ids that have none, shape (k,)."""
        known = self.rows["id"]
        if not len(known):
            return np.full(len(ids), NOBODY)
        places = np.minimum(np.searchsorted(known, ids), len(known) - 1)
        return np.where(known[places] == ids, places, NOBODY)

    def follow(self, masses: Masses, dt: float) -> bool:
        """Read masses, centres and speeds after a frame of ``dt`` seconds; return True if a body has left."""
        movable = np.isfinite(masses.mass)
        ids, mass, center = masses.body[movable], masses.mass[movable], masses.center_of_mass[movable]
        has_left = False
        if not np.array_equal(ids, self.rows["id"]):
            rows = np.zeros(len(ids), _ROW)
            old = self.rows_of(ids)
            rows[old != NOBODY] = self.rows[old[old != NOBODY]]
            rows["center"][old == NOBODY] = np.inf  # a new body counts as infinitely fast
            has_left = bool(np.count_nonzero(old != NOBODY) < len(self.rows))
            self.rows = rows
            self.rows["id"] = ids
        self.rows["speed"] = np.linalg.norm(center - self.rows["center"], axis=1) / dt
        self.rows["mass"], self.rows["center"] = mass, center
        return has_left

    def note_sizes(self, body: IntArray, point: FloatArray) -> None:
        """Record the sizes from the n contact points [m] of the rows ``body``, shapes (n,) and (n, 3)."""
        distance = np.linalg.norm(point - self.rows["center"][body], axis=1)
        np.maximum.at(self.rows["size"], body, distance)

    def time_rest(self, slip: FloatArray, gravity: float, dt: float) -> None:
        """Add ``dt`` seconds to the time at rest of each body that is slow, and does not slip faster than allowed.

        The time at rest of all other bodies becomes 0.

        Args:
            slip: greatest sliding speed [m/s] at the contacts of each body, shape (m,).
            gravity: strength of gravity [m/s2].
            dt: length of the frame [s].
        """
        unit = self.speed_unit(gravity)
        rests = (self.rows["speed"] <= CORE.rest_speed * unit) & (slip <= CORE.rest_slip * unit) & (unit > 0.0)
        self.rows["rest_s"] = np.where(rests, self.rows["rest_s"] + dt, 0.0)

    def speed_unit(self, gravity: float) -> FloatArray:
        """Return the unit of speeds [m/s] of each body, shape (m,); 0 for a body without a contact so far."""
        unit: FloatArray = np.sqrt(gravity * self.rows["size"])
        return unit
