"""Search for a quaternion that Rapier's scaling to unit length keeps, so that a frozen body does not turn by a bit."""

from __future__ import annotations

import itertools
from typing import TypeAlias

import numpy as np
import rapier3d

Quaternion: TypeAlias = tuple[float, float, float, float]


def settle_rotation(view: rapier3d.RigidBody) -> None:
    """Change a body's quaternion until Rapier's scaling to unit length no longer changes any bit.

    One scaling is enough for most quaternions. Repeated scaling alone may run in a cycle. Therefore the function
    reduces one component by its last bit between attempts, and takes another component each time.
    """
    components = itertools.cycle(range(4))
    while (scaled := _scaled_once(view)) is not None:
        nudged = np.array(scaled, np.float32)
        component = next(components)
        nudged[component] = np.nextafter(nudged[component], np.float32(0.0))
        view.rotation = nudged.tolist()


def _scaled_once(view: rapier3d.RigidBody) -> Quaternion | None:
    """Return the quaternion (x, y, z, w) after one more scaling; None if the scaling changed nothing."""
    before = view.rotation.to_tuple()
    view.rotation = before  # type: ignore[assignment] # the setter takes tuples, which it scales
    after = view.rotation.to_tuple()
    return None if after == before else after
