"""Audit the contact forces that an engine reports.

The audit measures three quantities in each frame:

- the vertical force of ground and fixed bodies on the bricks, as a share of the weight of all bricks;
- the greatest excess of a contact force over its friction cone, as a share of the mean weight of a brick;
- the greatest residual of complementarity, which demands that no force acts across a gap, no contact pulls, and no
  bodies overlap.
"""

from __future__ import annotations

import statistics
from typing import Any

import numpy as np

from adapters.base import Simulation
from adapters.shared.force_residuals import complementarity, cone_excess, ground_force

UP = 2
"""Index of the vertical component of a vector."""


class ForceAudit:
    """Audit of the contact forces during the watch of a finished stack."""

    def __init__(self, simulation: Simulation) -> None:
        """Make the engine record contacts and forces from its first step on."""
        self._simulation = simulation
        _ = simulation.port
        self._carried: list[float] = []
        self._excess: list[float] = []
        self._residual: list[float] = []

    def see(self) -> None:
        """Add the contacts after the latest step to the audit; do nothing without forces, contacts or bricks."""
        contacts = self._simulation.port.contacts()
        bricks = self._simulation.bricks.values()
        if contacts.force is None or not len(contacts) or not bricks:
            return
        strength = float(np.linalg.norm(self._simulation.world.gravity))
        weights = [brick.mass * strength for brick in bricks]
        weight, thickness = statistics.fmean(weights), min(min(brick.size) for brick in bricks)
        self._carried.append(float(ground_force(contacts)[UP]) / sum(weights))
        self._excess.append(float(cone_excess(contacts).max()) / weight)
        residual = complementarity(contacts, weight, thickness)
        if np.isfinite(residual).any():
            self._residual.append(float(np.nanmax(residual)))

    def fields(self) -> dict[str, Any]:
        """Return the fields for the record: means over the audited frames; leave out fields without a value."""
        measured = {
            "carried_share": self._carried,
            "cone_excess": self._excess,
            "complementarity": self._residual,
        }
        return {name: statistics.fmean(values) for name, values in measured.items() if values}
