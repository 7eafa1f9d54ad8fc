"""Prebuilt stacks in the harness: set down without a gap, shown to the extension before the first step, recorded."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import run_trial as trials
from bench.trial import stepping
from bench.trial.builder import Builder
from bench.trial.playback import Playback
from scenarios.model import CLEARANCE, Expectation, Place, Scene, World
from scenarios.planks import THICKNESS, lay

TOWER = tuple(lay(0.0, level=level) for level in (1, 2, 3))


def scene_of(*actions: Place) -> Scene:
    return Scene("test", "test", {}, World(), actions, Expectation("stand", ""), "", watch_s=0.5)


@pytest.fixture
def engine(fake_engine):
    """An engine that finds contacts on demand, and writes down in which order it is called."""

    class Prebuilt(fake_engine):
        def __init__(self, *arguments) -> None:
            super().__init__(*arguments)
            self.calls: list[str] = []

        def find_contacts(self) -> None:
            self.calls.append("find_contacts")
            super().find_contacts()

        def _step(self, seconds: float) -> None:
            self.calls.append("step")
            super()._step(seconds)

    return Prebuilt


@pytest.fixture
def extension(monkeypatch):
    """An extension that freezes the bodies to adopt for which ``freezes`` is true."""
    made = SimpleNamespace(adopted=[], freezes=lambda _: True)

    class Fake:
        def __init__(self, port, **_: object) -> None:
            self.port = port

        def adopt(self, bodies):
            made.adopted.append(list(bodies))
            frozen = tuple(body for body in bodies if made.freezes(body))
            self.port.sleep(frozen)
            return SimpleNamespace(frozen=frozen, woken=(), reasons=dict.fromkeys(frozen, "adopted"))

        def update(self, dt: float):
            return SimpleNamespace(frozen=(), woken=(), reasons={})

    monkeypatch.setattr(stepping, "StabilityExtension", Fake)
    return made


def play(scene: Scene, simulation, policy: str | None) -> Playback:
    run = Playback(scene, simulation, policy, 60.0, lambda _: None)
    assert run.run() == "completed"
    return run


def test_a_prebuilt_stack_is_set_down_without_a_gap(engine) -> None:
    simulation = engine()
    builder = Builder(scene_of(Place(0.0, TOWER, 0.0)), simulation)
    builder.act(0.0)
    heights = [position[2] for position, _ in simulation.pose.values()]
    assert heights == pytest.approx(THICKNESS * np.array([0.5, 1.5, 2.5]), abs=1e-15)
    assert builder.placed == {1: 0.0, 2: 0.0, 3: 0.0}
    assert builder.take_set_down() == [0, 1, 2]
    assert builder.take_set_down() == []


def test_a_prebuilt_stack_is_set_down_on_its_actual_support(engine) -> None:
    """The lowest plank has sunk by 1 mm; the group above it keeps its own distances."""
    simulation = engine()
    builder = Builder(scene_of(Place(0.0, TOWER[:1]), Place(1.0, TOWER[1:], 0.0)), simulation)
    builder.act(0.0)
    simulation.move(0, (0, 0, THICKNESS / 2 - 1e-3), (1, 0, 0, 0))
    builder.act(1.0)
    assert simulation.pose[1][0][2] == pytest.approx(1.5 * THICKNESS - 1e-3, abs=1e-15)
    assert simulation.pose[2][0][2] == pytest.approx(2.5 * THICKNESS - 1e-3, abs=1e-15)
    assert builder.take_set_down() == [1, 2]


def test_each_brick_of_a_group_rests_on_what_is_below_its_own_level(engine) -> None:
    """A group of levels 1 and 2: the plank below the second one has been lifted by 0.1 mm, and carries the group."""
    simulation = engine()
    group = (lay(0.3, level=1), lay(0.0, level=2))
    builder = Builder(scene_of(Place(0.0, TOWER[:1], 0.0), Place(1.0, group, 0.0)), simulation)
    builder.act(0.0)
    simulation.move(0, (0, 0, THICKNESS / 2 + 1e-4), (1, 0, 0, 0))
    builder.act(1.0)
    assert simulation.pose[2][0][2] == pytest.approx(1.5 * THICKNESS + 1e-4, abs=1e-15)
    assert simulation.pose[1][0][2] == pytest.approx(0.5 * THICKNESS + 1e-4, abs=1e-15)


def test_the_extension_judges_it_before_the_next_step(engine, extension) -> None:
    simulation = engine()
    run = play(scene_of(Place(0.0, TOWER, 0.0)), simulation, "paper")
    assert simulation.calls[:3] == ["find_contacts", "step", "step"]
    assert simulation.calls.count("find_contacts") == 1
    assert extension.adopted == [[0, 1, 2]]
    assert run.adopted == 3
    assert (run.rows[0].frozen, run.rows[0].live, run.rows[1].frozen) == (3, 0, 0)


def test_a_second_stack_is_judged_when_it_comes(engine, extension) -> None:
    simulation = engine()
    extension.freezes = lambda body: body != 1
    run = play(scene_of(Place(0.0, TOWER[:1], 0.0), Place(1.0, TOWER[1:], 0.0)), simulation, "paper")
    assert extension.adopted == [[0], [1, 2]]
    assert run.adopted == 2
    second = [number for number, call in enumerate(simulation.calls) if call == "find_contacts"][1]
    assert simulation.calls[:second].count("step") == 60


def test_its_time_counts_for_the_next_frame(engine, extension, monkeypatch) -> None:
    """Each reading of the clock is a second later; adopting and playing read it alike."""
    ticks = iter(range(10_000))
    monkeypatch.setattr(stepping, "perf_counter", lambda: float(next(ticks)))
    frames = stepping.SteeredFrames(engine(), "paper")
    assert frames.adopt([]) == ()
    both, plain = (frames.play()[0] for _ in range(2))
    assert (both.engine, plain.engine) == (2.0, 1.0)
    assert both.total == pytest.approx(2 * plain.total)


@pytest.mark.parametrize("policy", [None, "paper"])
def test_bricks_that_are_laid_one_by_one_are_not_adopted(engine, extension, policy) -> None:
    simulation = engine()
    run = play(scene_of(Place(0.0, TOWER[:1]), Place(1.0, TOWER[1:2])), simulation, policy)
    assert simulation.pose[1][0][2] == pytest.approx(1.5 * THICKNESS + 2 * CLEARANCE), "nothing moves here"
    assert (run.adopted, extension.adopted) == (None, [])
    assert "find_contacts" not in simulation.calls


def test_without_an_extension_nothing_special_happens(engine) -> None:
    simulation = engine()
    run = play(scene_of(Place(0.0, TOWER, 0.0)), simulation, None)
    assert set(simulation.calls) == {"step"}
    assert not simulation.is_observed
    assert run.adopted is None


@pytest.mark.parametrize(("policy", "built", "adopted"), [("paper", "at_once", 3), ("none", "at_once", None)])
def test_the_record_says_how_many_bodies_were_adopted(monkeypatch, engine, extension, policy, built, adopted) -> None:
    monkeypatch.setattr(trials, "warm_up", lambda _: None)
    monkeypatch.setattr(trials, "open_engine", lambda *_, **__: engine())
    one = Trial("bullet", "game", "plank_tower", "x", {"levels": 3, "built": built}, policy, 0, 0)
    record = trials.run_trial(one, Limits(ratio=False), "abc", lambda _: None).record
    assert (record.status, record.adopted) == ("completed", adopted), record.message
    assert record.verdict == "false_stand", "nothing moves here, also when a brick is taken"
