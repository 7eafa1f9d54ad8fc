"""What makes a contact load-bearing, an impact, or slip: the small questions of the contact filter."""

import math

import numpy as np
import pytest

from stability_core import GROUND, Settings
from stability_core.contact_filter import bit_of, is_impact, is_level, speeds_of, upper_of

G = 9.81
LIMITS = Settings().limits(G)[0]
TILT = math.radians(2)
SIZE, DT = 0.06, 1 / 60


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.45, 1.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_contact_bears_load_if_its_cone_holds_the_vertical(friction, side):
    limit = max(math.atan(friction), TILT)
    assert is_level(side * math.cos(limit - 1e-6), friction, TILT)
    assert not is_level(side * math.cos(limit + 1e-6), friction, TILT)


@pytest.mark.parametrize(("upward", "upper"), [(1.0, 7), (0.02, 7), (-0.02, 3), (-1.0, 3)])
def test_the_upper_body_is_the_one_that_the_normal_pushes_up(upward, upper):
    assert upper_of(3, 7, upward) == upper


def test_a_velocity_has_an_approach_and_a_sliding_part():
    generator = np.random.default_rng(1)
    for _ in range(100):
        velocity, normal = generator.normal(size=(2, 3))
        normal /= np.linalg.norm(normal)
        approach, slip = speeds_of(velocity, normal)
        assert approach == pytest.approx(-velocity @ normal)
        assert slip == pytest.approx(np.linalg.norm(np.cross(normal, velocity)))


def test_an_unknown_velocity_is_no_impact_and_no_slip():
    approach, slip = speeds_of(np.full(3, np.nan), np.array([0.0, 0.0, 1.0]))
    assert math.isnan(approach)
    assert slip == 0.0
    assert not is_impact(approach, SIZE, LIMITS, DT)


def test_an_impact_is_faster_than_bricks_are_laid():
    """The limit grows with the root of gravity times size, and is never below what gravity adds in some frames."""
    by_size = float(LIMITS["impact_speed"]) * math.sqrt(G * SIZE)
    by_frames = float(LIMITS["impact_frames"]) * G * DT
    limit = max(by_size, by_frames)
    assert not is_impact(limit * (1 - 1e-9), SIZE, LIMITS, DT)
    assert is_impact(limit * (1 + 1e-9), SIZE, LIMITS, DT)
    large = 100.0 * SIZE
    assert not is_impact(limit * 1.5, large, LIMITS, DT)


def test_neighbouring_bodies_and_the_ground_have_bits_of_their_own():
    bits = {int(bit_of(body)) for body in range(GROUND, 63)}
    assert len(bits) == 64
    assert all(bit.bit_count() == 1 for bit in bits)
    assert bit_of(5) == bit_of(5 + 64)
