"""Checks of the contact forces that the port reports: balance with the load on a brick, and the laws of contact."""

from __future__ import annotations

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import (
    GRAVITY,
    MASS,
    THICKNESS,
    Rig,
    advance,
    frozen_column,
    place_on,
    plank,
    require,
    require_between,
    touching,
)
from adapters.shared.force_residuals import cone_excess
from stability_core.port import GROUND, Contacts, FloatArray

FRAMES = 20
"""Number of frames of the mean of a force; one frame is too few, because the load may shift among a brick's corners."""
CARRYING_GAP = 0.1e-3
"""Greatest reported gap [m] of a contact with a force, because in all engines only bodies that touch exert forces."""
PRECISION = 0.02
"""Greatest ratio of a force's error to the weight of a brick, because in a scaled world some solvers err by 1 %."""


def _forces(simulation: Simulation) -> tuple[Contacts, FloatArray]:
    """Return the contacts after the latest step and their forces (n, 3) [N].

    Raises:
        ConformanceError: if the forces are None, have another shape, are not finite, or pull.
    """
    contacts = simulation.port.contacts()
    force = contacts.force
    require(force is not None, "Contacts.force is None, must hold forces, as the engine's capabilities state")
    assert force is not None
    require(
        force.shape == (len(contacts), 3),
        f"Contacts.force has the shape {force.shape}, must be {(len(contacts), 3)}",
    )
    require(bool(np.isfinite(force).all()), "Contacts.force has NaN or inf, must have finite numbers")
    pull = -min(np.einsum("ij,ij->i", force, contacts.normal), default=0.0)
    # 1e-3: rounding in single precision, and a normal that turned within the frame.
    require_between(
        -np.inf, pull / (MASS * GRAVITY), 1e-3, "pull of a contact at its bodies, over the weight of a brick"
    )
    return contacts, force


def _mean_force(simulation: Simulation, body: int, other: int) -> FloatArray:
    """Return the mean force (3,) of ``other`` on ``body`` in ``FRAMES`` frames, in units of the weight of a brick."""
    total = np.zeros(3)
    for _ in range(FRAMES):
        simulation.step(simulation.info.frame_s)
        contacts, force = _forces(simulation)
        is_b = (contacts.body_b == body) & (contacts.body_a == other)
        is_a = (contacts.body_a == body) & (contacts.body_b == other)
        total += force[is_b].sum(axis=0) - force[is_a].sum(axis=0)
    mean: FloatArray = total / (FRAMES * MASS * GRAVITY)
    return mean


def carries_a_resting_brick(rig: Rig) -> None:
    """Check that contact forces add up to the weight of a brick at rest on the ground and on a frozen brick."""
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1, xs=(0.3,))
    on_ground, on_frozen = place_on(simulation, 0), place_on(simulation, 1, x=0.3)
    advance(simulation, 1.0)
    for body, other, where in ((on_ground, GROUND, "the ground"), (on_frozen, support, "a frozen brick")):
        force = _mean_force(simulation, body, other)
        error = np.abs(force - (0.0, 0.0, 1.0)).max()
        require_between(0.0, error, PRECISION, f"error of the force over the weight of a brick at rest on {where}")


def carries_each_level(rig: Rig) -> None:
    """Check that each interface in a stack of three live bricks bears the weight of the bricks above it."""
    simulation = rig.open()
    stack = [simulation.spawn(plank(z=(level + 0.5) * THICKNESS)) for level in range(3)]
    advance(simulation, 0.5)
    for body, other, load in ((stack[0], GROUND, 3), (stack[1], stack[0], 2), (stack[2], stack[1], 1)):
        force = _mean_force(simulation, body, other)
        error = np.abs(force - (0.0, 0.0, load)).max()
        require_between(0.0, error, load * PRECISION, f"error of the force below {load} bricks over a weight")


def resists_a_steady_push(rig: Rig) -> None:
    """Check that friction balances a steady force of 0.2 weights of a brick, below the limit of 0.45 weights."""
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1, xs=(0.3,))
    on_ground, on_frozen = place_on(simulation, 0), place_on(simulation, 1, x=0.3)
    advance(simulation, 1.0)
    for body in (on_ground, on_frozen):
        simulation.apply_force(body, (0.2 * MASS * GRAVITY, 0.0, 0.0))
    advance(simulation, 0.3)
    for body, other, where in ((on_ground, GROUND, "the ground"), (on_frozen, support, "a frozen brick")):
        force = _mean_force(simulation, body, other)
        error = np.abs(force - (-0.2, 0.0, 1.0)).max()
        require_between(0.0, error, PRECISION, f"error of the force over the weight of a brick pushed on {where}")


def keeps_forces_within_the_laws_of_contact(rig: Rig) -> None:
    """Check that friction stays inside Coulomb's cone at each contact, and that no contact bears load across a gap.

    ``PRECISION`` and ``CARRYING_GAP`` are the tolerances.
    """
    simulation = rig.open()
    stack = [simulation.spawn(plank(z=(level + 0.5) * THICKNESS)) for level in range(3)]
    alone = place_on(simulation, 0, x=0.3)
    advance(simulation, 1.0)
    for body in (stack[-1], alone):
        simulation.apply_force(body, (0.4 * MASS * GRAVITY, 0.0, 0.0))
    advance(simulation, 0.3)
    excess, gap = [], -np.inf
    for _ in range(FRAMES):
        simulation.step(simulation.info.frame_s)
        contacts, force = _forces(simulation)
        excess.append(cone_excess(contacts).max() / (MASS * GRAVITY))
        bears = np.einsum("ij,ij->i", force, contacts.normal) > PRECISION * MASS * GRAVITY
        gap = max(gap, np.nanmax(contacts.separation[bears], initial=-np.inf))
    require_between(
        0.0, float(np.mean(excess)), PRECISION, "excess of friction over mu times the normal force, in weights"
    )
    require_between(-np.inf, float(gap), CARRYING_GAP, "gap [m] across which a contact bears load")


def reports_no_forces(rig: Rig) -> None:
    """Check that ``Contacts.force`` is None for an engine whose capabilities state no forces."""
    simulation = rig.open()
    body = place_on(simulation, 0)
    advance(simulation, 1.0)
    contacts = touching(simulation.port.contacts(), body)
    require(len(contacts) > 0, "a brick at rest has no contact, must have one or more")
    require(contacts.force is None, "Contacts.force holds forces, must be None, as the engine's capabilities state")


def forgets_forces_without_a_step(rig: Rig) -> None:
    """Check that ``find_contacts`` reports contacts without forces, because no step has solved them."""
    simulation = rig.open()
    body = place_on(simulation, 0)
    advance(simulation, 1.0)
    simulation.find_contacts()
    contacts = touching(simulation.port.contacts(), body)
    require(len(contacts) > 0, "find_contacts lists no contact of a brick at rest, must list one or more")
    require(contacts.force is None, "find_contacts reports forces, must report None")
