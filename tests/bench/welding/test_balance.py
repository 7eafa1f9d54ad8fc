"""The local test of equilibrium, against statics by hand: levers, slopes, and what a body carries."""

import math

import numpy as np
import pytest

from bench.welding.balance import Touches, residuals
from bench.welding.settings import MAX_RESIDUAL

LENGTH, WIDTH, THICKNESS = 0.117, 0.0234, 0.0078
SIZE = math.hypot(LENGTH, WIDTH) / 2
GRAVITY = np.array([0.0, 0.0, -9.81])
EXACT = 1e-3
"""Tolerance of a share: the ridge of the method changes shares by 1e-4."""


def face(low: float, high: float, z: float) -> list[tuple[float, float, float]]:
    """Return the corners of a contact area from x = low to x = high, across a plank."""
    return [(x, y, z) for x in (low, high) for y in (-WIDTH / 2, WIDTH / 2)]


def lacking_of(
    centers, areas, *, carried: bool, mass=None, friction: float = 0.45, normal=(0.0, 0.0, 1.0)
) -> np.ndarray:
    """Return the residuals of planks with contact ``areas``: (lower, upper, corners), -1 for the ground."""
    rows = [(a, b, corner) for a, b, corners in areas for corner in corners]
    touches = Touches(
        np.array([a for a, _, _ in rows]),
        np.array([b for _, b, _ in rows]),
        np.array([corner for _, _, corner in rows], np.float64),
        np.tile(np.array(normal, np.float64), (len(rows), 1)),
        np.full(len(rows), friction),
        np.full(len(rows), abs(normal[2]) >= 1.0 / math.hypot(1.0, friction)),
    )
    count = len(centers)
    return residuals(
        np.array(centers, np.float64),
        np.full(count, SIZE),
        np.ones(count) if mass is None else np.array(mass, np.float64),
        GRAVITY,
        touches,
        carried,
    )


@pytest.mark.parametrize("carried", [True, False])
def test_a_plank_on_the_ground_lacks_nothing(carried) -> None:
    flat = face(-LENGTH / 2, LENGTH / 2, 0.0)
    assert lacking_of([(0.0, 0.0, THICKNESS / 2)], [(-1, 0, flat)], carried=carried)[0] < EXACT


@pytest.mark.parametrize("beyond", [0.002, 0.01])
def test_a_plank_beyond_its_edge_lacks_the_moment_about_the_edge(beyond) -> None:
    """The residual is the least force and moment together: a moment m g d / (m g size), to second order."""
    half = face(-LENGTH / 2, -beyond, 0.0)
    lacking = lacking_of([(0.0, 0.0, THICKNESS / 2)], [(-1, 0, half)], carried=True)[0]
    share = beyond / SIZE
    assert lacking == pytest.approx(share, rel=0.02)
    assert lacking > MAX_RESIDUAL


@pytest.mark.parametrize(("degrees", "holds"), [(20.0, True), (28.0, False)])
def test_friction_holds_up_to_its_angle(degrees, holds) -> None:
    """With mu = 0.45 a slope holds up to 24.2 deg, and the pyramid of 8 edges up to 22.5 deg along any direction."""
    lean = math.radians(degrees)
    normal = (math.sin(lean), 0.0, math.cos(lean))
    along = np.array([math.cos(lean), 0.0, -math.sin(lean)])
    corners = [tuple(x * along + (0.0, y, 0.0)) for x in (-0.05, 0.05) for y in (-0.01, 0.01)]
    center = THICKNESS / 2 * np.array(normal)
    lacking = lacking_of([center], [(-1, 0, corners)], carried=True, normal=normal)[0]
    assert (lacking <= MAX_RESIDUAL) == holds


def leaning_tower(levels: int, shift: float):
    """Return centres and areas of planks that each stand ``shift`` beyond the plank below."""
    centers = [(shift * level, 0.0, (level + 0.5) * THICKNESS) for level in range(levels)]
    areas = [(-1, 0, face(-LENGTH / 2, LENGTH / 2, 0.0))]
    areas += [
        (level - 1, level, face(shift * level - LENGTH / 2, shift * (level - 1) + LENGTH / 2, level * THICKNESS))
        for level in range(1, levels)
    ]
    return centers, areas


def test_only_a_carried_load_shows_that_a_tower_is_beyond_its_balance() -> None:
    """n planks on a plank, each shifted by d, fall once (n + 1) d / 2 > L / 2: here at n = 8, so with nine planks."""
    shift = LENGTH / 8.5
    stands, falls = leaning_tower(8, shift), leaning_tower(9, shift)
    assert lacking_of(*stands, carried=True).max() < EXACT
    lacking = lacking_of(*falls, carried=True)
    assert lacking[1] > MAX_RESIDUAL, "the second plank bears all above it on the first"
    assert lacking[3:].max() < EXACT
    assert lacking_of(*falls, carried=False).max() < EXACT, "each plank's own weight lies above the next plank"


@pytest.mark.parametrize(("counterweight", "holds"), [(3.0, True), (0.5, False)])
def test_a_counterweight_holds_an_overhanging_plank(counterweight, holds) -> None:
    """A beam on an edge at its middle, with a load of mass 1 at its free end and a counterweight at the other."""
    beam = (0.0, 0.0, THICKNESS / 2)
    load, weight = (0.04, 0.0, 1.5 * THICKNESS), (-0.04, 0.0, 1.5 * THICKNESS)
    areas = [
        (-1, 0, face(-LENGTH / 2, 0.0, 0.0)),
        (0, 1, face(0.03, 0.05, THICKNESS)),
        (0, 2, face(-0.05, -0.03, THICKNESS)),
    ]
    lacking = lacking_of([beam, load, weight], areas, carried=True, mass=[0.1, 1.0, counterweight])
    assert (lacking[0] <= MAX_RESIDUAL) == holds
    assert lacking[1:].max() < EXACT


def test_a_body_without_contacts_lacks_its_whole_weight() -> None:
    assert lacking_of([(0.0, 0.0, 1.0)], [(-1, -1, face(0.0, 1.0, 0.0))], carried=True)[0] == pytest.approx(1.0)
