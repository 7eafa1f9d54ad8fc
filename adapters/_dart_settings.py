"""DART's knobs: where each is set, and how the solver's tolerances follow the mass of the bricks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import dartpy

from adapters.profile import KnobValue
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

_DEACTIVATION_OPTIONS = {
    "deactivation": "mEnabled",
    "deactivation_linear_speed": "mLinearSpeedThreshold",
    "deactivation_angular_speed": "mAngularSpeedThreshold",
}
"""Knob -> field of ``DeactivationOptions``, DART's own sleeping."""

KNOBS = frozenset({"collision_detector", "max_contacts", *_MATRIX_FREE_OPTIONS, *_DEACTIVATION_OPTIONS})
"""Knobs that a profile may have."""


def configure(world: Any, knobs: Mapping[str, KnobValue], bricks: Sequence[Brick]) -> None:
    """Set a world's knobs; ``bricks`` are those that are expected, which the impulse tolerances must suit."""
    if "collision_detector" in knobs:
        detectors = dartpy.simulation.CollisionDetectorType
        world.setCollisionDetector(getattr(detectors, str(knobs["collision_detector"])))
    deactivation = world.getDeactivationOptions()
    _set_fields(deactivation, _DEACTIVATION_OPTIONS, knobs)
    world.setDeactivationOptions(deactivation)
    solver = world.getConstraintSolver()
    options = solver.getMatrixFreeContactSolverOptions()
    _set_fields(options, _MATRIX_FREE_OPTIONS, knobs)
    for knob in _IMPULSE_TOLERANCES:
        if knob in knobs:
            setattr(options, _MATRIX_FREE_OPTIONS[knob], float(knobs[knob]) * _mass_in_planks(bricks))
    solver.setMatrixFreeContactSolverOptions(options)


def _set_fields(options: Any, fields: Mapping[str, str], knobs: Mapping[str, KnobValue]) -> None:
    """Write those of the knobs that are ``fields`` of a structure of options into it."""
    for knob, field in fields.items():
        if knob in knobs:
            setattr(options, field, knobs[knob])


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


def read_knobs(world: Any, knobs: Mapping[str, KnobValue]) -> dict[str, KnobValue]:
    """Return those of the knobs that are options of the world, but for those that follow the bricks' mass."""
    options = world.getConstraintSolver().getMatrixFreeContactSolverOptions()
    owners = ((_MATRIX_FREE_OPTIONS, options), (_DEACTIVATION_OPTIONS, world.getDeactivationOptions()))
    return {
        name: getattr(owner, field)
        for fields, owner in owners
        for name, field in fields.items()
        if name in knobs and name not in _IMPULSE_TOLERANCES
    }
