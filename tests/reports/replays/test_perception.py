"""Deviations that are planted in a recording are found, in pixels; nothing is found where nothing is planted."""

from __future__ import annotations

import numpy as np
import pytest

from reports.records.recording import Recorder, Recording
from reports.replays.perception import FAR, LINES, kept_share, perceive, perception_table, pixels_per_metre
from scenarios.model import Brick, World
from scenarios.planks import LENGTH, THICKNESS, lay

FRAMES, FREEZES = 60, 30
RESOLUTION_M = 1e-4
"""Twice the dead band of a recording: a second difference has three poses."""
UPRIGHT = [1.0, 0.0, 0.0, 0.0]
PLANKS = [lay(0.0, level=1), lay(0.0, level=2)]
PX_PER_M = LINES / LENGTH
"""The near camera shows the greatest extent of two planks, their length, as the height of the screen."""


def recorded(shift_m=0.0, gap_m=0.0, aside_m=0.0, frozen=(0, 1), moves_from=None) -> Recording:
    """Two planks, which freeze in frame 30; the upper one jumps along x by ``shift_m`` in that frame, lies ``gap_m``
    above the lower one, ``aside_m`` from its middle, and moves by 1 mm a frame from a frame on."""
    recorder = Recorder(1 / 60, World())
    for frame in range(FRAMES):
        position = np.array([plank.position for plank in PLANKS])
        position[1] += (aside_m + (shift_m if frame >= FREEZES else 0.0), 0.0, gap_m)
        if moves_from is not None:
            position[1, 0] += 1e-3 * max(0, frame - moves_from)
        asleep = frozen if frame >= FREEZES else ()
        recorder.see(np.arange(2), position, np.tile(UPRIGHT, (2, 1)), asleep, dict(enumerate(PLANKS)))
    return recorder.finish()


def test_the_standard_camera_is_that_of_the_definition():
    """1080 lines and 40 deg at 0.6 m: 2.5 px per mm."""
    assert pixels_per_metre(0.6) == pytest.approx(2473, rel=1e-3)


def test_a_stack_that_freezes_in_place_shows_nothing():
    found = perceive(recorded())
    assert (found.pop_m, found.hover_m) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert (found.unsupported_s, found.events) == (0.0, 2)


def test_a_planted_pop_of_one_pixel_is_found():
    shift = 1.0 / PX_PER_M
    found = perceive(recorded(shift_m=shift))
    assert found.pixels(found.pop_m) == pytest.approx(1.0, abs=RESOLUTION_M * PX_PER_M)
    assert found.pixels(found.pop_m, far=True) == pytest.approx(found.pixels(found.pop_m) / FAR)


def test_a_jump_that_the_run_without_the_extension_has_as_well_is_no_pop():
    shift = 5.0 / PX_PER_M
    alone = recorded(shift_m=shift, frozen=())
    assert perceive(recorded(shift_m=shift), alone).pop_m == pytest.approx(0.0, abs=1e-12)
    assert perceive(recorded(shift_m=2 * shift), alone).pop_m == pytest.approx(shift, abs=RESOLUTION_M)


def test_a_brick_that_hovers_by_half_a_millimetre_is_found():
    assert perceive(recorded(gap_m=0.5e-3)).hover_m == pytest.approx(0.5e-3, abs=RESOLUTION_M)
    assert perceive(recorded(gap_m=0.5e-3, frozen=(0,))).hover_m < 1e-9, "a live brick may fall"


def test_a_brick_frozen_above_the_ground_hovers():
    recorder, brick = Recorder(1 / 60, World()), Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.0503))
    for frame in range(4):
        asleep = (0,) if frame > 1 else ()
        recorder.see(np.arange(1), np.array([brick.position]), np.array([UPRIGHT]), asleep, {0: brick})
    assert perceive(recorder.finish()).hover_m == pytest.approx(0.3e-3, abs=1e-5)


def test_a_brick_frozen_beyond_the_edge_is_unsupported_for_as_long_as_it_is_frozen():
    """Its centre lies 10 mm beyond the end of the lower plank, and it is frozen for half a second."""
    found = perceive(recorded(aside_m=LENGTH / 2 + 10e-3))
    assert found.unsupported_s == pytest.approx((FRAMES - FREEZES) / 60)


def test_a_fall_that_begins_ten_frames_late_is_late_by_ten_frames():
    """The plank moves by 1 mm a frame, which is 9 px, from frame 30 on; the fall is due in frame 20."""
    found = perceive(recorded(frozen=(), moves_from=29), due_s=20 / 60)
    assert found.late_s == pytest.approx(10 / 60)
    assert perceive(recorded(frozen=()), due_s=20 / 60).late_s is None


def test_a_brick_that_moves_by_its_thickness_is_not_kept():
    """From frame 30 on the upper plank moves by 1 mm a frame, by 29 mm in all; one that moves by 5 mm is kept."""
    assert kept_share(recorded(moves_from=29), from_s=0.4) == 0.5
    assert kept_share(recorded(shift_m=THICKNESS * 0.9), from_s=0.4) == 1.0
    assert kept_share(recorded(shift_m=THICKNESS * 1.1), from_s=0.4) == 0.5


def test_the_table_says_that_nobody_was_asked():
    table = perception_table("a trial", perceive(recorded(gap_m=THICKNESS / 10)))
    assert "not a user study" in table.title
    assert [row[0] for row in table.rows] == ["near", "far"]
    assert float(table.rows[0][2]) == pytest.approx(FAR * float(table.rows[1][2]), rel=0.01)
