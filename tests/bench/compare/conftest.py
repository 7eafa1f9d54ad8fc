"""Records and sides of comparisons, made by hand: a trial that stands, and what is changed in it."""

import json

import pytest

from bench.compare.side import Baseline, Engine, Machine
from reports.records.trial import TrialRecord

NAME = "bullet.game.four_stack-3.paper.s0.r0"
STANDS = {
    "trial": NAME,
    "engine": "bullet",
    "engine_version": "1.0",
    "profile": "game",
    "scenario": "four_stack",
    "scene": "four_stack-3",
    "parameters": {"levels": 3},
    "policy": "paper",
    "seed": 0,
    "repeat": 0,
    "status": "completed",
    "levels_placed": 3,
    "height_levels": 3,
    "sink_m": 1e-4,
    "creep_m_s": 4e-6,
    "pose_hash": "aa",
    "expectation": {"outcome": "stand", "theory": "a column"},
    "verdict": "right",
    "environment": "here",
    "levels_planned": 3,
}
MACHINE = Machine(
    processor="P1",
    platform="Linux",
    python="3.11",
    engines={
        "bullet": Engine(version="1.0", deterministic="across processes"),
        "dart": Engine(version="1.0", deterministic="no"),
    },
)


def record(**changes: object) -> TrialRecord:
    """A 4-stack of three levels that stands, but for what is changed."""
    return TrialRecord.model_validate_json(json.dumps(STANDS | changes))


def falling(**changes: object) -> TrialRecord:
    """A tower that must fall at 9, and does."""
    demanded = {"outcome": "fall", "theory": "statics", "level": 9}
    fell = {"status": "collapsed", "levels_planned": 13, "height_levels": 8, "collapse_level": 9, "creep_m_s": None}
    return record(**{"expectation": demanded, **fell, **changes})


def side(*records: TrialRecord, **changes: object) -> Baseline:
    """A run of these trials, or of the one that stands."""
    fields = {"study": "ci", "trial_wall_s": 60, "machines": {"here": MACHINE}, "trials": records or [record()]}
    return Baseline(**(fields | changes))


@pytest.fixture
def make():
    """The makers above, as tests of this folder cannot import each other."""

    class Make:
        machine = MACHINE
        name = NAME

    Make.record, Make.falling, Make.side = map(staticmethod, (record, falling, side))
    return Make
