"""The distribution of collapse levels: each trial is counted once, and none is made up."""

from reports.records.trial import TrialRecord
from reports.tables.collapse_levels import collapse_level_tables
from scenarios.model import Expectation


def trial(seed: int, status: str, level: int | None = None, kind: str | None = None) -> TrialRecord:
    return TrialRecord(
        trial=f"t.s{seed}",
        engine="physx",
        engine_version="1",
        profile="unity4",
        scenario="four_stack",
        scene="four_stack",
        parameters={},
        policy="none",
        seed=seed,
        repeat=0,
        status=status,
        collapse_level=level,
        collapse_kind=kind,
        expectation=Expectation("stand", ""),
        verdict="none",
        environment="abc",
        levels_planned=30,
    )


def test_every_trial_is_counted_once() -> None:
    fallen = [trial(0, "collapsed", 5, "sink"), trial(1, "collapsed", 4, "slide"), trial(2, "collapsed", 5, "sink")]
    (table,) = collapse_level_tables([*fallen, trial(3, "completed"), trial(4, "timeout"), trial(5, "crashed")])
    assert table.rows == (("four_stack", "physx", "unity4", "none", "4: 1 (1 slide); 5: 2 (2 sink)", "1", "2"),)


def test_few_trials_are_no_distribution() -> None:
    assert collapse_level_tables([trial(seed, "completed") for seed in range(4)]) == []
