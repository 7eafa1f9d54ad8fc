"""DART's knobs: the option that each knob sets, and the scaling of the solver's tolerances with the bricks' mass."""

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
"""Map from a knob to the field of ``MatrixFreeContactSolverOptions`` that the knob sets."""

_IMPULSE_TOLERANCES = ("matrix_free_delta_tolerance", "matrix_free_relative_tolerance")
"""Knobs that are impulses [N s], chosen for planks. ``configure`` scales these impulses with the mass of heavier or
lighter bricks."""
_PLANK_MASS = 0.0119
"""Mass [kg] of the plank that determines ``_IMPULSE_TOLERANCES``."""

_DEACTIVATION_OPTIONS = {
    "deactivation": "mEnabled",
    "deactivation_linear_speed": "mLinearSpeedThreshold",
    "deactivation_angular_speed": "mAngularSpeedThreshold",
}
"""Map from a knob of DART's own sleeping to the field of ``DeactivationOptions`` that the knob sets."""

KNOBS = frozenset({"collision_detector", "max_contacts", *_MATRIX_FREE_OPTIONS, *_DEACTIVATION_OPTIONS})
"""Knobs that a profile may have."""

HAS_MATRIX_FREE = hasattr(dartpy.simulation.World().getConstraintSolver(), "getMatrixFreeContactSolverOptions")
"""True if DART has the matrix-free solver, which came with 6.20.0."""
HAS_DEACTIVATION = hasattr(dartpy.simulation.World, "getDeactivationOptions")
"""True if DART can deactivate bodies at rest."""
MISSING_KNOBS = frozenset(
    {*(() if HAS_MATRIX_FREE else _MATRIX_FREE_OPTIONS), *(() if HAS_DEACTIVATION else _DEACTIVATION_OPTIONS)}
)
"""Knobs that this release does not have."""


def configure(world: Any, knobs: Mapping[str, KnobValue], bricks: Sequence[Brick]) -> None:
    """Set a world's knobs, with impulse tolerances scaled to the mass of the expected ``bricks``."""
    solver = world.getConstraintSolver()
    if "collision_detector" in knobs:
        _set_detector(world, solver, str(knobs["collision_detector"]))
    if HAS_DEACTIVATION:
        deactivation = world.getDeactivationOptions()
        _set_fields(deactivation, _DEACTIVATION_OPTIONS, knobs)
        world.setDeactivationOptions(deactivation)
    if not HAS_MATRIX_FREE:
        return
    options = solver.getMatrixFreeContactSolverOptions()
    _set_fields(options, _MATRIX_FREE_OPTIONS, knobs)
    for knob in _IMPULSE_TOLERANCES:
        if knob in knobs:
            setattr(options, _MATRIX_FREE_OPTIONS[knob], float(knobs[knob]) * _mass_in_planks(bricks))
    solver.setMatrixFreeContactSolverOptions(options)


def _set_detector(world: Any, solver: Any, name: str) -> None:
    """Choose the collision detector of a world by its name in DART, such as ``DART`` or ``FCL``."""
    detectors = getattr(dartpy.simulation, "CollisionDetectorType", None)
    if detectors is None:  # before 6.20
        solver.setCollisionDetector(getattr(dartpy.collision, f"{name}CollisionDetector")())
    else:
        world.setCollisionDetector(getattr(detectors, name))


def _set_fields(options: Any, fields: Mapping[str, str], knobs: Mapping[str, KnobValue]) -> None:
    """Write the knobs that are keys of ``fields`` into the fields of an options structure."""
    for knob, field in fields.items():
        if knob in knobs:
            setattr(options, field, knobs[knob])


def _mass_in_planks(bricks: Sequence[Brick]) -> float:
    """Return the factor on the impulse tolerances: the ratio of a reference mass to the mass of a plank.

    The function ignores moved bricks. The reference mass is the mass of

    - the lightest expected brick, if all expected bricks are heavier than a plank. With 1e-7 N s, the tolerance of
      planks of 12 g, the solver exhausts its iterations on blocks of 4 kg;
    - the heaviest expected brick, if all expected bricks are lighter than a plank. With a tolerance of 3e-7 N s, planks
      of 12 mg, whose weight is 5e-7 N s per step, fall through the ground;
    - a plank otherwise, because the lightest brick is then a piece of a plank, and few scenes have pieces of planks.
    """
    masses = [brick.mass for brick in bricks if not brick.moved] or [_PLANK_MASS]
    return max(1.0, min(masses) / _PLANK_MASS) * min(1.0, max(masses) / _PLANK_MASS)


def read_knobs(world: Any, knobs: Mapping[str, KnobValue]) -> dict[str, KnobValue]:
    """Return the present values of the knobs that are options of the world, except the impulse tolerances."""
    owners = []
    if HAS_MATRIX_FREE:
        owners.append((_MATRIX_FREE_OPTIONS, world.getConstraintSolver().getMatrixFreeContactSolverOptions()))
    if HAS_DEACTIVATION:
        owners.append((_DEACTIVATION_OPTIONS, world.getDeactivationOptions()))
    return {
        name: getattr(owner, field)
        for fields, owner in owners
        for name, field in fields.items()
        if name in knobs and name not in _IMPULSE_TOLERANCES
    }
