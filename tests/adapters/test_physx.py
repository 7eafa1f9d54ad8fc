"""What is special to PhysX: contacts through bricks, the inertia of small ones, impacts seen before they happen."""

import numpy as np

from adapters import open_engine
from adapters.conformance.rig import (
    LENGTH,
    MASS,
    THICKNESS,
    WIDTH,
    advance,
    frozen_column,
    pairs,
    place_on,
    plank,
    touching,
)
from stability_core.port import GROUND


def test_a_brick_touches_nothing_through_another() -> None:
    simulation = open_engine("physx", "default")  # 10 mm of contact offset a shape, more than two planks
    lower, upper = place_on(simulation, 0), place_on(simulation, 1)
    advance(simulation, 1.0)
    assert pairs(simulation.port.contacts()) == {(GROUND, lower), (lower, upper)}
    simulation.close()


def test_a_plank_has_its_own_inertia_though_physx_would_not_give_it_so_little() -> None:
    simulation = open_engine("physx", "game")
    body = simulation.spawn(plank())
    inertia = MASS / 12 * np.array([WIDTH**2 + THICKNESS**2, LENGTH**2 + THICKNESS**2, LENGTH**2 + WIDTH**2])
    assert np.allclose(simulation._components[body].inertia, inertia, rtol=1e-6)
    simulation.close()


def test_an_impact_that_physx_foresees_is_reported_as_touch() -> None:
    """Its solver stops a brick at the surface that it nears; the point lay apart when the step began."""
    simulation = open_engine("physx", "default")
    (support,) = frozen_column(simulation, 1)
    body = simulation.spawn(plank(z=1.5 * THICKNESS + 0.02))
    simulation.port.masses()
    for _ in range(60):
        simulation.step(1 / 60)
        contacts = touching(simulation.port.contacts(), body)
        if len(contacts) > 1:  # one point is what the port lists ahead of every engine
            break
    assert pairs(contacts) == {(support, body)}
    assert contacts.separation.max() <= 0.0
    simulation.close()


def test_contacts_come_by_rising_ids_wherever_bricks_lie_in_memory() -> None:
    """SAPIEN lists pairs by address; forces of friction, found pair by pair, would differ between two runs."""
    worlds = [open_engine("physx", "game") for _ in range(3)]
    for simulation in worlds:
        port = simulation.port
        for number in range(20):
            simulation.spawn(plank(0.15 * number - 1.5))
        advance(simulation, 0.1)
        contacts = port.contacts()
        listed = list(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True))
        assert {b for _, b in listed} | {a for a, _ in listed} == {GROUND, *range(20)}
        assert listed == sorted(listed)
    for simulation in worlds:
        simulation.close()
