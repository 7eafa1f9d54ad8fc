"""Measure creep: the slope of the bricks' positions over time, at the end of the watch of a finished stack or pile.

The 95 % interval of the slope comes from Kiefer, Vogelsang and Bunzel (Econometrica 68, 2000): the variance estimator
of Newey and West with the length of the series as bandwidth. The usual interval of a regression assumes independent
frames. Frames are not independent, because a vibrating or oscillating brick is close to its position in the frame
before. Therefore the usual interval could find creep in stacks that only oscillate. The estimator of this module
requires no choice of a bandwidth. The interval becomes wide if a series oscillates slowly, or if its slope is not
steady.

    t_i         times of the n frames minus their mean, i = 1 ... n
    x_i         positions along the brick's direction of motion
    v           sum t_i x_i / sum t_i^2                   slope of x_i over t_i
    S_k         sum over i <= k of t_i (x_i - mean(x) - v t_i)
    variance    (2 / n) (sum S_k^2) / (sum t_i^2)^2       S_n is zero, because residuals are orthogonal to times
    error       QUANTILE sqrt(variance)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.trial.measure import FloatArray

QUANTILE = 5.78
"""95 % quantile of the absolute ratio of slope to standard error for series without a slope. The value comes from a
simulation of 100,000 series of 1,000 independent numbers; series of 150 numbers give 5.77, series of 50 give 5.83.
``tests/bench/trial/test_creep.py`` repeats the simulation with 20,000 series of 150 numbers."""
LEAST_FRAMES = 20
"""Fewest frames that give a creep: a third of a second at 60 Hz."""


@dataclass(frozen=True, slots=True)
class Creep:
    """Creep of bricks.

    The "fastest brick" is the brick with the greatest ratio of speed to thickness, or the thinnest brick if none moves.
    """

    speed_m_s: float
    """Speed of the centre of the fastest brick [m/s]."""
    error_m_s: float
    """Half width of the 95 % interval of that speed [m/s]."""
    thickness_m: float
    """Thickness (least edge) of the fastest brick [m]."""
    sliding_m_s: float
    """Greatest horizontal speed of the centre of any brick [m/s]."""
    sinking_m_s: float
    """Greatest vertical speed of the centre of any brick, downward or upward [m/s]."""


class CreepMeter:
    """Meter that collects the positions of bricks after every frame, and measures their creep."""

    def __init__(self, from_s: float) -> None:
        """Prepare to collect the positions at the ends of frames after ``from_s`` [s]."""
        self._from_s = from_s
        self._times: list[float] = []
        self._positions: list[FloatArray] = []

    def see(self, time: float, position: FloatArray) -> None:
        """Record the positions at the end of a frame, and drop earlier positions if the number of bricks has changed.

        The method ignores frames that end before the start of the measurement, or at the start.

        Args:
            time: end of the frame [s].
            position: centres of the n bricks, or their displacements from fixed points [m], shape (n, 3); the array
                must not change later.
        """
        if time <= self._from_s:
            return
        if self._positions and len(position) != len(self._positions[-1]):
            self._times, self._positions = [], []
        self._times.append(time)
        self._positions.append(position)

    def measure(self, thickness: FloatArray) -> Creep | None:
        """Return the creep of the bricks; None with fewer than ``LEAST_FRAMES`` frames or without bricks.

        Args:
            thickness: thicknesses (least edges) of the n bricks [m], shape (n,).
        """
        if len(self._times) < LEAST_FRAMES or not len(thickness):
            return None
        return creep_of(np.array(self._times), np.array(self._positions), thickness)


def creep_of(time: FloatArray, position: FloatArray, thickness: FloatArray) -> Creep:
    """Return the creep of n bricks over m frames.

    Args:
        time: ends of the frames [s], shape (m,).
        position: centres of the bricks [m], shape (m, n, 3).
        thickness: thicknesses (least edges) of the bricks [m], shape (n,).
    """
    time = time - time.mean()
    moved = position - position[0]  # so that a brick that never moves has a slope of exactly zero
    slope = np.tensordot(time, moved, 1) / (time @ time)
    speed = np.linalg.norm(slope, axis=1)
    fastest = int((speed / thickness).argmax()) if speed.any() else int(thickness.argmin())
    return Creep(
        float(speed[fastest]),
        _error(time, moved[:, fastest], slope[fastest]),
        float(thickness[fastest]),
        float(np.hypot(slope[:, 0], slope[:, 1]).max()),
        float(np.abs(slope[:, 2]).max()),
    )


def _error(time: FloatArray, moved: FloatArray, slope: FloatArray) -> float:
    """Return the half width of the 95 % interval of a brick's speed along its direction of motion [m/s].

    Args:
        time: ends of the frames minus their mean [s], shape (m,).
        moved: positions relative to the first frame [m], shape (m, 3).
        slope: velocity of the brick by regression [m/s], shape (3,).
    """
    speed = float(np.linalg.norm(slope))
    if speed == 0.0:
        return 0.0
    along = moved @ (slope / speed)
    partial = np.cumsum(time * (along - along.mean() - speed * time))
    return float(QUANTILE * np.sqrt(2 / len(time) * (partial @ partial)) / (time @ time))
