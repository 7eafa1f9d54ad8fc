"""A process a trial: a crash or a hang costs one trial, and no trial sees what another left in its process."""

import importlib
import os
import sys

import pytest

from bench import runner
from bench.plan import Trial
from bench.studies import Limits

WORKERS = """
import os
import time

from bench import runner


def crash_on_the_first(trial, limits, environment, writer, log):
    runner._send_output_to(log)
    if trial.repeat == 0:
        os.abort()
    return runner.run_trial(trial, limits, environment, lambda progress: None)


def hang(trial, limits, environment, writer, log):
    time.sleep(60)


def raise_memory_error(trial, limits, environment, writer, log):
    raise MemoryError


def tell_parent():
    return os.getppid()
"""
SCENE = ("leaning_tower", "leaning_tower", {"levels": 2})


def trial(repeat: int) -> Trial:
    return Trial("bullet", "game", *SCENE, "none", 0, repeat)


class Silent:
    def started(self, trial) -> None: ...

    def progressed(self, trial, progress) -> None: ...

    def finished(self, trial, record) -> None: ...


@pytest.fixture(scope="module", autouse=True)
def server() -> None:
    """The harness is loaded once, by the server from which the trials are forked."""
    runner.get_ready([])


@pytest.fixture
def workers(tmp_path, monkeypatch):
    """Functions that stand in for a trial; in a module of their own, for the children to import."""
    (tmp_path / "misbehaving_workers.py").write_text(WORKERS)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("misbehaving_workers")
    del sys.modules["misbehaving_workers"]


def records(*trials: Trial, limits: Limits | None = None):
    outcomes = runner.run_trials(trials, limits or Limits(), "abc", 1, Silent())
    return [outcome.record for outcome in outcomes]


def test_a_crash_costs_one_trial_and_its_last_words_are_kept(monkeypatch, workers) -> None:
    monkeypatch.setattr(runner, "_run_in_child", workers.crash_on_the_first)
    crashed, sound = records(trial(0), trial(1))
    assert (crashed.status, crashed.verdict) == ("crashed", "failed")
    assert crashed.message == "the process died of SIGABRT: Fatal Python error: Aborted"
    assert sound.status == "completed"
    assert sound.height_levels == 2


def test_a_hang_is_ended_and_censored(monkeypatch, workers) -> None:
    monkeypatch.setattr(runner, "_run_in_child", workers.hang)
    monkeypatch.setattr(runner, "GRACE_S", 1.0)
    [hung] = records(trial(0), limits=Limits(trial_wall_s=0.5))
    assert (hung.status, hung.height_levels) == ("timeout", 0)
    assert "hung" in hung.message


def test_want_of_memory_is_an_outcome(monkeypatch, workers) -> None:
    monkeypatch.setattr(runner, "_run_in_child", workers.raise_memory_error)
    [starved] = records(trial(0))
    assert starved.status == "out_of_memory"


def test_a_trial_is_no_fork_of_this_process(workers) -> None:
    """Forks would share the engines that this process has imported."""
    assert runner._in_process(workers.tell_parent, 60)().result() != os.getpid()


@pytest.mark.parametrize("engine", ["pymunk"])
def test_a_planar_engine_says_why_it_does_not_play_a_scene_in_space(engine: str) -> None:
    [refused] = records(Trial(engine, "game", "four_stack", "four_stack-2", {"levels": 2}, "none", 0, 0))
    assert (refused.status, refused.verdict) == ("unsupported", "none")
    assert refused.message == "pymunk is a planar engine and four_stack-2 is not a planar scene"
