"""Checks that the time passed to ``update`` is the time of the engine's steps: whole steps, and bodies in free flight.

A body without contacts moves by its velocity times the length of the frame. Otherwise ``dt`` is not the time of the
engine's steps. The check reports a fault if the same other multiple occurs in several frames in a row.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from stability_core.port import BoolArray, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions
from stability_core.ports.shared.body_motions import CENTER, VELOCITY, rows_of_ids

LEAST, MOST = 0.6, 1.5
"""Least and greatest plausible ratio of a body's path to its velocity times ``dt``. The ratio is 1 up to gravity and
damping. If ``dt`` covers one step and the frame has more steps, the ratio is at least 2. In the reverse case the ratio
is at most 1/2."""
FRAMES = 3
"""Number of frames in a row after which the check reports a wrong time, because a host may set a body's pose."""
SPEED = 0.2
"""Speed [m/s] above which the check uses a body in free flight, because slower bodies show large relative errors."""
ALIKE = 0.2
"""Greatest relative difference of the ratios of consecutive frames that count as the same ratio."""


_STEP = 0.02
"""Greatest difference of ``dt`` from a whole number of steps [steps], because sums of time steps round."""


def check_steps(dt: float, step_s: float, engine: str, setter: str) -> None:
    """Raise ``ValueError`` unless ``dt`` [s] is a whole number of steps of ``step_s`` [s].

    Args:
        dt: time passed to ``update``; 0 for no frame passes the check.
        step_s: time of one step of the engine.
        engine: name of the engine in the message.
        setter: call or attribute by which a user sets the step.
    """
    steps = dt / step_s
    if dt > 0.0 and (steps < 1 - _STEP or abs(steps - round(steps)) > _STEP):
        raise ValueError(
            f"dt = {dt:g} s is not a whole number of {engine}'s steps of {step_s:g} s: pass the time of all steps "
            f"since the previous update(), or set the step with {setter}"
        )


class FreeFlight:
    """Check of ``dt`` by the paths of bodies in free flight in consecutive frames."""

    def __init__(self) -> None:
        self._ratio, self._frames = 1.0, 0
        self._touching: set[int] = set()
        self._fault: str | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if the noted frames contradict ``dt``, once for each contradiction."""
        if self._fault:
            fault, self._fault = self._fault, None
            raise ValueError(fault)

    def note(
        self,
        live: Collection[int],
        touching: set[int],
        before: Motions | None,
        ids: IntArray,
        rows: FloatArray,
        dt: float,
    ) -> None:
        """Compare the path of a body in free flight with its velocity, and record a contradiction for ``check``.

        A live body is in free flight if it has no contact, neither in this frame nor in the previous frame.

        Args:
            live: the live bodies.
            touching: the bodies with contacts in this frame.
            before: motions after the previous update; None without a record.
            ids: bodies with motions, among them the live bodies, shape (n,).
            rows: present motions of these bodies, see ``body_motions``, shape (n, 13).
            dt: time passed to ``update`` [s].
        """
        earlier, self._touching = self._touching, touching
        if before is None or not len(before.body) or dt <= 0.0 or not live:
            return
        flying = [body in live and body not in touching | earlier for body in ids.tolist()]
        if not any(flying):
            return
        at, is_known = rows_of_ids(before.body, ids)
        way = rows[:, CENTER] - before.position[0, at]
        self._fault = self.fault(ids, np.array(flying) & is_known, way, before.linear[0, at], rows[:, VELOCITY], dt)

    def fault(
        self, bodies: IntArray, flying: BoolArray, way: FloatArray, before: FloatArray, now: FloatArray, dt: float
    ) -> str | None:
        """Return a message if bodies in free flight have contradicted ``dt`` in ``FRAMES`` frames in a row, else None.

        In each frame the method uses the first body that flies faster than ``SPEED``.

        Args:
            bodies: ids, shape (n,).
            flying: mask of the bodies without contacts, in this frame and in the previous frame, shape (n,).
            way: displacements since the previous update [m], shape (n, 3).
            before: velocities after the previous update [m/s], shape (n, 3).
            now: velocities [m/s], shape (n, 3).
            dt: time passed to ``update`` [s].
        """
        expected = (np.linalg.norm(before, axis=1) + np.linalg.norm(now, axis=1)) / 2 * dt
        fast = np.flatnonzero(flying & (expected > SPEED * dt))
        if not len(fast):
            self._frames = 0
            return None
        row = fast[0]
        ratio = float(np.linalg.norm(way[row]) / expected[row])
        alike = abs(ratio - self._ratio) <= ALIKE * max(ratio, self._ratio)
        self._frames = (self._frames + 1 if alike else 1) if not LEAST <= ratio <= MOST else 0
        self._ratio = ratio
        if self._frames < FRAMES:
            return None
        self._frames = 0
        return (
            f"body {bodies[row]} in free flight moved {ratio:.2g} times its velocity times dt = {dt:g} s, and the "
            f"factor was about the same in {FRAMES} frames in a row: call update() after the engine's steps, and pass "
            "the time of all steps since the previous update()"
        )
