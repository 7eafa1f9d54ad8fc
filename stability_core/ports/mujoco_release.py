"""Differences between releases of MuJoCo, so that the port also runs on earlier releases.

- 3.2.1 made the automatic reset of a diverged world optional. Earlier releases silently return a diverged world to its
  start.
- 3.4.0 introduced sleeping. In earlier releases a parked body costs time in every step, because the body cannot sleep.
- 3.5.0 introduced the sum of the gaps of two geoms. In earlier releases the larger gap counts.
- 3.9.0 lists contacts up to ``margin + gap``, with force from ``margin`` on. Earlier releases list contacts up to
  ``margin``, with force from ``margin - gap`` on.
- 4.0.0 introduced speculative contacts.
"""

from __future__ import annotations

import mujoco

HAS_AUTORESET = hasattr(mujoco.mjtDisableBit, "mjDSBL_AUTORESET")
"""True if MuJoCo can switch off the automatic reset."""
HAS_SLEEP = hasattr(mujoco, "mjtSleepPolicy")
"""True if bodies can sleep."""
HAS_SPECULATIVE = hasattr(mujoco.mjtEnableBit, "mjENBL_SPECULATIVE")
"""True if MuJoCo has speculative contacts."""
_RELEASE = tuple(int(part) for part in mujoco.__version__.split(".")[:2])
_SUMS_GAPS, _LISTS_BEYOND_MARGIN = _RELEASE >= (3, 5), _RELEASE >= (3, 9)

SLEEP_ALLOWED = mujoco.mjtSleepPolicy.mjSLEEP_ALLOWED.value if HAS_SLEEP else 0
"""Sleep policy of a body that may sleep."""
SLEEP_NEVER = mujoco.mjtSleepPolicy.mjSLEEP_NEVER.value if HAS_SLEEP else 0
"""Sleep policy of a body that must not sleep."""
SLEEPING_OR_SPECULATIVE = (mujoco.mjtEnableBit.mjENBL_SLEEP.value if HAS_SLEEP else 0) | (
    mujoco.mjtEnableBit.mjENBL_SPECULATIVE.value if HAS_SPECULATIVE else 0
)
"""Flags that make MuJoCo omit sleeping pairs, or list distances without a measurement."""

_BAD_STATES = [int(getattr(mujoco.mjtWarning, f"mjWARN_BAD{state}")) for state in ("QPOS", "QVEL", "QACC")]


def detection_attributes(gap: float) -> dict[str, float]:
    """Return the geom attributes with which two bodies list contacts up to a distance of ``2 * gap``, without force.

    Args:
        gap: half of the distance [m].
    """
    own = gap if _SUMS_GAPS else 2 * gap
    return {"gap": own} if _LISTS_BEYOND_MARGIN else {"gap": own, "margin": own}


def has_reset(data: mujoco.MjData) -> bool:
    """Return True if MuJoCo has warned of a diverged state. With the automatic reset, the world then starts again."""
    return bool(data.warning.number[_BAD_STATES].any())
