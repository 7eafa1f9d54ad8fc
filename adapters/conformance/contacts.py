"""Checks of the port's reports: contact points, normals, separations, velocities, masses."""

from __future__ import annotations

import math

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import (
    GRAVITY,
    LENGTH,
    MASS,
    THICKNESS,
    WIDTH,
    Rig,
    advance,
    approach_speed,
    frames,
    frozen_column,
    pairs,
    place_on,
    plank,
    pose,
    require,
    require_between,
    touching,
)
from scenarios.model import Brick
from stability_core.port import GROUND, Contacts


def _require_well_formed(simulation: Simulation, contacts: Contacts) -> None:
    """Raise ``ConformanceError`` unless contacts have arrays of the right shapes, and known ids.

    Points, normals and friction must be finite, normals must have unit length, and a live body must be in each contact.
    """
    n = len(contacts)
    for name, shape in {
        "body_b": (n,),
        "point": (n, 3),
        "normal": (n, 3),
        "separation": (n,),
        "friction": (n,),
    }.items():
        require(
            getattr(contacts, name).shape == shape,
            f"Contacts.{name} has the shape {getattr(contacts, name).shape}, must be {shape}",
        )
    live = set(simulation.bricks) - simulation.frozen
    dead = [pair for pair in pairs(contacts) if not live & set(pair)]
    require(not dead, f"contacts of the pairs {dead} touch no live body, every contact must touch a live body")
    unknown = [pair for pair in pairs(contacts) if not set(pair) <= {GROUND, *simulation.bricks}]
    require(
        not unknown, f"contacts of the pairs {unknown} name bodies that are not in the world, must name bodies in it"
    )
    finite = all(np.isfinite(values).all() for values in (contacts.point, contacts.normal, contacts.friction))
    require(finite, "contacts have NaN or inf among points, normals and friction, must have finite numbers")
    length_error = np.abs(np.linalg.norm(contacts.normal, axis=1) - 1).max(initial=0.0)
    require_between(0.0, length_error, 1e-6, "error of the length of normals (tolerance: rounding in single precision)")


def reports_a_resting_brick(rig: Rig) -> None:
    """Check that the contact points of a brick at rest lie on its lower face, and span most of this face.

    The brick must touch its support only. Normals must point from a to b.
    """
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1)
    grounded, stacked = place_on(simulation, 0, x=0.3), place_on(simulation, 1)
    advance(simulation, 1.0)
    contacts = simulation.port.contacts()
    _require_well_formed(simulation, contacts)
    for body, below in ((grounded, GROUND), (stacked, support)):
        mine = touching(contacts, body)
        expected = {(min(below, body), max(below, body))}
        require(pairs(mine) == expected, f"a brick on {below} touches {pairs(mine)}, must be {expected}")
        upward = np.where(mine.body_b == body, mine.normal[:, 2], -mine.normal[:, 2])
        require_between(0.99, upward.min(), 1.0 + 1e-6, "upward component of the normal to the upper brick")
        x, y, z, *_ = pose(simulation, body)
        along, across = mine.point[:, 0] - x, mine.point[:, 1] - y
        for name, offsets, half in (("x", along, LENGTH / 2), ("y", across, WIDTH / 2)):
            # The points must span most of the face, so that the centre is well inside, and lie within its edges.
            require_between(
                -half - 1e-4, offsets.min(), -0.8 * half, f"least {name} [m] of the points relative to the centre"
            )
            require_between(
                0.8 * half, offsets.max(), half + 1e-4, f"greatest {name} [m] of the points relative to the centre"
            )
        off_face = np.abs(mine.point[:, 2] - (z - THICKNESS / 2)).max()
        require_between(0.0, off_face, 0.5e-3, "distance [m] of the points from the lower face")
        require(
            bool((mine.friction == 0.45).all()),
            f"contacts of the pair have the friction {mine.friction}, must have 0.45",
        )


def reports_a_resting_brick_in_every_frame(rig: Rig) -> None:
    """Check that a brick at rest has a contact with its support in every frame, at a relative velocity of about 0."""
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 0.7)
    for frame in range(frames(simulation, 1.0)):
        simulation.step(simulation.info.frame_s)
        contacts = simulation.port.contacts()
        require((support, body) in pairs(contacts), f"frame {frame}: a brick at rest must touch its support")
        speed = np.linalg.norm(contacts.relative_velocity, axis=1).max()
        # Velocities that include the gravity of a step would be g dt = 160 mm/s.
        require_between(0.0, speed, 1e-2, "relative velocity [m/s] reported for a brick at rest")


def reports_whole_faces_on_uneven_supports(rig: Rig) -> None:
    """Check that a brick on two supports, 0.08 mm apart in height, shows both whole contact areas within six frames.

    Each contact area must be complete in the union of the points of these frames.

    A brick tilted by micrometres penetrates at some corners only. Under load all other corners would bear force too.
    """
    simulation = rig.open()
    step = 0.08e-3
    middle = LENGTH / 2 + 1e-3
    supports = [simulation.spawn(plank(-middle)), simulation.spawn(plank(middle, THICKNESS / 2 - step))]
    simulation.port.sleep(supports)
    body = simulation.spawn(plank(0.0, 1.5 * THICKNESS + 0.1e-3))
    advance(simulation, 1.0)
    seen: list[Contacts] = []
    for _ in range(6):
        simulation.step(simulation.info.frame_s)
        seen.append(touching(simulation.port.contacts(), body))
    for support, side in zip(supports, (-1.0, 1.0), strict=True):
        along = np.concatenate([side * one.point[(one.body_a == support) | (one.body_b == support), 0] for one in seen])
        covered = float(np.ptp(along)) if len(along) else 0.0
        overlap = LENGTH / 2 - 1e-3
        require_between(
            0.9 * overlap, covered, overlap + 0.2e-3, f"length [m] of the contact area reported on support {support}"
        )


def reports_a_support_a_hair_below(rig: Rig) -> None:
    """Check that a beam on two bricks also has a contact with a third brick that lies between both, 0.05 mm lower.

    The third contact matters, because under load all three bricks would bear the beam.
    """
    simulation = rig.open()
    outer, hair = LENGTH + 2e-3, 0.05e-3
    supports = [simulation.spawn(plank(x)) for x in (-outer, outer)]
    middle = simulation.spawn(plank(0.0, THICKNESS / 2 - hair))
    simulation.port.sleep([*supports, middle])
    size = (3 * LENGTH, WIDTH, THICKNESS)
    beam = simulation.spawn(Brick(size, 3 * MASS, (0.0, 0.0, 1.5 * THICKNESS)))  # no drop onto the third brick
    advance(simulation, 1.0)
    seen = set()
    for _ in range(6):
        simulation.step(simulation.info.frame_s)
        contacts = simulation.port.contacts()
        _require_well_formed(simulation, contacts)
        seen |= pairs(contacts)
    expected = {(support, beam) for support in (*supports, middle)}
    require(seen == expected, f"a beam over {supports} and {middle}, 0.05 mm lower, touches {seen}, must be {expected}")


def reports_every_pair(rig: Rig) -> None:
    """Check that the port reports the pairs of live bricks on the ground, on a live brick and on two frozen bricks.

    After a freeze the port must report pairs with a live brick only.
    """
    simulation = rig.open()
    left, right = frozen_column(simulation, 1, xs=(-LENGTH / 2 - 1e-3, LENGTH / 2 + 1e-3))
    bridge = place_on(simulation, 1)
    advance(simulation, 0.5)
    rider = place_on(simulation, 2)
    grounded = place_on(simulation, 0, x=0.4)
    advance(simulation, 1.0)
    expected = {(left, bridge), (right, bridge), (bridge, rider), (GROUND, grounded)}
    contacts = simulation.port.contacts()
    _require_well_formed(simulation, contacts)
    require(pairs(contacts) == expected, f"pairs are {sorted(pairs(contacts))}, must be {sorted(expected)}")
    simulation.port.sleep([bridge, grounded])
    for _ in range(3):
        simulation.step(simulation.info.frame_s)
        contacts = simulation.port.contacts()
        _require_well_formed(simulation, contacts)
        require(
            pairs(contacts) == {(bridge, rider)},
            f"pairs {pairs(contacts)} after a freeze, must be {(bridge, rider)} only",
        )


def reports_the_speed_of_impact(rig: Rig) -> None:
    """Check that the first contact after a fall from height h reports the approach speed sqrt(2 g h).

    This is the speed before the solver acts.
    """
    for levels, height in ((0, 0.05), (1, 0.02)):
        simulation = rig.open()
        frozen_column(simulation, levels)
        body = simulation.spawn(plank(z=(levels + 0.5) * THICKNESS + height))
        for _ in range(frames(simulation, 0.5)):
            simulation.step(simulation.info.frame_s)
            contacts = touching(simulation.port.contacts(), body)
            if len(contacts):
                break
        expected, within = math.sqrt(2 * GRAVITY * height), GRAVITY * simulation.info.frame_s
        speed = approach_speed(contacts)
        # The port reports the speed before the step, and a semi-implicit fall is slower by half of a step's gain.
        require_between(
            expected - 1.5 * within, speed, expected + within, f"approach speed [m/s] after a fall of {height} m"
        )


def reports_the_overlap(rig: Rig) -> None:
    """Check that the port reports the depth of a brick spawned 1 mm deep in the ground, as a negative separation.

    The port may report the depth before the step, or the depth that remains after the step.
    """
    simulation = rig.open()
    body = simulation.spawn(plank(z=THICKNESS / 2 - 1e-3))
    simulation.step(simulation.info.frame_s)
    separation = touching(simulation.port.contacts(), body).separation
    left = pose(simulation, body)[2] - THICKNESS / 2
    # The depth may belong to the time before or after the step; gravity may have pushed the brick a little deeper.
    require_between(
        -1.5e-3,
        min(separation, default=math.inf),
        max(-0.4e-3, left + 1e-4),
        "separation [m] of a brick 1 mm deep in the ground",
    )


def forgets_a_removed_brick(rig: Rig) -> None:
    """Check that a removed brick has no contacts, even before the next step, and that all other contacts remain."""
    simulation = rig.open()
    lower, aside = place_on(simulation, 0), place_on(simulation, 0, x=0.4)
    advance(simulation, 0.5)
    upper = place_on(simulation, 1)
    advance(simulation, 0.5)
    simulation.remove(upper)
    contacts = simulation.port.contacts()
    _require_well_formed(simulation, contacts)
    expected = {(GROUND, lower), (GROUND, aside)}
    require(pairs(contacts) == expected, f"pairs {sorted(pairs(contacts))} after a removal, must be {sorted(expected)}")


def reports_masses(rig: Rig) -> None:
    """Check that ``port.masses`` lists each live body with its mass and centre, and each removed id exactly once."""
    simulation = rig.open()
    bodies = [simulation.spawn(plank(x)) for x in (0.0, 0.2, 0.4)]
    advance(simulation, 0.1)
    simulation.port.sleep(bodies[:1])
    simulation.remove(bodies[1])
    masses = simulation.port.masses()
    require(list(masses.removed) == [bodies[1]], f"masses list {masses.removed} as removed, must be [{bodies[1]}]")
    require(bodies[2] in masses.body, f"masses list the bodies {masses.body}, must include the live body {bodies[2]}")
    require(bodies[1] not in masses.body, f"masses list {masses.body}, must not include the removed body {bodies[1]}")
    require(bool((masses.mass == MASS).all()), f"masses are {masses.mass} kg, must be {MASS} kg")
    centre = masses.center_of_mass[masses.body.tolist().index(bodies[2])]
    require(
        bool((centre == pose(simulation, bodies[2])[:3]).all()),
        f"the centre of mass is {centre} m, must be the body's position {pose(simulation, bodies[2])[:3]} m",
    )
    require(
        not list(simulation.port.masses().removed), "masses list a removed body as removed twice, must list it once"
    )


def reports_the_normal_at_a_ridge(rig: Rig) -> None:
    """Check that the normal at the ridge of two planks that lean at 72 deg is as ``ridge_normal`` states, within 3 deg.

    The normal is the normal of a face, or the horizontal direction.
    """
    simulation = rig.open()
    lean = math.radians(72)
    half_height = (LENGTH * math.sin(lean) + THICKNESS * math.cos(lean)) / 2
    aside = (LENGTH * math.cos(lean) + THICKNESS * math.sin(lean)) / 2 + 0.1e-3  # flush faces would have no ridge
    left, right = (
        simulation.spawn(plank(-aside, half_height, lean)),
        simulation.spawn(plank(aside, half_height, math.pi - lean)),
    )
    advance(simulation, 0.1)
    contacts = simulation.port.contacts()
    ridge = contacts.chosen(
        (np.minimum(contacts.body_a, contacts.body_b) == left) & (np.maximum(contacts.body_a, contacts.body_b) == right)
    )
    require(len(ridge) > 0, "the planks of a V have no contact at the ridge after 0.1 s, must have one or more")
    from_horizontal = np.degrees(np.arctan2(np.abs(ridge.normal[:, 2]), np.abs(ridge.normal[:, 0])))
    ideal = {"face": 90.0 - 72.0, "edge": 0.0}[rig.capabilities.ridge_normal]
    error = float(np.abs(from_horizontal - ideal).max())
    # 3 deg: the V turns by some tenths of a degree, and by 2 deg if it slips, as with a friction pyramid.
    require_between(0.0, error, 3.0, f"error [deg] of the normal at a ridge, {ideal:g} deg from the horizontal")
