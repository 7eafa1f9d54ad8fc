"""Known faults of engines: the file, and the rows that it flags."""

from pathlib import Path

import pytest

from adapters import ENGINES
from bench.studies.policies import BENCH_POLICIES
from reports.statistics.groups import groups_of
from reports.statistics.known_faults import KnownFaultsError, faults_of, known_faults
from reports.statistics.states import STATES
from scenarios.registry import build
from tests.reports.studies import fallen, record

GOOD = """[[fault]]
engine = "bullet"
thread = "a/b#1"
kind = "issue"
symptoms = ["creeps"]
sentence = "it creeps"
"""


def flags(*records) -> list[str]:
    (group,) = groups_of(records)
    return [fault.thread for fault in faults_of(group)]


def creeping(**fields):
    return record(**{"engine": "mujoco", "engine_version": "4.0.0", "verdict": "creeps", **fields})


@pytest.mark.parametrize("fault", known_faults(), ids=lambda fault: f"{fault.engine} {fault.thread}")
def test_every_fault_is_of_an_engine_and_of_scenes_and_policies_that_exist(fault) -> None:
    assert fault.engine in ENGINES
    assert set(fault.policies) <= set(BENCH_POLICIES)
    assert set(fault.symptoms) - {"sinks"} <= set(STATES)
    for scene in fault.scenes:
        conditions = dict(scene)
        assert set(conditions) <= {"scenario", *build(**{"name": conditions.pop("scenario"), **conditions}).parameters}
    repository, number = fault.thread.split("#")
    assert fault.url in (f"https://github.com/{repository}/{kind}/{number}" for kind in ("issues", "pull"))
    assert not fault.sentence.endswith("."), "the page ends the sentence"


def test_a_row_is_flagged_that_shows_the_symptom_on_the_engine() -> None:
    assert flags(creeping()) == ["google-deepmind/mujoco#3328"]
    assert flags(creeping(), creeping(seed=1, verdict="right")) == ["google-deepmind/mujoco#3328"]
    assert flags(creeping(verdict="right")) == []
    assert flags(creeping(engine="rapier")) == []


def test_a_fault_of_some_versions_flags_these_alone() -> None:
    def thrown(version: str) -> list[str]:
        return flags(fallen(3, engine="mujoco", engine_version=version))

    assert thrown("3.10.0") == thrown("3.11.0") == ["google-deepmind/mujoco#3476"]
    assert thrown("3.9.0") == thrown("3.11.1") == thrown("4.0.0") == []
    assert thrown("built here") == [], "a version without numbers is in no range"


def test_a_fault_of_some_scenes_and_policies_flags_these_alone() -> None:
    heavy = {"engine": "jolt", "scene": "heavy_top"}
    assert flags(fallen(2, **heavy, parameters={"ratio": 100.0})) == ["jrouwe/JoltPhysics#1390"]
    assert flags(fallen(2, **heavy, parameters={"ratio": 3.0})) == []
    assert flags(fallen(2, engine="jolt", parameters={"ratio": 100.0})) == []
    sunk = fallen(2, **heavy, parameters={"ratio": 10.0}, collapse_kind="sink", verdict="failed")
    assert flags(sunk) == ["jrouwe/JoltPhysics#1390"]
    floats = {"scene": "robbed_stack", "verdict": "false_stand"}
    assert flags(record(**floats, policy="native")) == ["facebookresearch/habitat-sim#801"]
    assert flags(record(**floats, policy="at_rest")) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('"a/b#1"', '"a/b/1"'), "fault 1: field 'thread': .*, got 'a/b/1'; correct this entry"),
        (('["creeps"]', '["crawls"]'), "symptoms.0': .*'false_stand', 'false_collapse', 'creeps'"),
        (('["creeps"]', "[]"), "symptoms"),
        (("sentence", "words"), "sentence"),
        (("engine", 'last = "new"\nengine'), "must begin with a number, got 'new'; write a version such as 3.10.0"),
        (("engine", "scenes = [{ ratio = 2.0 }]\nengine"), "'scenes', entry 1: a scene needs its scenario"),
    ],
)
def test_an_entry_that_is_not_valid_is_named_with_its_fix(tmp_path: Path, change, said) -> None:
    (tmp_path / "faults.toml").write_text(GOOD.replace(*change))
    with pytest.raises(KnownFaultsError, match=said):
        known_faults(tmp_path / "faults.toml")


def test_a_valid_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "faults.toml").write_text(GOOD)
    (fault,) = known_faults(tmp_path / "faults.toml")
    assert (fault.name, fault.url) == ("b#1", "https://github.com/a/b/issues/1")
