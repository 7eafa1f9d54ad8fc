"""The projection on a Coulomb cone against brute force, its derivative against differences."""

import numpy as np
import pytest

from stability_core.equilibrium.cone import add_derivative_along, derivative, project

FRICTIONS = (0.0, 0.1, 0.45, 1.0, 2.0)
STEP = 1e-6
"""Of central differences, for vectors of length one: their error is then about 1e-10."""


def vectors(seed, count):
    """Random vectors (count, 3) and unit normals (count, 3)."""
    generator = np.random.default_rng(seed)
    normal = generator.normal(size=(count, 3))
    return generator.normal(size=(count, 3)), normal / np.linalg.norm(normal, axis=1, keepdims=True)


def projected(z, normal, friction):
    force = np.full_like(z, np.nan)
    project(z, normal, np.broadcast_to(friction, len(z)).astype(float), force)
    return force


def parts(z, normal):
    """Components along the normal (m,) and lengths across it (m,)."""
    along = (z * normal).sum(axis=1)
    return along, np.linalg.norm(z - along[:, None] * normal, axis=1)


def rays(normal, friction):
    """Unit vectors of one cone's border and axis, shape (k, 3)."""
    side = np.linalg.qr(np.column_stack([normal, np.eye(3)]))[0][:, 1:]
    turn = np.linspace(0, 2 * np.pi, 721)
    border = normal + friction * (np.outer(np.cos(turn), side[:, 0]) + np.outer(np.sin(turn), side[:, 1]))
    return np.vstack([normal, border / np.linalg.norm(border, axis=1, keepdims=True)])


@pytest.mark.parametrize("friction", FRICTIONS)
def test_a_projection_lies_in_the_cone_and_repeats(friction):
    z, normal = vectors(1, 500)
    force = projected(z, normal, friction)
    along, across = parts(force, normal)
    assert (across <= friction * along + 1e-12).all()
    assert projected(force, normal, friction) == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize("friction", FRICTIONS)
def test_what_is_left_is_at_right_angles_and_in_the_polar_cone(friction):
    """Moreau: z = f + g with f in the cone, g in its polar, f . g = 0; together that is the nearest point."""
    z, normal = vectors(2, 500)
    force = projected(z, normal, friction)
    left = z - force
    along, across = parts(left, normal)
    assert (force * left).sum(axis=1) == pytest.approx(0, abs=1e-12)
    assert (friction * across <= -along + 1e-12).all()


@pytest.mark.parametrize("friction", FRICTIONS)
def test_no_point_of_the_cone_is_nearer(friction):
    z, normal = vectors(3, 40)
    force = projected(z, normal, friction)
    for k in range(len(z)):
        directions = rays(normal[k], friction)
        nearest = directions * np.maximum(0.0, directions @ z[k])[:, None]  # of each ray
        least = np.linalg.norm(nearest - z[k], axis=1).min()
        assert np.linalg.norm(force[k] - z[k]) <= least + 1e-12


def test_what_is_in_the_cone_stays_and_what_is_in_the_polar_vanishes():
    up = np.array([[0.0, 0.0, 1.0]] * 4)
    z = np.array([[0.4, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.3, -1.0], [0.0, 0.0, -2.0]])
    assert projected(z, up, 0.5).tolist() == [[0.4, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def test_without_friction_the_cone_is_the_ray_along_the_normal():
    z, normal = vectors(4, 200)
    along = np.maximum(0.0, (z * normal).sum(axis=1))
    assert projected(z, normal, 0.0) == pytest.approx(along[:, None] * normal, abs=1e-12)


def matrix(z, normal, friction):
    """The derivative at one z, shape (3, 3), from its terms, which must be unit vectors of weight 0 to 1."""
    direction, weight = np.full((3, 3), np.nan), np.full(3, np.nan)
    terms = derivative(z, normal, friction, direction, weight)
    u, w = direction[:terms], weight[:terms]
    assert np.linalg.norm(u, axis=1) == pytest.approx(1.0)
    assert ((w >= 0) & (w <= 1 + 1e-12)).all()
    return (u.T * w) @ u


def differences(z, normal, friction):
    steps = STEP * np.eye(3)
    there = projected(np.vstack([z + steps, z - steps]), np.tile(normal, (6, 1)), friction)
    return ((there[:3] - there[3:]) / (2 * STEP)).T


@pytest.mark.parametrize("friction", FRICTIONS)
def test_the_derivative_is_that_of_differences(friction):
    z, normal = vectors(5, 300)
    along, across = parts(z, normal)
    borders = np.minimum(abs(across - friction * along), abs(friction * across + along))
    smooth = borders > 100 * STEP  # at a border the projection has a kink
    assert smooth.sum() > 200
    for k in np.flatnonzero(smooth):
        assert matrix(z[k], normal[k], friction) == pytest.approx(differences(z[k], normal[k], friction), abs=1e-7)


def test_the_apex_counts_as_inside():
    assert matrix(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.5) == pytest.approx(np.eye(3))


def test_derivatives_are_applied_to_each_contact_and_added():
    z, normal = vectors(6, 50)
    dz = np.random.default_rng(7).normal(size=z.shape)
    friction = np.linspace(0.0, 1.0, len(z))
    force = np.ones_like(z)
    add_derivative_along(z, normal, friction, dz, force)
    expected = [1 + matrix(z[k], normal[k], friction[k]) @ dz[k] for k in range(len(z))]
    assert force == pytest.approx(np.array(expected), abs=1e-12)
