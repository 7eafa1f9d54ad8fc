"""DART's knobs: where each is set, and how the solver's tolerances follow the mass of the bricks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import dartpy

from adapters.profile import Sleeping
from scenarios.model import Brick

_MATRIX_FREE_OPTIONS = {
    "matrix_free": "mEnabled",
    "matrix_free_min_rows": "mMinRows",
    "matrix_free_max_iterations": "mMaxIterations",
    "matrix_free_delta_tolerance": "mDeltaTolerance",
    "matrix_free_relative_tolerance": "mRelativeDeltaTolerance",
}
"""Knob -> field of ``MatrixFreeContactSolverOptions``."""

_IMPULSE_TOLERANCES = ("matrix_free_delta_tolerance", "matrix_free_relative_tolerance")
"""Knobs that are impulses [N s], chosen for planks; in scenes of heavier or lighter bricks they are larger or smaller
alike."""
_PLANK_MASS = 0.0119
"""Mass [kg] of the planks for which they were chosen."""

KNOBS = frozenset({"collision_detector", "max_contacts", *_MATRIX_FREE_OPTIONS})
"""Knobs that a profile may have."""

RAISED_THRESHOLD = 5.0
"""Factor on the shipped speed thresholds (0.01 m/s, 0.05 rad/s) when sleeping is "raised": 0.05 m/s lies above what
a settling stack still moves, and well below one frame of free fall (0.16 m/s)."""


def configure(world: Any, knobs: Mapping[str, float | int | str | bool], bricks: Sequence[Brick]) -> None:
    """Set a world's knobs; ``bricks`` are those that are expected, which the impulse tolerances must suit."""
    if "collision_detector" in knobs:
        detectors = dartpy.simulation.CollisionDetectorType
        world.setCollisionDetector(getattr(detectors, str(knobs["collision_detector"])))
    solver = world.getConstraintSolver()
    options = solver.getMatrixFreeContactSolverOptions()
    for knob, option in _MATRIX_FREE_OPTIONS.items():
        if knob in knobs:
            setattr(options, option, knobs[knob])
    for knob in _IMPULSE_TOLERANCES:
        if knob in knobs:
            setattr(options, _MATRIX_FREE_OPTIONS[knob], float(knobs[knob]) * _mass_in_planks(bricks))
    solver.setMatrixFreeContactSolverOptions(options)


def allow_sleep(world: Any, sleeping: Sleeping) -> None:
    """Switch DART's own sleeping off or on, or raise its thresholds."""
    deactivation = world.getDeactivationOptions()
    deactivation.mEnabled = sleeping != "off"
    if sleeping == "raised":
        deactivation.mLinearSpeedThreshold *= RAISED_THRESHOLD
        deactivation.mAngularSpeedThreshold *= RAISED_THRESHOLD
    world.setDeactivationOptions(deactivation)


def _mass_in_planks(bricks: Sequence[Brick]) -> float:
    """Return the mass that the impulse tolerances suit, over that of a plank.

    - The lightest expected brick is heavier than a plank: that brick. Blocks of 4 kg, solved to the 1e-7 N s of
      planks of 12 g, take all iterations, and then the dense solver.
    - The heaviest one is lighter than a plank: that brick. Planks of 12 mg, whose weight is 5e-7 N s a step, fall
      through the ground if solved to 3e-7 N s.
    - Otherwise a plank: pieces of planks are few.
    """
    masses = [brick.mass for brick in bricks if not brick.moved] or [_PLANK_MASS]
    return max(1.0, min(masses) / _PLANK_MASS) * min(1.0, max(masses) / _PLANK_MASS)
