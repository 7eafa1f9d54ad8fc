"""Poured piles: poses at random, but the same every time, and no brick inside another."""

import numpy as np
import pytest

from scenarios.geometry import Boxes, height_above_ground, vertical_clearance
from scenarios.placement_noise import with_placement_noise
from scenarios.registry import build


def test_bricks_come_one_by_one_from_above_the_pile():
    scene = build("poured_pile", bricks=20, height=40)
    assert len(scene.bricks) == len(scene.actions) == 20
    assert {len(action.bricks) for action in scene.actions} == {1}
    assert [action.height for action in scene.actions] == pytest.approx([0.0405] * 20)
    assert scene.poured
    assert scene.expectation.outcome == "study"


def test_a_draw_is_one_pile_and_another_draw_another():
    assert build("poured_pile", bricks=9).bricks == build("poured_pile", bricks=12).bricks[:9]
    assert build("poured_pile", draw=2).bricks[0] != build("poured_pile").bricks[0]
    assert with_placement_noise(build("poured_pile", bricks=9), 1).bricks != build("poured_pile", bricks=9).bricks


def test_each_brick_is_planned_where_it_first_touches():
    boxes = Boxes.of(build("poured_pile", bricks=40).bricks)
    for n in range(1, 40):
        one, before = (Boxes(boxes.center[at], boxes.half_axes[at]) for at in ([n], slice(n)))
        gap = min(vertical_clearance(one, before).min(), height_above_ground(one)[0])
        assert gap == pytest.approx(0, abs=1e-12)


def test_turns_favour_no_direction():
    """The vertical component of each axis of a brick is uniform: mean 0 and mean square 1/3, within 4 deviations."""
    boxes = Boxes.of(build("poured_pile", bricks=300).bricks)
    rise = boxes.half_axes[:, :, 2] / np.linalg.norm(boxes.half_axes, axis=2)
    assert rise.mean(axis=0) == pytest.approx(0, abs=4 * np.sqrt(1 / 3 / 300))
    assert (rise**2).mean(axis=0) == pytest.approx(1 / 3, abs=4 * np.sqrt(4 / 45 / 300))
