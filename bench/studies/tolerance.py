"""Tolerances: how much worse a trial may come out before it counts as a regression. A study may set them."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class Tolerance(BaseModel):
    """Tolerances of the gates, for all trials of a scenario.

    An engine that repeats itself bit for bit needs none on the same machine. They are for its next version, another
    processor, and engines that do not repeat themselves.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    levels: int = Field(default=0, ge=0)
    """Levels by which a stack may fall short, or fall too early or late. Zero, because a user sees one level less. A
    verdict that was right must stay right at any tolerance."""
    sink_m: float = Field(default=5e-5, ge=0)
    """Deeper sink [m] that is always tolerated: a quarter of the 0.2 mm at which the core freezes a brick."""
    sink_share: float = Field(default=0.2, ge=0)
    """Deeper sink that is tolerated, as a share of the base's."""
    creep_m_s: float = Field(default=1e-6, ge=0)
    """Faster creep [m/s] that is allowed in any case: 2.5 micrometres over the last half of a watch of 5 s. Below
    it lies chance: a stack that is let go a nanometre aside creeps at 1.4 in place of 0.7 micrometres a second on
    Bullet."""
    creep_share: float = Field(default=0.5, ge=0)
    """Faster creep that is allowed, as a share of the base's; a creep whose interval includes zero is none.
    It must find a doubled one, and let what another processor's last digits do to a slow slide pass."""
    time_share: float = Field(default=0.1, ge=0)
    """Least slowdown that counts, as a share of the base's time: less does not justify a developer's attention."""
