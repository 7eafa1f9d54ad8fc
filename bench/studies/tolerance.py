"""Tolerances of a comparison: the differences of outcome and time up to which a trial is no regression."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class Tolerance(BaseModel):
    """Tolerances of the gates, for all trials of a scenario; a study may set these tolerances.

    An engine that repeats bit for bit needs no tolerance on the same machine. Tolerances apply to its next version, to
    another processor, and to engines that do not repeat bit for bit.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    levels: int = Field(default=0, ge=0)
    """Tolerated difference [levels] in the height of a stack, or in its collapse level. The default is zero, because a
    user notices a missing level. A verdict that was right must stay right at any tolerance."""
    sink_m: float = Field(default=5e-5, ge=0)
    """Tolerated increase of the sink [m]. The default is a quarter of 0.2 mm, which is the greatest depth of a brick in
    its support at which the core freezes the brick."""
    sink_share: float = Field(default=0.2, ge=0)
    """Additionally tolerated increase of the sink, as a share of the base's sink."""
    creep_m_s: float = Field(default=1e-6, ge=0)
    """Tolerated increase of the creep [m/s]: 2.5 micrometres over the last half of a watch of 5 s. Smaller changes are
    random, because a stack that is released a nanometre aside creeps at 1.4 instead of 0.7 micrometres per second on
    Bullet."""
    creep_share: float = Field(default=0.5, ge=0)
    """Additionally tolerated increase of the creep, as a share of the base's creep. The default detects a doubled
    creep, and tolerates the effect of another processor's rounding on a slow slide. A creep whose interval includes
    zero counts as zero."""
    time_share: float = Field(default=0.1, ge=0)
    """Least slowdown that counts, as a share of the base's time, because a smaller slowdown needs no attention."""
