"""Measure the creep of a finished stack: the slope of its bricks' positions over the last half of the watch.

The slope's interval is that of Kiefer, Vogelsang and Bunzel (Econometrica 68, 2000): Newey and West's estimator of the
variance with a bandwidth of the whole series. Frames are not independent draws, because a brick that trembles or sways
is near its place a frame ago. The usual interval of a regression assumes independence and finds creep in stacks that
only sway. This estimator needs no bandwidth to be chosen, and becomes wide where a series sways slowly or
its slope is not steady.

    t_i         times less their mean; n of them
    v           sum t_i x_i / sum t_i^2                   slope of the position x along the brick's own direction
    S_k         sum over i <= k of t_i (x_i - mean - v t_i)
    variance    (2 / n) (sum S_k^2) / (sum t_i^2)^2       S_n is zero, as residuals are orthogonal to times
    error       QUANTILE sqrt(variance)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.trial.measure import FloatArray

QUANTILE = 5.78
"""The ratio of slope to standard error that 95 % of series without a slope stay below: found by simulation of 100,000
series of 1,000 independent numbers; 150 numbers give 5.77, 50 give 5.83. ``tests/bench/trial/test_creep.py`` repeats
it."""
LEAST_FRAMES = 20
"""Fewest frames that count as a measurement: a third of a second."""


@dataclass(frozen=True, slots=True)
class Creep:
    """The creep of bricks. The first three figures are of the brick that is fastest for its thickness."""

    speed_m_s: float
    """Speed of its centre [m/s]."""
    error_m_s: float
    """Half width [m/s] of the 95 % interval of that speed."""
    thickness_m: float
    """Its least edge [m]."""
    sliding_m_s: float
    """Fastest horizontal speed [m/s] of any centre."""
    sinking_m_s: float
    """Fastest vertical speed [m/s] of any centre, downward or upward."""


class CreepMeter:
    """Takes the positions of the bricks after every frame; positions before ``from_s`` do not count."""

    def __init__(self, from_s: float) -> None:
        self._from_s = from_s
        self._times: list[float] = []
        self._positions: list[FloatArray] = []

    def see(self, time: float, position: FloatArray) -> None:
        """Take the centres [m], shape (n, 3), at the end of a frame; the array must not change later."""
        if time <= self._from_s:
            return
        if self._positions and len(position) != len(self._positions[-1]):
            self._times, self._positions = [], []
        self._times.append(time)
        self._positions.append(position)

    def measure(self, thickness: FloatArray) -> Creep | None:
        """Return the creep of bricks of these thicknesses [m], shape (n,); None with too few frames."""
        if len(self._times) < LEAST_FRAMES or not len(thickness):
            return None
        return creep_of(np.array(self._times), np.array(self._positions), thickness)


def creep_of(time: FloatArray, position: FloatArray, thickness: FloatArray) -> Creep:
    """Return the creep of bricks.

    Args:
        time: ends of frames [s], shape (m,).
        position: centres [m], shape (m, n, 3).
        thickness: least edges [m], shape (n,).
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
    """Return the half width [m/s] of the 95 % interval of a brick's speed along its own direction."""
    speed = float(np.linalg.norm(slope))
    if speed == 0.0:
        return 0.0
    along = moved @ (slope / speed)
    partial = np.cumsum(time * (along - along.mean() - speed * time))
    return float(QUANTILE * np.sqrt(2 / len(time) * (partial @ partial)) / (time @ time))
