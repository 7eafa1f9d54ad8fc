"""What one trial makes of an engine that cannot, or does not."""

import pytest

from bench import plan
from bench import trial as trials
from bench.plan import Trial
from bench.studies import Limits
from reports.records import TrialRecord
from scenarios.hand import NoRoomError


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
    ],
)
def test_what_an_engine_raises_is_an_outcome(monkeypatch, error, status, message) -> None:
    def refuse(*arguments, **options) -> None:
        raise error

    monkeypatch.setattr(trials, "open_engine", refuse)
    record = run("bullet", "leaning_tower", levels=2)
    assert (record.status, record.verdict, record.message) == (status, "failed", message)


def test_a_seed_whose_noise_finds_no_room_is_unsupported(monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise NoRoomError("no room; use seed 0")

    monkeypatch.setattr(plan, "with_hand", refuse)
    record = run("bullet", "leaning_tower", levels=2)
    assert (record.status, record.verdict, record.message) == ("unsupported", "none", "no room; use seed 0")
    assert record.levels_planned == 2
