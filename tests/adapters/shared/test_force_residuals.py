"""Residuals of contact forces: by hand, on contacts of which every figure is known."""

from dataclasses import replace

import numpy as np
import pytest

from adapters.shared.force_residuals import complementarity, cone_excess, ground_force
from stability_core.port import GROUND, Contacts

WEIGHT, THICKNESS = 2.0, 0.01


def contacts(*rows: tuple[int, int, float, tuple[float, float, float]]) -> Contacts:
    """Level contacts of bodies a and b with a separation [m] and a force on b [N], mu = 0.5."""
    n = len(rows)
    up, nothing = np.tile([0.0, 0.0, 1.0], (n, 1)), np.zeros((n, 3))
    body_a, body_b = (np.array([row[side] for row in rows]) for side in (0, 1))
    separation, force = np.array([row[2] for row in rows]), np.array([row[3] for row in rows])
    return Contacts(body_a, body_b, nothing, up, separation, nothing, np.full(n, 0.5), force)


def test_the_ground_carries_what_it_presses_on_either_side() -> None:
    seen = contacts((GROUND, 0, 0.0, (0.1, 0.0, 3.0)), (1, GROUND, 0.0, (0.0, 0.2, -1.0)), (0, 1, 0.0, (0.0, 0.0, 9.0)))
    assert ground_force(seen) == pytest.approx([0.1, -0.2, 4.0])


def test_friction_counts_beyond_mu_times_the_normal_force() -> None:
    inside, at, beyond, pull = (0.3, 0.4, 1.2), (0.3, 0.4, 1.0), (0.6, 0.8, 1.0), (0.0, 0.1, -1.0)
    seen = contacts(*((0, 1, 0.0, force) for force in (inside, at, beyond, pull)))
    assert cone_excess(seen) == pytest.approx([0.0, 0.0, 0.5, 0.6])


def test_the_natural_residual_is_overlap_pull_or_the_lesser_of_force_and_gap() -> None:
    seen = contacts(
        (0, 1, 0.0, (0.0, 0.0, 2.0)),  # touches and bears
        (0, 1, -1e-4, (0.0, 0.0, 2.0)),  # overlaps by a hundredth of a thickness
        (0, 1, 1e-3, (0.0, 0.0, 2.0)),  # bears a weight across a tenth of a thickness
        (0, 1, 1e-3, (0.0, 0.0, 0.02)),  # bears a hundredth of a weight there
        (0, 1, 1e-3, (0.0, 0.0, 0.0)),  # is apart
        (0, 1, 0.0, (0.0, 0.0, -0.4)),  # pulls with a fifth of a weight
    )
    assert complementarity(seen, WEIGHT, THICKNESS) == pytest.approx([0.0, 0.01, 0.1, 0.01, 0.0, 0.2])


def test_without_forces_the_message_names_the_capabilities() -> None:
    seen = replace(contacts((0, 1, 0.0, (0.0, 0.0, 0.0))), force=None)
    with pytest.raises(
        ValueError, match=r"contacts.force must hold forces, got None: use an engine whose capabilities state forces"
    ):
        cone_excess(seen)
