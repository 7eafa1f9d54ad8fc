"""The approach speed of a contact, from the motions of its bodies before each substep."""

from __future__ import annotations

import numpy as np

from stability_core.ports.shared.approach import Motions, fastest_approach


def test_fastest_approach_is_that_of_the_substep_in_which_the_bodies_closed_in_fastest() -> None:
    """A body that falls at 1, then 2, then 0.5 m/s on the ground came down at 2 m/s, whichever way the pair is named;
    its spin of 3 rad/s about y moves a point 0.1 m out along x by 0.3 m/s, downward."""
    linear, angular = np.zeros((3, 1, 3)), np.zeros((3, 1, 3))
    linear[:, 0, 2] = [-1.0, -2.0, -0.5]
    angular[:, 0, 1] = 3.0
    before = Motions(np.array([7]), np.tile((0.0, 0.0, 0.1), (3, 1, 1)), linear, angular)
    body, ground = np.array([7]), np.array([-1])
    point, up = np.array([[0.1, 0.0, 0.1]]), np.array([[0.0, 0.0, 1.0]])
    np.testing.assert_allclose(fastest_approach(before, ground, body, point, up), [[0.0, 0.0, -2.3]], atol=1e-12)
    np.testing.assert_allclose(fastest_approach(before, body, ground, point, -up), [[0.0, 0.0, 2.3]], atol=1e-12)


def test_substeps_that_differ_by_the_solvers_noise_count_as_the_first_of_them() -> None:
    """A support slips by 50 mm/s, then by 10: the closing speeds of the two substeps differ by less than the noise."""
    linear = np.zeros((2, 1, 3))
    linear[:, 0, 0], linear[:, 0, 2] = [0.05, 0.01], [-1e-6, -5e-6]
    before = Motions(np.array([7]), np.zeros((2, 1, 3)), linear, np.zeros((2, 1, 3)))
    pair = np.array([-1]), np.array([7])
    point, up = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])
    assert fastest_approach(before, *pair, point, up)[0, 0] == 0.01
    assert fastest_approach(before, *pair, point, up, noise=1e-5)[0, 0] == 0.05
    assert fastest_approach(before, *pair, point, up, noise=3e-6)[0, 0] == 0.01


def test_nothing_is_known_of_a_frame_that_nobody_read() -> None:
    """Bodies woken since have no motions of that frame: NaN, also where no body was live."""
    pair = np.array([-1]), np.array([7])
    point, up = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])
    none = np.empty((2, 0, 3))
    for before in (None, Motions(np.empty(0, np.int64), none, none, none)):
        assert np.isnan(fastest_approach(before, *pair, point, up)).all()
