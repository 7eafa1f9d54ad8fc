"""Margins of recordings are those of the planned stack at the times at which it rests, and have colours."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

from reports.records.recording import Recorder, Recording
from reports.replays.errors import ExportError
from reports.replays.margins import (
    LOAD_CLASSES,
    MARGIN_COLOURS,
    Margins,
    legend,
    margins_beside,
    margins_of,
    settled_times,
    write_margins,
)
from scenarios.model import Brick, World
from scenarios.planks import GRAVITY, LENGTH, MASS, MU, lay
from scenarios.solids import cylinder

OFFSET = LENGTH / 8.5
NOISE_M = 1e-4
"""Gaps and overlaps of an engine, as ``RECORDED`` allows them."""


def tower(levels: int, *, moved: bool = False) -> Recording:
    """A leaning tower that gains a plank every ten frames, with gaps and overlaps; its lowest plank may be a lift."""
    recorder, rng = Recorder(1 / 60, World(friction=MU)), np.random.default_rng(0)
    planks = [lay(level * OFFSET, level=level + 1) for level in range(levels)]
    planks[0] = replace(planks[0], moved=moved)
    heights = rng.uniform(-NOISE_M, NOISE_M, levels) * (np.arange(levels) > 0)
    for frame in range(10 * levels):
        count = frame // 10 + 1
        position = np.array([plank.position for plank in planks[:count]])
        position[:, 2] += heights[:count]
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
        recorder.see(np.arange(count), position, upright, (), dict(enumerate(planks[:count])))
    return recorder.finish()


def test_margins_of_recorded_poses_are_those_of_the_plan() -> None:
    """The lever over the edge of the lowest plank: s (x_7 - L/2) = W sum (L/2 - x_m); 0.05 mm of x is 0.3 % of it."""
    margins = margins_of(tower(8))
    assert len(margins.times) == 8
    assert np.isnan(margins.load_n[0, 1:]).all(), "not yet placed"
    x, edge = OFFSET * np.arange(8), LENGTH / 2
    expected = MASS * GRAVITY * (edge - x[1:]).sum() / (x[7] - edge)
    assert margins.load_n[-1, 7] == pytest.approx(expected, rel=0.02)
    assert np.isinf(margins.load_n[-1, :4]).all()
    assert margins.weight_n == pytest.approx(MASS * GRAVITY)


def test_a_log_on_the_ground_rolls_at_any_tilt() -> None:
    """Its contact is a line below its axis; the box around it would stand up to 45 deg, or slide at atan(mu)."""
    log = cylinder(0.1, 0.4, position=(0, 0, 0.1), quaternion=(math.sqrt(0.5), 0, math.sqrt(0.5), 0), density=800)
    recorder = Recorder(1 / 60, World(friction=MU))
    recorder.see(np.arange(1), np.array([log.position]), np.array([log.quaternion]), (), {0: log})
    assert margins_of(recorder.finish()).tilt_deg[-1, 0] < 1.0, "1.1 deg is the angle of contact of recorded poses"


def test_what_the_host_moves_carries_and_has_no_margin() -> None:
    margins = margins_of(tower(3, moved=True))
    assert np.isnan(margins.tilt_deg[-1, 0])
    assert (margins.tilt_deg[-1, 1:] > 5).all()


def test_margins_have_colours_from_none_to_unlimited() -> None:
    loads = np.array([[0.0, 0.5, 1.0, 2.0, 29.0, np.inf, np.nan]])
    margins = Margins(np.arange(7), [0.0], 2 * loads, loads, np.full(7, 2.0))
    assert margins.classes("load").tolist() == [[0, 1, 2, 2, 4, 5, -1]]
    assert len(legend("load")[1]) == len(LOAD_CLASSES) + 2 == len(MARGIN_COLOURS)


def test_margins_are_taken_before_each_change_and_at_the_end() -> None:
    recording = tower(3)
    assert settled_times(recording) == pytest.approx(np.array([9, 19, 29]) / 60)
    assert margins_of(recording, [0.2]).row(5.0) == 0


def test_margins_are_written_as_numbers(tmp_path) -> None:
    write_margins(tmp_path / "m.csv", margins_of(tower(2)))
    rows = list(csv.DictReader((tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()))
    assert [(row["brick"], row["load_margin_n"]) for row in rows] == [("0", "inf"), ("0", "inf"), ("1", "inf")]


def test_an_instant_of_sunk_bricks_has_no_margins_and_leaves_the_others() -> None:
    planks, recorder = [lay(0.0, level=1), lay(0.0, level=2)], Recorder(1 / 60, World(friction=MU))
    for sunk in (0.0, 0.5):
        position = np.array([plank.position for plank in planks]) - [[0, 0, 0], [0, 0, sunk * planks[0].size[2]]]
        recorder.see(np.arange(2), position, np.tile([1.0, 0, 0, 0], (2, 1)), (), dict(enumerate(planks)))
    tilts = margins_of(recorder.finish(), [0.0, 1 / 60]).tilt_deg
    assert (tilts[0] > 5).all()
    assert np.isnan(tilts[1]).all()


def test_a_recording_without_masses_and_one_of_sunk_bricks_are_refused_with_the_fix() -> None:
    with pytest.raises(ExportError, match=r"this recording: margins need .* run the trial again to see margins"):
        margins_of(replace(tower(2), physics=None))
    with pytest.raises(ExportError, match="old: margins need a recording with masses"):
        margins_beside({"new": tower(2), "old": replace(tower(2), physics=None)})
    sunk = Recorder(1 / 60)
    plank = Brick((0.117, 0.0234, 0.0078), MASS, (0.0, 0.0, 0.0))
    sunk.see(
        np.arange(2),
        np.array([[0, 0, 0.0039], [0, 0, 0.008]]),
        np.tile([1.0, 0, 0, 0], (2, 1)),
        (),
        {0: plank, 1: plank},
    )
    recording = sunk.finish()
    with pytest.raises(ExportError, match="sunk into each other"):
        margins_of(recording)
    with pytest.raises(ExportError, match=r"second: .* sunk into each other"):
        margins_beside({"first": recording, "second": recording})
    fallen, standing = margins_beside({"fallen": recording, "standing": tower(1)})
    assert np.isnan(fallen.tilt_deg).all()
    assert (standing.tilt_deg > 5).all()
