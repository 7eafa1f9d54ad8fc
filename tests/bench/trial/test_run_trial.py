"""What one trial makes of an engine that cannot, or does not."""

from dataclasses import replace

import pytest

from bench.studies import plan
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import run_trial as trials
from reports.records.trial import TrialRecord
from scenarios.model import Place
from scenarios.placement_noise import NoRoomError
from scenarios.registry import build


def run(engine: str, scenario: str, policy: str = "none", **parameters) -> TrialRecord:
    one = Trial(engine, "game", scenario, f"{scenario}-2", parameters, policy, 0, 0)
    return trials.run_trial(one, Limits(trial_wall_s=3600), "abc", lambda _: None).record


def test_a_planar_engine_says_why_it_does_not_play_a_scene_in_space() -> None:
    refused = run("pymunk", "four_stack", levels=2)
    assert (refused.status, refused.verdict) == ("unsupported", "none")
    assert refused.message == "pymunk is planar, but four_stack-2 is not a planar scene: choose another engine"


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (MemoryError(), "out_of_memory", "the process ran out of memory; run fewer jobs at a time"),
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


@pytest.mark.parametrize("policy", ["none", "at_rest"])
@pytest.mark.parametrize("scenario", ["leaning_tower", "poured_pile"])
def test_an_engine_that_raises_in_its_first_step_keeps_its_own_message(
    monkeypatch, fake_engine, policy: str, scenario: str
) -> None:
    """No frame was played: there is no mean of anything, and the record says so by nulls."""

    def refuse(simulation, step: int) -> None:
        raise RuntimeError("no licence")

    monkeypatch.setattr(trials, "open_engine", lambda *_, **__: fake_engine(refuse))
    record = run("bullet", scenario, policy)
    assert (record.status, record.message) == ("error", "RuntimeError: no licence")
    assert (record.live_mean, record.live_last, record.frame_ms_p50) == (None, None, None)


@pytest.mark.parametrize("last", [20, 40, 59])
def test_an_engine_that_raises_later_keeps_its_own_message(monkeypatch, fake_engine, last: int) -> None:
    def give_up(simulation, step: int) -> None:
        if step > last:
            raise RuntimeError("out of contacts")

    monkeypatch.setattr(trials, "open_engine", lambda *_, **__: fake_engine(give_up))
    record = run("bullet", "leaning_tower", "at_rest", levels=2)
    assert (record.status, record.message) == ("error", "RuntimeError: out of contacts")
    assert record.live_mean is not None


def test_a_level_of_too_few_frames_has_no_ratio(monkeypatch, fake_engine) -> None:
    """A frame of a third of a second: the level stands after three, and none of the first five is timed."""

    def fake(*_, **__) -> object:
        simulation = fake_engine()
        simulation.info = replace(simulation.info, profile=replace(simulation.info.profile, frame_s=1 / 3))
        return simulation

    monkeypatch.setattr(trials, "open_engine", fake)
    record = run("bullet", "leaning_tower", "at_rest", levels=1)
    assert record.status == "completed", record.message
    assert record.frame_ratio is None
    assert record.frame_ratio_message == "the level was placed within the first 5 frames, which are not timed"


def test_a_ratio_comes_with_the_share_of_a_step_with_one_live_brick() -> None:
    """How small they are is a matter of the machine; they are measured together or not at all."""
    pytest.importorskip("pybullet")
    record = run("bullet", "four_stack", "paper", levels=6)
    assert record.frame_ratio is not None, (record.status, record.message, record.frame_ratio_message)
    assert record.frame_ratio_one_live is not None
    assert record.frame_ratio_one_live > 0.0


def test_a_level_that_never_was_the_highest_has_no_ratio(monkeypatch, fake_engine) -> None:
    """Thirty levels come at once; a ratio would be that of 25."""
    monkeypatch.setattr(trials, "open_engine", lambda *_, **__: fake_engine())
    scene = build("plank_tower", levels=30)
    at_once = replace(scene, actions=(Place(0.0, scene.bricks),))
    monkeypatch.setattr(Trial, "build_scene", lambda _: at_once)
    record = run("bullet", "plank_tower", "at_rest")
    assert (record.status, record.frame_ratio_level) == ("completed", 25), record.message
    assert record.frame_ratio_message == "the level was placed together with higher levels"


def test_a_seed_whose_noise_finds_no_room_is_unsupported(monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise NoRoomError("no room; use seed 0")

    monkeypatch.setattr(plan, "with_placement_noise", refuse)
    record = run("bullet", "leaning_tower", levels=2)
    assert (record.status, record.verdict, record.message) == ("unsupported", "none", "no room; use seed 0")
    assert record.levels_planned == 2


@pytest.mark.parametrize(
    ("friction", "adopted", "expected"), [(0.45, None, "right"), (0.0, None, "none"), (0.0, 3, "right")]
)
def test_a_stack_without_friction_counts_only_if_the_extension_adopted_it(friction, adopted, expected) -> None:
    scene = build("plank_tower", levels=3)
    scene = replace(scene, world=replace(scene.world, friction=friction))
    one = Trial("bullet", "game", "plank_tower", scene.variant, {"levels": 3}, "equilibrium", 0, 0)
    assert trials.bare_record(one, scene, "abc", "completed", "", adopted=adopted).verdict == expected
