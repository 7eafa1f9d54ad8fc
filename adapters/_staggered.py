"""Staggered projections after Kaufman et al. 2008: a reference engine, written in this repository.

Each step alternates two quadratic programs, for impact and for friction, until both agree or the turns are exhausted:
see ``_staggered_solver``. The engine contains no scene, no sleeping and no policy, and shares no code with the judge
(``scenarios.statics``). Therefore its results are independent of the suite. Use the engine for scenes of up to about 50
bricks, because the engine is slow.

Overlaps: the contacts of a step do not add to an overlap, but rotation and placing cause overlaps. If the deepest
overlap exceeds 0.01 mm, each step removes the share ``overlap_share`` of every overlap by displacements, so that the
removal adds no velocity.

Warm start: each contact starts with the friction of the step before, at the nearest point of the same pair. At rest the
first impact program then agrees with the friction, and the step solves one program only.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from adapters._staggered_solver import CONES, StaggeredSolver, Turns
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.reference.contact_rows import ContactRows
from adapters.reference.detector import FoundContacts
from adapters.reference.impulse_matching import moved_to
from adapters.reference.simulation import ReferenceSimulation
from scenarios.lookup import one_of
from stability_core.port import FloatArray

KNOBS = frozenset({"tolerance", "turns", "memory", "cone", "overlap_share"})
"""Knobs that a profile may have."""
DEEP = 1e-5
"""Depth [m] of the deepest overlap from which a step corrects overlaps. Smaller overlaps are not visible."""
MOST_PUSHED = 2e-3
"""Greatest overlap [m] that a step removes, so that a deep overlap does not throw bodies."""

_SETTINGS = load_settings("staggered", KNOBS.__contains__)


class StaggeredSimulation(ReferenceSimulation):
    """One world of the reference engine ``staggered``."""

    engine = "staggered"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "turns"
    capabilities = Capabilities(
        contact_points="up to 8 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal and friction",
        freeze="fixed box",
        frozen_contacts=False,
        friction_law="box along the sliding direction, or disc",
        moved="prescribed velocity",
        deterministic="across processes",
        reference=True,
    )

    def _open(self) -> None:
        if self.info.sleeping != "off":
            raise NotImplementedError(
                "staggered: this reference engine has no sleeping of its own: use policy 'none', or sleeping='off'"
            )
        knobs = self.info.profile.values
        self._share = float(knobs["overlap_share"])
        cone = str(knobs["cone"])
        if cone not in CONES:
            raise ValueError(
                f"staggered: the knob 'cone' must be {one_of(CONES)}, got {cone!r}: correct the profile "
                f"'{self.info.profile.name}'"
            )
        self._solver = StaggeredSolver(
            self.world.friction, float(knobs["tolerance"]), int(knobs["turns"]), int(knobs["memory"]), cone
        )
        self._friction: tuple[FoundContacts, FloatArray] | None = None  # of the step before, in the world's frame [N s]
        self.turns = Turns(0, 0.0, 0.0)
        """Record of the latest step."""
        super()._open()

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        solver = self._solver
        return {
            "tolerance": solver.tolerance,
            "turns": solver.most_turns,
            "memory": solver.memory,
            "cone": solver.cone,
            "overlap_share": self._share,
        }

    def _solver_iterations(self) -> int | None:
        return self.turns.count

    def _solve(self, problem: ContactRows, found: FoundContacts) -> tuple[FloatArray, FloatArray, FloatArray]:
        warm = np.zeros((len(found), 2))
        if self._friction is not None:
            vectors = moved_to(found, *self._friction)
            warm = (problem.axes[:, 1:] * vectors[:, None, :]).sum(axis=2) / problem.impulse_unit
        velocity, impulse, self.turns = self._solver.solve(problem, warm)
        tangential = (impulse[:, 1:, None] * problem.axes[:, 1:]).sum(axis=1)
        self._friction = found, tangential * problem.impulse_unit
        way = problem.velocity_unit * self._substep_s
        correction = np.zeros_like(velocity)
        if len(found) and float(problem.gap.min()) * way < -DEEP * self.scale:
            correction = self._solver.correction(problem, velocity, self._share, MOST_PUSHED * self.scale / way)
        return velocity, impulse, correction
