"""What one trial makes of an engine that cannot, or does not."""

import pytest

from bench import trial as trials
from bench.plan import Trial
from bench.studies import Limits
from reports.records import TrialRecord


def run(engine: str, scenario: str, **parameters) -> TrialRecord:
    one = Trial(engine, "game", scenario, f"{scenario}-2", parameters, "none", 0, 0)
    return trials.run_trial(one, Limits(trial_wall_s=3600), "abc", lambda _: None).record


def test_a_planar_engine_says_why_it_does_not_play_a_scene_in_space() -> None:
    refused = run("pymunk", "four_stack", levels=2)
    assert (refused.status, refused.verdict) == ("unsupported", "none")
    assert refused.message == "pymunk is a planar engine and four_stack-2 is not a planar scene"


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (MemoryError(), "out_of_memory", "the process ran out of memory"),
        (RuntimeError("no licence"), "error", "RuntimeError: no licence"),
        (RuntimeError("\x1b[31mno licence\x1b[0m"), "error", "RuntimeError: no licence"),
        (NotImplementedError("\x1b[31mno joints\x1b[0m"), "unsupported", "no joints"),
    ],
)
def test_what_an_engine_raises_is_an_outcome(monkeypatch, error, status, message) -> None:
    def refuse(*arguments, **options) -> None:
        raise error

    monkeypatch.setattr(trials, "open_engine", refuse)
    record = run("bullet", "leaning_tower", levels=2)
    assert (record.status, record.message) == (status, message)
    assert record.verdict == ("none" if status == "unsupported" else "failed")
