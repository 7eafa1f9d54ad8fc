"""Shock propagation after Erleben 2007: a reference engine, written in this repository.

Each step first solves the contacts of the whole stack. Then the step solves one layer after the other from the ground
up, each layer on a fixed floor: see ``_erleben_solver``. With the fraction phi = 0, the value in the author's code,
structured stacks stand without sinking at little cost. Stacks that must fall stand as well, because no layer carries
the weight above.

Forces: the impulses of a layer carry only the bodies of this layer, not the bodies above. Therefore the adapter reports
no forces.

The author's code skips a group of bodies that are slower than 4.5 mm/s in five steps. This adapter skips no group,
because the policies of the suite have this task.
"""

from __future__ import annotations

from collections.abc import Mapping

from adapters._erleben_solver import ErlebenSolver
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.reference.contact_rows import ContactRows
from adapters.reference.detector import FoundContacts
from adapters.reference.simulation import ReferenceSimulation
from stability_core.port import FloatArray

KNOBS = frozenset({"fraction", "sweeps"})
"""Knobs that a profile may have."""

_SETTINGS = load_settings("erleben", KNOBS.__contains__)


class ErlebenSimulation(ReferenceSimulation):
    """One world of the reference engine ``erleben``."""

    engine = "erleben"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "sweeps"
    capabilities = Capabilities(
        contact_points="up to 8 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="no",
        freeze="fixed box",
        frozen_contacts=False,
        friction_law="box along the sliding direction",
        moved="prescribed velocity",
        deterministic="across processes",
        reference=True,
    )

    def _open(self) -> None:
        if self.info.sleeping != "off":
            raise NotImplementedError(
                "erleben: this reference engine has no sleeping of its own: use policy 'none', or sleeping='off'"
            )
        knobs = self.info.profile.values
        fraction = float(knobs["fraction"])
        if not 0.0 <= fraction <= 1.0:
            raise ValueError(
                f"erleben: the knob 'fraction' must be a number from 0 to 1, got {fraction}: correct the profile "
                f"'{self.info.profile.name}'"
            )
        self._solver = ErlebenSolver(self.world.friction, fraction, int(knobs["sweeps"]))
        super()._open()

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return {"fraction": self._solver.fraction, "sweeps": self._solver.sweeps}

    def _solve(
        self,
        problem: ContactRows,
        found: FoundContacts,  # noqa: ARG002 - no impulse outlives the step
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self._solver.solve(problem)
