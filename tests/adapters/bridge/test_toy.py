"""The engine of the tutorial keeps the contract, registered as an engine outside the repository is."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from adapters import ENGINES, capabilities, open_engine, register_command
from adapters.bridge.external import ExternalEntry
from adapters.conformance import CHECKS, Check
from adapters.conformance.rig import GRAVITY, MASS, THICKNESS, advance, plank
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial

ROOT = Path(__file__).parents[3]
TOY = ROOT / "docs" / "toy_engine"
COMMAND = (sys.executable, "-IS", str(TOY / "toy.py"))
QUICK = ("falls_freely", "carries_each_level", "freezes_in_flight", "finds_the_contacts_of_a_tower")
"""Checks that take all messages; the others run by hand, as those of other engines' rarer profiles."""
EVERY_CHECK = [
    pytest.param(check, id=check.name, marks=[] if check.name in QUICK else pytest.mark.full) for check in CHECKS
]


@pytest.fixture(autouse=True)
def toy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ENGINES, "toy", ExternalEntry("toy", COMMAND, TOY, TOY / "toy.toml"))


@pytest.mark.parametrize("check", EVERY_CHECK)
def test_the_toy_engine_keeps_the_contract(check: Check) -> None:
    if not check.applies("toy", "game"):
        pytest.skip("not asked of this engine under this profile")
    check.run("toy", "game")


def test_a_trial_records_the_time_of_the_engine_and_of_the_bridge() -> None:
    trial = Trial("toy", "game", "leaning_tower", "leaning_tower-2", {"levels": 2}, "paper", 0, 0)
    outcome = run_trial(trial, Limits(trial_wall_s=60), "abc", lambda _: None)
    record = outcome.record
    assert record.status == "completed"
    assert record.engine_version == "1.0"
    assert record.engine_ms is not None
    assert record.bridge_ms is not None
    assert record.engine_ms > 0
    assert record.bridge_ms > 0
    row = outcome.frames[-1]
    assert row.frame_ms == pytest.approx(row.engine_ms + row.readback_ms + row.core_ms + row.port_ms)


def test_a_pushed_brick_has_its_velocity_before_the_message_is_sent() -> None:
    simulation = open_engine("toy", "game")
    body = simulation.spawn(plank(z=1.0))
    simulation.push(body, (MASS, 0.0, 0.0))
    assert simulation.velocities()[0].tolist() == [[1.0, 0.0, 0.0]]
    advance(simulation, 0.1)
    assert simulation.velocities()[0][0] == pytest.approx([1.0, 0.0, -0.1 * GRAVITY])
    simulation.close()


def test_forces_are_means_over_the_substeps_of_a_frame() -> None:
    """Of a brick that lands in one of the four substeps, the mean force is its change of momentum over the frame."""
    simulation = open_engine("toy", "game")
    _ = simulation.port
    simulation.spawn(plank(z=THICKNESS / 2 + 0.5e-3))
    before = 0.0
    for _ in range(3):
        simulation.step(simulation.info.frame_s)
        (velocity,), contacts = simulation.velocities()[0], simulation.port.contacts()
        gained = MASS * (velocity[2] - before) / simulation.info.frame_s + MASS * GRAVITY
        assert contacts.force is not None
        assert np.abs(contacts.force[:, 2]).sum() == pytest.approx(gained, abs=1e-9)
        before = velocity[2]
    assert gained == pytest.approx(MASS * GRAVITY, rel=0.05)
    simulation.close()


def test_more_bodies_than_there_is_room_for_at_first() -> None:
    simulation = open_engine("toy", "game")
    bodies = [simulation.spawn(plank(x=0.2 * i)) for i in range(70)]
    simulation.port.sleep(bodies[1:])
    simulation.step(simulation.info.frame_s)
    assert simulation.poses()[1][:, 0].tolist() == pytest.approx([0.2 * i for i in range(70)])
    simulation.close()


def test_an_engine_is_named_as_it_names_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(ENGINES, "toy")
    assert register_command(COMMAND, None) == "toy"
    assert capabilities("toy").planar


@pytest.mark.slow
def test_a_study_plays_an_engine_of_a_file(tmp_path: Path) -> None:
    """The command line, and the processes of its trials, know it."""
    file = tmp_path / "engines.toml"
    file.write_text(f"[my_toy]\ncommand = {list(COMMAND)}\nprofiles = '{TOY / 'toy.toml'}'\n")
    study = tmp_path / "study.toml"
    study.write_text(
        "name = 'one'\ndescription = 'one trial'\nengines = ['my_toy']\nprofiles = ['game']\npolicies = ['none']\n"
        "[[scenario]]\nname = 'plank_tower'\nparameters = { levels = 1 }\n"
    )
    command = [sys.executable, "-m", "bench", "run", str(study), "--out", str(tmp_path / "out")]
    done = subprocess.run(
        command, cwd=ROOT, env=os.environ | {"STILLSTACK_ENGINES": str(file)}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert '"engine":"my_toy"' in (tmp_path / "out" / "trials.jsonl").read_text().replace(": ", ":")
