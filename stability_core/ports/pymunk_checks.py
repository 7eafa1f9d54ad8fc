"""Checks of a pymunk space; error messages name the fix."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pymunk

from stability_core.port import FloatArray

_STEP = 0.02
"""Greatest difference of ``dt`` from a whole number of steps [steps], because sums of time steps round."""


def check_outside_step(space: pymunk.Space, call: str) -> None:
    """Raise ``RuntimeError`` if ``call`` happens inside a step, where pymunk aborts the process."""
    if space._locked:
        raise RuntimeError(
            f"the program called {call} inside space.step(), in a callback: call it after space.step(), because pymunk "
            "cannot make a body static inside a step"
        )


def check_awake(space: pymunk.Space) -> None:
    """Raise ``ValueError`` if Chipmunk's own sleeping is on."""
    if space.sleep_time_threshold < math.inf:
        raise ValueError(
            f"this pymunk space puts bodies to sleep after {space.sleep_time_threshold:g} s, which hides the bodies' "
            "contacts: set space.sleep_time_threshold = float('inf'), because the extension freezes bodies"
        )


def check_time(space: pymunk.Space, dt: float) -> None:
    """Raise ``ValueError`` unless ``dt`` [s] is a whole number of steps as long as the space's latest step.

    A ``dt`` of 0, and a space without a step so far, pass the check.
    """
    step = space.current_time_step
    if dt > 0.0 and step > 0.0 and (dt < step * (1 - _STEP) or abs(dt / step - round(dt / step)) > _STEP):
        raise ValueError(
            f"dt = {dt:g} s is not a whole number of this space's steps of {step:g} s: pass the time of all "
            "space.step() since the previous update()"
        )


def check_finite(bodies: Sequence[pymunk.Body], state: FloatArray) -> None:
    """Raise ``ValueError`` if a number in the states (n, 6) of n bodies is not finite."""
    if not np.isfinite(state).all():
        row = np.flatnonzero(~np.isfinite(state).all(axis=1))[0]
        raise ValueError(
            f"{bodies[row]} has a pose or a velocity that is not finite, because the simulation has diverged or the "
            "program has set the value: use a smaller step, correct the value, or remove the body"
        )
