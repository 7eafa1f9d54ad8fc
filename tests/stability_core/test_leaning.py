"""Eqs 6 and 7 of the paper: one plank of an inverted V, worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stability_core.leaning import holds_on_pivot, split_force, torque_induced_force

G = 9.81
UP = np.array([0.0, 0.0, 1.0])


def plank(theta: float, mass: float = 1.0, length: float = 1.0):
    """Foot, centre and top of a thin plank that leans towards +x at ``theta`` from the ground, and its weight."""
    along = np.array([math.cos(theta), 0.0, math.sin(theta)])
    return np.zeros(3), along * length / 2, along * length, np.array([0.0, 0.0, -mass * G])


def paper_accepts(theta: float, friction: float, mass: float = 1.0, length: float = 1.0) -> bool:
    """The V with a horizontal force at its ridge."""
    foot, center, top, weight = plank(theta, mass, length)
    force = torque_induced_force(weight, center, foot, top)
    return holds_on_pivot(weight, force, np.array([-1.0, 0.0, 0.0]), friction, UP, friction)


@given(st.floats(0.05, 1.5))
def test_the_torque_of_gravity_acts_across_the_plank(theta):
    """|F| = m g cos(theta) / 2, perpendicular to the plank, into the partner and down."""
    foot, center, top, weight = plank(theta)
    force = torque_induced_force(weight, center, foot, top)
    assert np.linalg.norm(force) == pytest.approx(G * math.cos(theta) / 2)
    assert force @ (top - foot) == pytest.approx(0, abs=1e-9)
    assert force[0] > 0 > force[2]


def test_a_body_over_its_pivot_pushes_on_nothing():
    force = torque_induced_force(np.array([0, 0, -G]), np.array([0, 0, 1.0]), np.zeros(3), np.array([0, 0, 2.0]))
    assert force == pytest.approx(np.zeros(3))


@given(st.floats(0.3, 1.5), st.floats(0.02, 1.5))
def test_inverted_v_is_accepted_by_the_known_rule(theta, friction):
    """mu / (1 + mu^2) > sin(theta) cos(theta) / 2: the reading of Eqs 6-7 with friction used in full."""
    margin = friction / (1 + friction**2) - math.sin(theta) * math.cos(theta) / 2
    if abs(margin) > 1e-9:
        assert paper_accepts(theta, friction) == (margin > 0)


def test_its_known_weakness_a_v_that_must_slip_is_accepted():
    """At 55 degrees exact statics asks for mu = cot(theta) / 2 = 0.35; the paper's rule is content with 0.30."""
    theta = math.radians(55)
    assert 1 / (2 * math.tan(theta)) > 0.30
    assert paper_accepts(theta, 0.30)


@given(st.floats(0.3, 1.5), st.floats(0.02, 1.5), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_verdict_does_not_depend_on_units(theta, friction, mass, length):
    margin = friction / (1 + friction**2) - math.sin(theta) * math.cos(theta) / 2
    if abs(margin) > 1e-9:
        assert paper_accepts(theta, friction, mass, length) == paper_accepts(theta, friction)


def test_a_contact_that_is_pulled_carries_nothing():
    pressed, sliding = split_force(np.array([0.0, 3.0, -4.0]), UP)
    assert pressed == pytest.approx([0, 0, -4])
    assert sliding == pytest.approx([0, 3, 0])
    pressed, sliding = split_force(np.array([0.0, 3.0, 4.0]), UP)
    assert pressed == pytest.approx([0, 0, 0])
    assert sliding == pytest.approx([0, 3, 4])
