"""Checks of ``find_contacts``: contacts at the present poses, before a step, without a change of the simulation."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from adapters.base import Simulation
from adapters.conformance.rig import (
    LENGTH,
    MASS,
    THICKNESS,
    WIDTH,
    Rig,
    advance,
    frozen_column,
    pairs,
    plank,
    pose,
    require,
    require_between,
)
from scenarios.model import Brick, Vector
from stability_core.port import GROUND, Contacts, FloatArray

NEAR_ENOUGH = 0.1e-3
"""Greatest error [m] of a separation, for example at a gap of exactly zero."""
CORNER = 1e-3
"""Greatest distance [m] of a corner from the nearest point found, and of a point from the contact area."""
SAME_DIRECTION = math.radians(1.0)
"""Greatest angle [rad] between a normal and the ideal normal."""
SAME_PLACE = 0.1e-3
"""Greatest distance [m] between a brick's positions in two towers, with and without calls of ``find_contacts``."""
TOP = 0.02
"""Offset along x [m] of the third brick of the tower."""

UP: Vector = (0.0, 0.0, 1.0)


def _found(simulation: Simulation) -> Contacts:
    """Return the contacts after ``find_contacts``.

    Raises:
        ConformanceError: if the call changes a bit of a pose or a velocity, or the live bodies.
    """
    before, masses = _state(simulation), simulation.port.masses()
    simulation.find_contacts()
    contacts, after = simulation.port.contacts(), _state(simulation)
    require(before.tobytes() == after.tobytes(), "find_contacts changed a pose or a velocity, must not change a bit")
    left = simulation.port.masses()
    same = np.array_equal(masses.body, left.body) and np.array_equal(masses.center_of_mass, left.center_of_mass)
    require(
        same and not left.removed,
        f"find_contacts changed the live bodies {masses.body} to {left.body}, must not change them",
    )
    return contacts


def _state(simulation: Simulation) -> FloatArray:
    """Return position [m], quaternion, velocity [m/s] and spin [rad/s] of all bodies, shape (n, 13)."""
    return np.hstack([*simulation.poses()[1:], *simulation.velocities()])


def _of_pair(contacts: Contacts, a: int, b: int) -> Contacts:
    """Return the contacts of a pair, with normals from ``a`` to ``b`` and velocities of ``b`` relative to ``a``."""
    rows = np.flatnonzero(
        ((contacts.body_a == a) & (contacts.body_b == b)) | ((contacts.body_a == b) & (contacts.body_b == a))
    )
    turn = np.where(contacts.body_a[rows] == a, 1.0, -1.0)[:, None]
    chosen = contacts.chosen(rows)
    return replace(chosen, normal=turn * chosen.normal, relative_velocity=turn * chosen.relative_velocity)


def _require_pairs(contacts: Contacts, expected: set[tuple[int, int]]) -> None:
    require(pairs(contacts) == expected, f"found the pairs {sorted(pairs(contacts))}, must be {sorted(expected)}")


def _require_normals(contacts: Contacts, normal: Vector, what: str) -> None:
    angle = np.arccos(np.clip(contacts.normal @ np.array(normal), -1.0, 1.0)).max(initial=0.0)
    require_between(0.0, angle, SAME_DIRECTION, f"angle [rad] between the ideal normal and the normals found {what}")


def _require_area(contacts: Contacts, low: Vector, high: Vector, what: str, gap: float = 0.0) -> None:
    """Require all corners of the contact area from ``low`` to ``high`` [m], at ``gap`` [m], and no point outside.

    The friction must be 0.45.
    """
    error = np.abs(contacts.separation - gap).max(initial=0.0)
    require_between(0.0, error, NEAR_ENOUGH, f"error [m] of the separation found {what}, must be {gap} m")
    for corner in {*itertools.product(*zip(low, high, strict=True))}:
        away = np.linalg.norm(contacts.point - np.array(corner), axis=1).min(initial=math.inf)
        require_between(0.0, away, CORNER, f"distance [m] of the nearest point found {what} from the corner {corner}")
    beyond = np.maximum(np.array(low) - contacts.point, contacts.point - np.array(high)).max(initial=0.0)
    require_between(0.0, beyond, CORNER, f"distance [m] by which a point found {what} lies beyond the contact area")
    require(bool((contacts.friction == 0.45).all()), f"friction {what} is {contacts.friction}, must be 0.45")


def _require_face(contacts: Contacts, x: tuple[float, float], z: float, what: str, gap: float = 0.0) -> None:
    """Require a whole horizontal contact area at height ``z`` [m], with normals that point up."""
    _require_area(contacts, (x[0], -WIDTH / 2, z), (x[1], WIDTH / 2, z), what, gap)
    _require_normals(contacts, UP, what)


def _require_velocity(contacts: Contacts, velocity: Vector, what: str) -> None:
    error = np.abs(contacts.relative_velocity - np.array(velocity)).max(initial=0.0)
    require_between(0.0, error, 1e-6, f"error [m/s] of the relative velocity found {what}, must be {velocity} m/s")


def _tower(simulation: Simulation) -> list[int]:
    """Spawn three flat planks with gaps of exactly zero, the third shifted by ``TOP``; return their ids."""
    return [simulation.spawn(plank(x, (level + 0.5) * THICKNESS)) for level, x in enumerate((0.0, 0.0, TOP))]


def finds_the_contacts_of_a_tower(rig: Rig) -> None:
    """Check that ``find_contacts`` finds the whole contact areas of a tower without gaps, before the first step."""
    simulation = rig.open()
    lower, middle, upper = _tower(simulation)
    contacts = _found(simulation)
    _require_pairs(contacts, {(GROUND, lower), (lower, middle), (middle, upper)})
    half = LENGTH / 2
    areas = ((GROUND, lower, -half), (lower, middle, -half), (middle, upper, TOP - half))
    for level, (below, above, start) in enumerate(areas):
        what = f"between {below} and {above} in a tower"
        _require_face(_of_pair(contacts, below, above), (start, half), level * THICKNESS, what)
    _require_velocity(contacts, (0.0, 0.0, 0.0), "in a tower at rest")


def finds_the_contacts_of_an_inverted_v(rig: Rig) -> None:
    """Check that ``find_contacts`` finds both feet and the ridge of two planks that lean at 72 deg, each as a line.

    The normal at the ridge may have any direction between the faces of the planks, because engines differ.
    """
    simulation = rig.open()
    lean = math.radians(72)
    height, reach = LENGTH * math.sin(lean), LENGTH * math.cos(lean)
    aside = (reach + THICKNESS * math.sin(lean)) / 2
    center = (height + THICKNESS * math.cos(lean)) / 2
    left, right = simulation.spawn(plank(-aside, center, lean)), simulation.spawn(plank(aside, center, math.pi - lean))
    contacts = _found(simulation)
    _require_pairs(contacts, {(GROUND, left), (GROUND, right), (left, right)})
    for body, foot in ((left, -reach), (right, reach)):
        _require_face(_of_pair(contacts, GROUND, body), (foot, foot), 0.0, f"at the foot of plank {body} of a V")
    ridge, half = _of_pair(contacts, left, right), WIDTH / 2
    _require_area(ridge, (0.0, -half, height), (0.0, half, height), "at the ridge of a V")
    out_of_plane = np.abs(ridge.normal[:, 1]).max()
    require_between(0.0, out_of_plane, math.sin(SAME_DIRECTION), "|y| of a normal at the ridge of a V")
    tilt = np.arctan2(np.abs(ridge.normal[:, 2]), ridge.normal[:, 0]).max()
    limit = math.pi / 2 - lean + SAME_DIRECTION
    require_between(0.0, tilt, limit, "angle [rad] from the horizontal of a normal at the ridge of a V")


def finds_an_overlap(rig: Rig) -> None:
    """Check that ``find_contacts`` finds the overlap of a brick spawned 1 mm deep in the ground or a frozen brick."""
    simulation, deep = rig.open(), 1e-3
    (support,) = frozen_column(simulation, 1, xs=(0.3,))
    lower, upper = simulation.spawn(plank(z=THICKNESS / 2 - deep)), simulation.spawn(plank(0.3, 1.5 * THICKNESS - deep))
    contacts = _found(simulation)
    _require_pairs(contacts, {(GROUND, lower), (support, upper)})
    for below, body, x, z in ((GROUND, lower, 0.0, 0.0), (support, upper, 0.3, THICKNESS)):
        mine, what = _of_pair(contacts, below, body), f"between {below} and {body}, which overlap"
        _require_face(mine, (x - LENGTH / 2, x + LENGTH / 2), z - deep / 2, what, -deep)
        _require_velocity(mine, (0.0, 0.0, 0.0), what)


def finds_contacts_among_moving_and_frozen_bricks(rig: Rig) -> None:
    """Check that a call during a simulation finds the present contacts with the present velocities.

    The world has a frozen brick, a second brick that the host moved onto the frozen brick, a sliding brick and a
    falling brick. A later freeze or removal must delete the contacts of its brick.
    """
    simulation = rig.open()
    (support,) = frozen_column(simulation, 1)
    moved, falling = simulation.spawn(plank(0.3)), simulation.spawn(plank(-0.6, 2.0, 0.4))
    advance(simulation, 0.3)
    simulation.move(moved, (TOP, 0.0, 1.5 * THICKNESS), (1.0, 0.0, 0.0, 0.0))
    sliding = simulation.spawn(plank(-0.3))
    simulation.push(sliding, (0.2 * MASS, 0.0, 0.0))
    contacts = _found(simulation)
    _require_pairs(contacts, {(support, moved), (GROUND, sliding)})
    on_frozen, on_ground = _of_pair(contacts, support, moved), _of_pair(contacts, GROUND, sliding)
    _require_face(on_frozen, (TOP - LENGTH / 2, LENGTH / 2), THICKNESS, "on a frozen brick")
    _require_face(on_ground, (-0.3 - LENGTH / 2, -0.3 + LENGTH / 2), 0.0, "under a sliding brick")
    _require_velocity(on_frozen, (0.0, 0.0, 0.0), "on a frozen brick")
    _require_velocity(on_ground, (0.2, 0.0, 0.0), "under a sliding brick")
    simulation.port.sleep([falling])
    simulation.remove(moved)
    _require_pairs(simulation.port.contacts(), {(GROUND, sliding)})


def finds_contacts_with_fixed_boxes(rig: Rig) -> None:
    """Check that ``find_contacts`` finds the whole contact areas of a brick with a fixed table and a fixed wall.

    These contacts name the ground.
    """
    top, edge = 0.1, LENGTH / 4
    table = Brick((LENGTH, 2 * WIDTH, top), 1.0, (edge - LENGTH / 2, 0.0, top / 2))
    wall = Brick((0.05, 2 * WIDTH, 2 * top), 1.0, (LENGTH / 2 + 0.025, 0.0, top))
    simulation = rig.open(fixed=(table, wall))
    body = simulation.spawn(plank(z=top + THICKNESS / 2))
    contacts = _found(simulation)
    _require_pairs(contacts, {(GROUND, body)})
    mine = _of_pair(contacts, GROUND, body)
    is_level = np.abs(mine.normal[:, 2]) > 0.5
    below, beside = mine.chosen(is_level), mine.chosen(~is_level)
    _require_face(below, (-LENGTH / 2, edge), top, "on a fixed table")
    half, end = WIDTH / 2, LENGTH / 2
    _require_area(beside, (end, -half, top), (end, half, top + THICKNESS), "at a fixed wall")
    _require_normals(beside, (-1.0, 0.0, 0.0), "at a fixed wall")


def forgets_found_contacts_with_the_next_step(rig: Rig) -> None:
    """Check that found contacts end with the next step: a brick pushed off the ground then has no contacts."""
    simulation = rig.open()
    body = simulation.spawn(plank())
    _require_pairs(_found(simulation), {(GROUND, body)})
    simulation.push(body, (0.0, 0.0, MASS))
    advance(simulation, 0.05)
    _require_pairs(simulation.port.contacts(), set())


def stands_as_if_never_asked(rig: Rig) -> None:
    """Check that calls of ``find_contacts``, before the first step and later, displace no brick of a tower.

    The tolerance is ``SAME_PLACE``.
    """
    ends = []
    for asked in (False, True):
        simulation = rig.open()
        bodies = _tower(simulation)
        for frame in range(60):
            if asked and frame in (0, 1, 30):
                _found(simulation)
            simulation.step(simulation.info.frame_s)
        ends.append(np.array([pose(simulation, body)[:3] for body in bodies]))
    apart = np.linalg.norm(ends[0] - ends[1], axis=1).max()
    require_between(0.0, apart, SAME_PLACE, "distance [m] of a brick from its position without find_contacts")
    # With soft contacts, as shipped, the third brick sinks by less than a thickness.
    require_between(1.5 * THICKNESS, ends[1][2, 2], 2.6 * THICKNESS, "height [m] of the third brick after 60 frames")
