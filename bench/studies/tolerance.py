"""Tolerances of a comparison: the differences of outcome and time up to which a trial is no regression."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class Tolerance(BaseModel):
    """Tolerances of the gates, for all trials of a scenario; a study may set these tolerances.

    The outcome gate and the time gate apply the tolerances in every comparison of runs. An engine that repeats bit for
    bit has equal outcomes in two runs of the same versions on the same processor. The outcomes of such runs need no
    tolerance. Frame times vary from run to run, so that the time gate always needs ``time_share``.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    levels: int = Field(default=0, ge=0)
    """Tolerated loss [levels] of height, or growth of the error of the collapse level. The default is zero, because a
    user notices a missing level. A verdict that was right must stay right at any tolerance."""
    sink_m: float = Field(default=5e-5, ge=0)
    """Tolerated increase of the sink [m]. The default is a quarter of 0.2 mm, which is the greatest depth in its
    support at which the core freezes a flat plank (``Settings.rest_penetration``)."""
    sink_share: float = Field(default=0.2, ge=0)
    """Additionally tolerated increase of the sink, as a share of the base's sink."""
    creep_m_s: float = Field(default=1e-6, ge=0)
    """Tolerated increase of the creep [m/s]: 2.5 micrometres over the last half of a watch of 5 s. Smaller changes are
    random, because a stack that is released a nanometre aside creeps at 1.4 instead of 0.7 micrometres per second on
    Bullet."""
    creep_share: float = Field(default=0.5, ge=0)
    """Additionally tolerated increase of the creep, as a share of the base's creep. The defaults detect a doubled
    creep if the base creeps faster than 2e-6 m/s. They tolerate the effect of another processor's rounding on a slow
    slide. A creep of the head whose interval includes zero is no increase."""
    time_share: float = Field(default=0.1, ge=0)
    """Least slowdown that counts, as a share of the base's time, because a smaller slowdown needs no attention."""
