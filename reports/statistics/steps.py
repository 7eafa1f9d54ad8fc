"""Steps of a figure over versions: the versions at which its level changes and stays changed.

The module transforms the values to x_i on a scale on which a step has a typical size. The scale is logarithmic for
creep, sink and times, and linear for levels and angles. The search by PELT (pruned exact linear time) then finds the
segments that minimise

    sum over segments of sum_i ((x_i - mean of segment) / s)^2  +  penalty * number of steps

    s         max(least noise, 1.4826 / sqrt(2) * median of |x_(i+1) - x_i|), the noise of a value;
              least noise for fewer than ``_LEAST_VERSIONS`` versions
    penalty   PENALTY log(number of versions)

Finally the module drops steps at a wrong version (see ``_placed``) and steps smaller than the least step of their kind.

Sources: R. Killick, P. Fearnhead, I. A. Eckley, Optimal detection of changepoints with a linear computational cost,
Journal of the American Statistical Association 107 (2012) 1590-1598; C. Truong, L. Oudre, N. Vayatis, Selective review
of offline change point detection methods, Signal Processing 167 (2020) 107299. The library ``ruptures`` of these
authors runs the search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import ruptures
from numpy.typing import NDArray

from reports.records.history import Kind

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scale:
    """Scale of a kind of figure, with the least noise and the least step on this scale."""

    transformed: Callable[[float], float]
    """Function from a value to the scale on which a step has a typical size."""
    noise: float
    """Least noise of a value, on that scale."""
    least_step: float
    """Least step that counts, on that scale."""
    min_size: int = 1
    """Fewest versions between two steps. A figure without noise may change at every version."""


CREEP_FLOOR = 1e-6
"""Creep [m/s] that is added before the logarithm, so that small creeps differ little on the scale. The value is the
default tolerance of a comparison (``Tolerance.creep_m_s``)."""
SINK_FLOOR = 5e-5
"""Sink [m] that is added before the logarithm, so that small sinks differ little on the scale. The value is the default
tolerance of a comparison (``Tolerance.sink_m``)."""
SCALES: dict[Kind, Scale] = {
    "levels": Scale(float, noise=0.2, least_step=1.0),
    "collapse": Scale(float, noise=0.2, least_step=1.0),
    # A change by half counts, as in a comparison; the noise of engines that do not repeat themselves is less.
    "creep": Scale(lambda value: math.log(max(value, 0.0) + CREEP_FLOOR), noise=0.1, least_step=math.log(1.5)),
    "sink": Scale(lambda value: math.log(max(value, 0.0) + SINK_FLOOR), noise=0.05, least_step=math.log(1.2)),
    "tilt": Scale(float, noise=0.02, least_step=0.1),  # [deg]; the onset comes up to 0.1 deg late (tables.tilt)
    "time": Scale(math.log, noise=0.002, least_step=math.log(1.03), min_size=3),
}
"""Scale of each kind of figure."""
PENALTY = 4.0
"""Penalty of a step in units of the squared noise and of the logarithm of the number of versions. The value comes from
50 flat histories of 40 times with a noise of 12 % (``tests/reports/statistics/test_steps.py``, seed 24):

- with a penalty of 2 (Schwarz's criterion), 4 histories had a step;
- with a penalty of 3, one history had a step;
- with a penalty of 4, no history had a step.

The search found planted steps as often with 2 as with 6.
"""
_MAD_TO_SIGMA = 1.4826 / math.sqrt(2.0)
"""Factor from the median absolute difference of neighbours to the standard deviation of Gaussian noise."""
_LEAST_VERSIONS = 6
"""Fewest versions whose differences measure the noise. For fewer versions, the search uses the least noise of the kind,
and a kind whose ``min_size`` exceeds 1, such as times, has no steps."""


def find_steps(values: Sequence[float | None], kind: Kind) -> list[int]:
    """Return the index of the first version of each new level, in ascending order.

    Args:
        values: one value per version, in the order of the versions; None for a version without a value.
        kind: kind of the figure.
    """
    scale = SCALES[kind]
    known = [index for index, value in enumerate(values) if value is not None]
    if len(known) < 2 * scale.min_size or (scale.min_size > 1 and len(known) < _LEAST_VERSIONS):
        return []
    scaled = np.array([scale.transformed(value) for value in values if value is not None])
    if len(known) == 2:
        ends = [1]  # two versions: a change is a step if it is large enough
    else:
        noise = max(scale.noise, _noise(scaled)) if len(known) >= _LEAST_VERSIONS else scale.noise
        search = ruptures.Pelt(model="l2", min_size=scale.min_size, jump=1).fit(scaled / noise)
        ends = search.predict(pen=PENALTY * math.log(len(known)))[:-1]
        ends = _placed(scaled, ends, scale.min_size)
    return [known[end] for end in _large(scaled, ends, scale.least_step)]


def _noise(scaled: FloatArray) -> float:
    """Return the standard deviation of a value's noise, from the median, because few steps hardly change a median."""
    return _MAD_TO_SIGMA * float(np.median(np.abs(np.diff(scaled))))


def _placed(scaled: FloatArray, ends: Sequence[int], min_size: int) -> list[int]:
    """Drop the steps that are not at the best place between their neighbours.

    The search places every step between ``min_size`` values on each side. A step that is nearer to another step, or to
    an end of the history, would therefore name a wrong version.
    """
    if min_size == 1:
        return list(ends)
    kept = []
    for low, end, high in zip([0, *ends], ends, [*ends[1:], len(scaled)], strict=False):
        costs = [
            float(np.var(scaled[low:at]) * (at - low) + np.var(scaled[at:high]) * (high - at))
            for at in range(low + 1, high)
        ]
        if low + 1 + int(np.argmin(costs)) == end:
            kept.append(end)
    return kept


def _large(scaled: FloatArray, ends: Sequence[int], least: float) -> list[int]:
    """Drop the smallest step and join its segments, until every step is at least ``least``."""
    kept = list(ends)
    while kept:
        bounds = [0, *kept, len(scaled)]
        medians = [float(np.median(scaled[low:high])) for low, high in pairwise(bounds)]
        sizes = [abs(after - before) for before, after in pairwise(medians)]
        smallest = int(np.argmin(sizes))
        if sizes[smallest] >= least:
            break
        del kept[smallest]
    return kept
