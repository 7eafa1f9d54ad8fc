"""Speeds of live bodies, from one frame's centres to the next."""

import math

import numpy as np
import pytest

from stability_core.frame_arrays import MassArrays
from stability_core.motion import list_shifted_loads, time_at_rest, track
from stability_core.settings import Settings
from stability_core.stack import ABSENT, BODY, FROZEN, LIVE

DT = 1 / 60
SETTINGS = Settings()


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


@pytest.fixture
def load(bodies):
    """A live body of size 1 m that lies on body 0, and has its patches."""
    bodies["state"], bodies["size"] = LIVE, 1.0
    bodies["load_s"], bodies["is_load"] = 1.0, True
    bodies["supported_by"] = bodies["load_supported_by"] = bodies["stood_on"] = 1
    return bodies[1]


def listed(bodies) -> bool:
    """Whether the core builds the patches of body 1 anew in this frame."""
    lying, gone = np.empty(4, np.int64), np.empty(4, np.int64)
    limits = SETTINGS.limits(9.81)[0]
    n, _ = list_shifted_loads(bodies, np.array([1]), limits, DT, lying, gone)
    if n:
        bodies[1]["load_center"] = bodies[1]["center"]
        bodies[1]["load_supported_by"] = bodies[1]["supported_by"]
        bodies[1]["load_steady_s"] = bodies[1]["steady_s"]
    return n > 0


def test_each_shift_of_a_load_doubles_the_distance_of_the_next_up_to_a_limit(bodies, load):
    for times in (1, 2, 4, 8, 8, 8):
        far = min(times * SETTINGS.load_shift, SETTINGS.farthest_shift)
        load["center"][0] += 0.99 * far
        assert not listed(bodies)
        load["center"][0] += 0.02 * far
        assert listed(bodies)


def test_a_load_that_has_kept_its_place_is_listed_once_more_however_little_it_has_shifted(bodies, load):
    load["shifts"] = 9
    load["center"][0] += 0.1 * SETTINGS.load_shift
    load["steady_s"] = SETTINGS.doubt_s
    assert listed(bodies)
    assert not listed(bodies)


def test_a_new_support_counts_at_once_and_a_lost_one_only_after_the_dwell_time(bodies, load):
    load["supported_by"] = 3
    assert listed(bodies)
    frames = round(SETTINGS.rest_s / DT)
    load["stood_on"], load["stood_on_s"] = 0, 0.0
    for frame in range(2 * frames):  # the contact with body 0 comes and goes
        load["supported_by"] = 2 if frame % 3 else 3
        assert not listed(bodies)
    load["supported_by"] = 2
    assert any(listed(bodies) for _ in range(2 * frames))


@pytest.mark.parametrize("held", [False, True])
def test_a_held_body_is_never_at_rest_however_long_it_keeps_its_place(bodies, held):
    bodies["state"], bodies["size"] = LIVE, 1.0
    bodies[1]["held"] = held
    for _ in range(round((SETTINGS.still_s + SETTINGS.rest_s) / DT) + 1):
        time_at_rest(bodies, np.array([1]), SETTINGS.limits(9.81)[0], DT)
    assert bodies[1]["is_resting"] != held
