"""Exact statics against closed forms, and its proofs against what they claim."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stability_core import GROUND, solve_equilibrium
from stability_core.equilibrium.cone import project
from stability_core.equilibrium.problem import Problem, imbalance, relieved_of

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
WIDE = (-LENGTH / 2, LENGTH / 2)
DEEP = (-DEPTH / 2, DEPTH / 2)
G = 9.81


def verdict(port, gravity=(0.0, 0.0, -G)) -> str:
    return solve_equilibrium(port.contacts(), port.masses(), gravity).verdict


def column(port, offsets, friction: float = 0.45) -> None:
    """Planks on each other, each with its centre at one of the ``offsets`` along x."""
    for body, x in enumerate(offsets):
        port.add(body, (x, 0.0, (body + 0.5) * THICKNESS), 0.0119)
        low, high = x - LENGTH / 2, x + LENGTH / 2
        if body:
            low, high = max(low, offsets[body - 1] - LENGTH / 2), min(high, offsets[body - 1] + LENGTH / 2)
        port.lay(body, body - 1 if body else GROUND, (low, high), DEEP, body * THICKNESS, friction=friction)


def lean(port, body: int, foot: float, side: float, theta: float, friction: float) -> None:
    """A plank that stands on its lower edge at x = ``foot`` on the ground and leans to one ``side``."""
    along, across = np.array([side * np.cos(theta), np.sin(theta)]), np.array([-side * np.sin(theta), np.cos(theta)])
    x, z = np.array([foot, 0.0]) + along * LENGTH / 2 + across * THICKNESS / 2
    port.add(body, (x, 0.0, z), 0.0119)
    port.touch(body, GROUND, [(foot, y, 0.0) for y in DEEP], friction=friction)


def inverted_v(port, theta: float, friction: float) -> None:
    spread, ridge = LENGTH * np.cos(theta), LENGTH * np.sin(theta)
    lean(port, 0, -spread, 1.0, theta, friction)
    lean(port, 1, spread, -1.0, theta, friction)
    port.touch(1, 0, [(0.0, y, ridge) for y in DEEP], normal=(1.0, 0.0, 0.0), friction=friction)


def tilted(angle: float, azimuth: float = 0.0) -> tuple[float, float, float]:
    """Gravity on a slope of ``angle`` that falls towards ``azimuth``."""
    sine = np.sin(angle)
    return (G * sine * np.cos(azimuth), G * sine * np.sin(azimuth), -G * np.cos(angle))


@pytest.mark.parametrize("azimuth", [0.0, 0.7, np.pi / 4, 2.0])
@pytest.mark.parametrize("friction", [0.1, 0.45, 0.8])
def test_a_block_slides_down_an_incline_iff_tan_theta_exceeds_mu(port, friction, azimuth):
    """In every direction alike: the cone is round."""
    column(port, [0.0], friction)
    assert verdict(port, tilted(np.arctan(friction * (1 - 1e-6)), azimuth)) == "stable"
    assert verdict(port, tilted(np.arctan(friction * (1 + 1e-5)), azimuth)) == "unstable"


@pytest.mark.parametrize(("ratio", "falls"), [(8.5, 9), (8.01, 9), (7.99, 8), (4.5, 5)])
def test_a_leaning_tower_falls_at_the_first_n_with_n_d_over_the_length(port, ratio, falls):
    column(port, [body * LENGTH / ratio for body in range(falls - 1)])
    assert verdict(port) == "stable"
    port.touches.clear()
    column(port, [body * LENGTH / ratio for body in range(falls)])
    assert verdict(port) == "unstable"


@pytest.mark.parametrize("blocks", [6, 30, 100])
def test_the_harmonic_overhang_is_the_limit(port, blocks):
    """The top k blocks have their centre L/2 sum 1/k from the edge: decided to a hundred-thousandth."""
    steps = LENGTH / 2 / np.arange(blocks - 1, 0, -1)
    offsets = np.concatenate([[0.0], np.cumsum(steps)])
    column(port, offsets * (1 - 1e-5))
    assert verdict(port) == "stable"
    port.touches.clear()
    column(port, offsets * (1 + 1e-5))
    assert verdict(port) == "unstable"


@pytest.mark.parametrize("theta", np.radians([50.0, 60.0, 72.0, 80.0]))
def test_an_inverted_v_needs_half_of_cot_theta_less_t_over_l(port, theta):
    least = (1 / np.tan(theta) - THICKNESS / LENGTH) / 2
    inverted_v(port, theta, least * (1 + 1e-5))
    assert verdict(port) == "stable"
    port.touches.clear()
    inverted_v(port, theta, least * (1 - 1e-5))
    assert verdict(port) == "unstable"


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_a_ladder_on_a_rough_wall_slips_below_its_angle(port, friction):
    """A thin plank between ground and wall, equally rough: tan(theta) = (1 - mu^2) / (2 mu)."""
    limit = np.arctan((1 - friction**2) / (2 * friction))
    for theta, expected in ((limit + 1e-5, "stable"), (limit - 1e-5, "unstable")):
        port.touches.clear()
        x, z = LENGTH * np.cos(theta), LENGTH * np.sin(theta)
        port.add(0, (x / 2, 0.0, z / 2))
        port.touch(0, GROUND, [(0.0, y, 0.0) for y in DEEP], friction=friction)
        port.touch(0, GROUND, [(x, y, z) for y in DEEP], normal=(-1.0, 0.0, 0.0), friction=friction)
        assert verdict(port) == expected


def test_a_cantilever_stands_on_its_counterweight(port):
    """Moments about the edge of the support at x = 0: the plank's weight at 20 mm, the weight at -30 mm."""
    for mass, expected in ((0.0119 * 2 / 3 * (1 + 1e-5), "stable"), (0.0119 * 2 / 3 * (1 - 1e-5), "unstable")):
        port.touches.clear()
        port.add(0, (0.02, 0.0, 0.0), 0.0119)
        port.lay(0, GROUND, (-0.0385, 0.0), DEEP, 0.0)
        port.add(1, (-0.03, 0.0, 0.01), mass)
        port.touch(1, 0, [(-0.03, 0.0, 0.005)])
        assert verdict(port) == expected


def test_two_hundred_and_fifty_levels_are_no_harder_than_one(port):
    """Tolerances scale with the force on a body: else the foot of a high tower would seem out of balance."""
    column(port, [0.0] * 250)
    found = solve_equilibrium(port.contacts(), port.masses())
    assert found.stable
    assert found.residual < 1e-9


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_units_do_not_matter(port, factor):
    """Planks of 8 um, 8 mm and 8 m; grams and tons; on the moon."""
    for ratio, expected in ((8.01, "stable"), (7.99, "unstable")):
        port.touches.clear()
        column(port, [body * LENGTH / ratio for body in range(8)])
        contacts, masses = port.contacts(), port.masses()
        contacts = dataclasses.replace(contacts, point=contacts.point * factor)
        masses = dataclasses.replace(
            masses, mass=masses.mass / factor**2, center_of_mass=masses.center_of_mass * factor
        )
        assert solve_equilibrium(contacts, masses, (0.0, 0.0, -1.62)).verdict == expected


def test_forces_prove_that_it_stands(port):
    """Recomputed from the contacts alone: no net force, no net moment, and every force in its cone."""
    inverted_v(port, np.radians(70.0), 0.3)
    contacts, masses = port.contacts(), port.masses()
    force = solve_equilibrium(contacts, masses).forces
    assert force is not None
    for body, mass, center in zip(masses.body, masses.mass, masses.center_of_mass, strict=True):
        sign = (contacts.body_b == body).astype(float) - (contacts.body_a == body)
        assert (sign @ force) + mass * np.array([0.0, 0.0, -G]) == pytest.approx(np.zeros(3), abs=1e-9)
        moment = np.cross(contacts.point - center, force)
        assert sign @ moment == pytest.approx(np.zeros(3), abs=1e-10)
    along = (force * contacts.normal).sum(axis=1)
    across = np.linalg.norm(force - along[:, None] * contacts.normal, axis=1)
    assert (across <= contacts.friction * along + 1e-12).all()


def test_a_mechanism_proves_that_it_falls(port):
    """Recomputed from the contacts alone: gravity does work, and no contact is pressed or rubs enough to resist."""
    column(port, [body * LENGTH / 8.5 for body in range(9)])
    contacts, masses = port.contacts(), port.masses()
    motion = solve_equilibrium(contacts, masses).mechanism
    assert motion is not None
    linear, turning = np.vstack([motion, np.zeros(6)]).reshape(-1, 2, 3).swapaxes(0, 1)  # GROUND is the last row
    center = np.vstack([masses.center_of_mass, np.zeros(3)])
    work = (masses.mass * -G) @ motion[:, 2]
    assert work > 0.0
    at_a, at_b = (
        linear[body] + np.cross(turning[body], contacts.point - center[body])
        for body in (contacts.body_a, contacts.body_b)
    )
    parting = ((at_b - at_a) * contacts.normal).sum(axis=1)
    sliding = np.linalg.norm(at_b - at_a - parting[:, None] * contacts.normal, axis=1)
    assert (parting >= contacts.friction * sliding - 1e-4 * np.abs(motion).max()).all()
    assert np.abs(motion[0]).max() < 1e-3 * np.abs(motion).max(), "the lowest plank stays"


def test_what_touches_nothing_falls_straight_down(port):
    column(port, [0.0])
    port.add(7, (1.0, 0.0, 0.5))
    found = solve_equilibrium(port.contacts(), port.masses())
    assert found.verdict == "unstable"
    assert found.mechanism[1] == pytest.approx([0, 0, -1, 0, 0, 0], abs=1e-6)
    assert found.mechanism[0] == pytest.approx(np.zeros(6), abs=1e-6)


def test_a_brick_between_walls_is_a_doubt(port):
    """Friction could hold it if something pressed the walls together; nothing does."""
    port.add(0, (0.0, 0.0, 0.5))
    for side in (-1.0, 1.0):
        corners = [(side * 0.05, y, 0.5 + z) for y in DEEP for z in DEEP]
        port.touch(0, GROUND, corners, normal=(-side, 0.0, 0.0), friction=0.5)
    assert verdict(port) == "doubt"


def test_a_brick_in_a_groove_needs_no_friction(port):
    port.add(0, (0.0, 0.0, 0.02))
    for side in (-1.0, 1.0):
        port.touch(0, GROUND, [(side * 0.02, y, 0.0) for y in DEEP], normal=(-side / 2**0.5, 0, 0.5**0.5), friction=0.0)
    assert verdict(port) == "stable"


@pytest.mark.parametrize("friction", [0.0, 0.45])
def test_no_contact_pulls(friction):
    """Least of all along its own normal, where without friction rounding alone separates push from pull."""
    force = np.empty((1, 3))
    project(np.array([[0.0, 0.0, -2.0]]), np.array([[0.0, 0.0, 1.0]]), np.array([friction]), force)
    assert (force == 0.0).all()


def test_bodies_that_are_taken_away_leave_behind_what_they_pressed():
    """Under any forces each other body lacks as much as before: the contacts with what is gone became loads."""
    random = np.random.default_rng(0)
    n, m = 5, 40
    body_b = random.integers(0, n, m)
    body_a = (body_b + random.integers(1, n, m)) % n
    body_a[::5] = -1
    lever_a, lever_b, normal, force = random.normal(size=(4, m, 3))
    friction, load = random.random(m), random.normal(size=(n, 6))
    problem = Problem(body_a, body_b, lever_a, lever_b, normal, friction, load, np.zeros(n))
    gone = np.array([False, True, False, False, True])
    fewer, kept = relieved_of(problem, gone, force)
    before, after = np.empty((n, 6)), np.empty((3, 6))
    imbalance(problem, force, before)
    imbalance(fewer, force[kept], after)
    assert after == pytest.approx(before[~gone], abs=1e-12)
    assert set(fewer.body_a) == {-1, 0, 1, 2}


def test_nothing_is_stable(port):
    found = solve_equilibrium(port.contacts(), port.masses())
    assert found.stable
    assert found.forces.shape == (0, 3)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("point", np.nan, "contact 2 .* finite point"),
        ("normal", 0.0, "contact 2 .* unit normal"),
        ("friction", -0.1, "contact 2 .* friction of at least 0"),
        ("body_b", 5, "contact 2 .* never listed"),
        ("mass", -1.0, "masses row 0: .* positive mass"),
        ("mass", np.nan, "masses row 0: .* positive mass"),
        ("center_of_mass", np.inf, "masses row 0: .* finite centre"),
    ],
)
def test_bad_input_is_named(port, field, value, message):
    column(port, [0.0])
    contacts, masses = port.contacts(), port.masses()
    table = masses if hasattr(masses, field) else contacts
    getattr(table, field)[0 if table is masses else 2] = value
    with pytest.raises(ValueError, match=message):
        solve_equilibrium(contacts, masses)


def test_a_body_listed_twice_is_refused(port):
    column(port, [0.0, 0.0])
    masses = port.masses()
    masses.body[1] = 0
    with pytest.raises(ValueError, match="masses row 1: body 0 must have one row, but is listed twice"):
        solve_equilibrium(port.contacts(), masses)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, np.nan, -9.81), (0.0, -9.81)])
def test_bad_gravity_is_refused(port, gravity):
    column(port, [0.0])
    with pytest.raises(ValueError, match="gravity"):
        solve_equilibrium(port.contacts(), port.masses(), gravity)
