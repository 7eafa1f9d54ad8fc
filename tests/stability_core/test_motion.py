"""Speeds of live bodies, from one frame's centres to the next."""

import math

import numpy as np
import pytest

from stability_core.frame_arrays import MassArrays
from stability_core.motion import track
from stability_core.stack import ABSENT, BODY, FROZEN, LIVE

DT = 1 / 60


@pytest.fixture
def bodies():
    table = np.zeros(4, BODY)
    table["state"] = ABSENT
    return table


def seen(bodies, ids, centers, mass=1.0):
    ids = np.asarray(ids, np.int64)
    return track(bodies, MassArrays(ids, np.full(len(ids), mass), np.asarray(centers, float)), DT)


def test_a_body_seen_for_the_first_time_is_live_and_has_no_speed_yet(bodies):
    assert seen(bodies, [2], [[0.0, 0.0, 1.0]], mass=0.3) == 0
    assert (bodies[2]["state"], bodies[2]["mass"]) == (LIVE, 0.3)
    assert math.isinf(bodies[2]["speed"])
    assert (bodies["state"][[0, 1, 3]] == ABSENT).all()


def test_a_speed_is_the_way_of_the_centre_over_the_frame(bodies):
    generator = np.random.default_rng(1)
    before, after = generator.normal(size=(2, 4, 3))
    seen(bodies, range(4), before)
    seen(bodies, range(4), after)
    assert bodies["speed"] == pytest.approx(np.linalg.norm(after - before, axis=1) / DT)
    assert bodies["center"] == pytest.approx(after)


def test_what_was_noted_in_the_last_frame_is_cleared_but_the_depth_is_remembered(bodies):
    seen(bodies, [0], [[0.0, 0.0, 0.0]])
    row = bodies[0]
    row["depth"], row["slip"], row["touches"], row["neighbours"], row["supported_by"] = 1e-4, 0.2, True, 5, 1
    seen(bodies, [0], [[0.0, 0.0, 0.0]])
    assert (row["depth_before"], row["depth"], row["slip"]) == (1e-4, 0.0, 0.0)
    assert (row["touches"], row["neighbours"], row["supported_by"]) == (False, 0, 0)


def test_a_frozen_body_that_is_listed_is_counted_and_left_alone(bodies):
    seen(bodies, [0, 1], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    bodies[1]["state"] = FROZEN
    assert seen(bodies, [0, 1], [[0.0, 0.0, 0.1], [9.0, 9.0, 9.0]], mass=7.0) == 1
    assert bodies[1]["center"].tolist() == [1.0, 0.0, 0.0]
    assert bodies[1]["mass"] == 1.0
