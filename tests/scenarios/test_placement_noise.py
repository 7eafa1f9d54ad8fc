"""Placement noise: its size, and that it is reproducible."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest

from scenarios.geometry import Boxes, overlap_in_plan
from scenarios.model import Brick, Expectation, Place, Push, Remove, Scene, World
from scenarios.placement_noise import CUT, SHIFT, TURN, deviates, with_placement_noise
from scenarios.planks import lay, lean
from scenarios.registry import SCENARIOS, build


def scene(*actions, planar=False):
    return Scene("test", "test", {}, World(), actions, Expectation("study", ""), "", planar)


def yaw(brick):
    return 2 * math.atan2(brick.quaternion[3], brick.quaternion[0])


def test_seed_zero_is_exact():
    exact = build("four_stack")
    assert with_placement_noise(exact, 0) is exact


def test_a_negative_seed_is_refused():
    with pytest.raises(ValueError, match="seed must be 0"):
        with_placement_noise(build("four_stack"), -1)


def test_deviates_are_normal_cut_at_three():
    """Moments of 12,000 draws lie within four standard errors of those of the cut normal distribution."""
    draws = np.array([deviates("test", seed, brick) for seed in range(1, 41) for brick in range(300)])
    n = len(draws)
    cut_std = 0.98658  # standard deviation of a normal deviate given that it lies within three
    assert np.abs(draws).max() <= CUT
    assert np.abs(draws.mean(axis=0)).max() < 4 / math.sqrt(n)
    assert draws.std(axis=0) == pytest.approx([cut_std] * 3, abs=4 / math.sqrt(2 * n))
    assert np.abs(np.corrcoef(draws.T) - np.eye(3)).max() < 4 / math.sqrt(n)
    assert np.mean(np.abs(draws) < 1) == pytest.approx(0.6845, abs=4 * math.sqrt(0.25 / draws.size))


def test_bricks_err_by_a_third_of_a_millimetre_and_of_a_degree():
    exact = build("four_stack")
    errors = []
    for seed in range(1, 6):
        for planned, laid in zip(exact.bricks, with_placement_noise(exact, seed).bricks, strict=True):
            dx, dy, dz = np.subtract(laid.position, planned.position)
            turn = (yaw(laid) - yaw(planned) + math.pi) % (2 * math.pi) - math.pi
            assert dz == 0
            errors.append((dx / SHIFT, dy / SHIFT, turn / TURN))
    assert np.abs(errors).max() <= CUT + 1e-9
    assert np.std(errors, axis=0) == pytest.approx([1, 1, 1], abs=0.13)  # four standard errors of 600 draws


def test_draws_belong_to_variant_seed_and_brick():
    keys = [("a", 1, 0), ("b", 1, 0), ("a", 2, 0), ("a", 1, 1), ("a", 11, 0), ("a", 1, 10)]
    assert len({deviates(*key) for key in keys}) == len(keys)


def test_another_process_lays_the_same_bricks():
    """Whatever Python's own hash seed."""
    program = (
        "from scenarios.placement_noise import with_placement_noise; from scenarios.registry import build; "
        "print([(b.position, b.quaternion) for b in with_placement_noise(build('four_stack', levels=2), 7).bricks])"
    )
    printed = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONHASHSEED": "1"},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    here = [(b.position, b.quaternion) for b in with_placement_noise(build("four_stack", levels=2), 7).bricks]
    assert printed == f"{here}\n"


@pytest.mark.parametrize("name", SCENARIOS)
def test_no_brick_is_laid_into_its_neighbours(name):
    """Within a group, which moves as one, a brick leans over another only where it is meant to."""
    plan = build(name, **{"card_house": {"storeys": 3}, "prop_between_walls": {"gap": 5}}.get(name, {}))
    places = [action for action in plan.actions if isinstance(action, Place)]
    group = np.repeat(np.arange(len(places)), [len(place.bricks) for place in places])
    level = np.array([brick.level for brick in plan.bricks])
    planned = Boxes.of(plan.bricks)
    meant = overlap_in_plan(planned, planned) & (group[:, None] == group)
    beside = level[:, None] == level
    for seed in range(1, 6):
        laid = Boxes.of(with_placement_noise(plan, seed).bricks)
        assert not (overlap_in_plan(laid, laid) & beside & ~meant).any()


def test_a_draw_that_overlaps_is_thrown_away():
    """Planks 0.2 mm apart collide in two of five draws; the draw is repeated, always in the same way."""
    close = scene(Place(0, (lay(0.0, level=1),)), Place(1, (lay(0.1172, level=1),)))
    redrawn = 0
    for seed in range(1, 40):
        laid = with_placement_noise(close, seed)
        left, right = (Boxes.of([brick]) for brick in laid.bricks)
        assert not overlap_in_plan(left, right).any()
        assert with_placement_noise(close, seed) == laid
        redrawn += laid.bricks[1].position[0] != close.bricks[1].position[0] + deviates("test", seed, 1)[0] * SHIFT
    assert redrawn > 5


def test_a_brick_without_room_is_an_error_that_names_it():
    overlapping = scene(Place(0, (lay(0.0, level=1),)), Place(1, (lay(0.1, level=1),)))
    with pytest.raises(ValueError, match=r"test, seed 1: brick 1 has no room.*use seed 0"):
        with_placement_noise(overlapping, 1)


def test_a_group_moves_as_one_rigid_body():
    pair = (lean(-0.04, theta=1.2, toward=1, level=1), lean(0.04, theta=1.2, toward=-1, level=1))
    rolled = Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.1, 0.05), (0.8, 0.6, 0.0, 0.0))
    group = (*pair, rolled)
    (moved,) = with_placement_noise(scene(Place(0, group)), 3).actions
    before, after = Boxes.of(group).corners.reshape(-1, 3), Boxes.of(moved.bricks).corners.reshape(-1, 3)

    def distances(points):
        return np.linalg.norm(points[:, None] - points[None], axis=2)

    assert distances(after) == pytest.approx(distances(before), abs=1e-15)
    assert after[:, 2] == pytest.approx(before[:, 2], abs=1e-15)
    shift = np.subtract(after.mean(axis=0), before.mean(axis=0))
    dx, dy, _ = deviates("test", 3, 0)
    assert shift == pytest.approx([dx * SHIFT, dy * SHIFT, 0], abs=1e-15)
    assert np.abs(after - before - shift).max() > 1e-5  # it turned as well


def test_in_a_planar_scene_the_hand_errs_along_x_only():
    exact = build("card_house", storeys=3)
    for planned, laid in zip(exact.bricks, with_placement_noise(exact, 1).bricks, strict=True):
        assert laid.position[0] != planned.position[0]
        assert laid.position[1:] == planned.position[1:]
        assert laid.quaternion == planned.quaternion


def test_what_is_removed_or_pushed_is_left_as_planned():
    plank = lay(0.0, level=1)
    remove, push = Remove(2, 0), Push(1, 0, (0.0, 0.1, 0.0))
    played = with_placement_noise(scene(Place(0, (plank,)), push, remove), 5)
    assert played.actions[1:] == (push, remove)
