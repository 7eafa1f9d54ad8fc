"""A bisected parameter in a study: which trials follow from which, and errors that name the fix."""

import math
from collections.abc import Callable

import pytest

from bench.execution.results import Results, missing_trials
from bench.studies.plan import Trial, later_trials, next_trials, plan_trials, waiting_trials
from bench.studies.schema import StudyError, check_study, load_study
from bench.studies.toml_text import to_toml
from bench.trial.run_trial import Outcome, bare_record
from reports.records.folder import ResultsFolder
from reports.records.trial import Status
from reports.statistics.thresholds import thresholds_of
from reports.tables.thresholds import threshold_tables

CONTENT = {
    "name": "test",
    "engines": ["bullet", "mujoco"],
    "policies": ["none"],
    "scenario": [
        {
            "name": "slope",
            "parameters": {"theta": [10.0, 20.0]},
            "bisect": {"parameter": "friction", "low": 0.1, "high": 0.5, "tolerance": 0.01},
        },
        {"name": "leaning_tower"},
    ],
}
STUDY = check_study(CONTENT, "test")


def played(end: Callable[[Trial], Status]) -> dict[str, Status]:
    """Run the study with trials whose ends are prescribed; every round runs what can be run."""
    statuses: dict[str, Status] = {}
    while waiting := waiting_trials(STUDY, statuses):
        statuses |= {trial.id: end(trial) for trial in waiting}
    return statuses


def by_friction(trial: Trial) -> Status:
    """MuJoCo needs a tenth more friction than theory."""
    needed = math.tan(math.radians(trial.parameters.get("theta", 0.0))) * (1.1 if trial.engine == "mujoco" else 1.0)
    return "completed" if trial.scenario != "slope" or trial.parameters["friction"] >= needed else "collapsed"


def test_both_ends_are_known_beforehand_and_the_middle_follows() -> None:
    first = plan_trials(STUDY)
    ends = [trial.parameters["friction"] for trial in first if trial.scenario == "slope"]
    assert sorted(set(ends)) == [0.1, 0.5]
    assert len(ends) == 2 * 2 * 2
    assert {trial.id for trial in next_trials(STUDY, {})} <= {trial.id for trial in first}
    statuses = {trial.id: by_friction(trial) for trial in first}
    following = next_trials(STUDY, statuses)
    assert {trial.parameters["friction"] for trial in following} == {0.3}
    assert {(trial.engine, trial.parameters["theta"]) for trial in following} == {
        (engine, theta) for engine in ("bullet", "mujoco") for theta in (10.0, 20.0)
    }


def test_a_bisection_ends_within_the_announced_number_of_trials() -> None:
    statuses = played(by_friction)
    assert len(statuses) <= len(plan_trials(STUDY)) + len(later_trials(STUDY)) == 2 + 4 * 8
    assert next_trials(STUDY, statuses) == []


def test_an_end_without_an_answer_ends_the_bisection() -> None:
    statuses = played(lambda trial: "crashed" if trial.engine == "mujoco" else by_friction(trial))
    tried = [name for name in statuses if name.startswith("mujoco") and "slope" in name]
    assert len(tried) == 4, "both ends of both slopes, and nothing between"


@pytest.fixture
def folder(tmp_path):
    """A results folder of the study, cut off after its first round and gone on with."""
    environment = {"commit": "c0ffee", "engines": {}}
    for rounds in (1, 99):
        results = Results(tmp_path, STUDY, environment)
        while rounds and (waiting := waiting_trials(STUDY, results.statuses)):
            for trial in waiting:
                record = bare_record(trial, trial.planned_scene(), "abc", by_friction(trial), "")
                results.keep(Outcome(record.model_copy(update={"levels_placed": 1}), []))
            rounds -= 1
        results.close()
        if rounds == 0:
            assert len(missing_trials(tmp_path, ResultsFolder(tmp_path).records)) == 4
    return ResultsFolder(tmp_path)


def test_a_run_that_was_cut_off_goes_on_and_reports_its_thresholds(folder) -> None:
    assert missing_trials(folder.path, folder.records) == []
    ids = [record.trial for record in folder.records]
    assert len(set(ids)) == len(ids), "no trial is run twice"
    found = {(one.scene, one.engine): one for one in thresholds_of(folder.records, folder.study)}
    for theta in (10.0, 20.0):
        exact = math.tan(math.radians(theta))
        for engine, factor in (("bullet", 1.0), ("mujoco", 1.1)):
            one = found[f"slope, theta {theta}", engine]
            assert one.whole is not None
            assert one.whole.low <= factor * exact <= one.whole.high
            assert one.exact == pytest.approx((exact, exact), abs=3e-4)
    (table,) = threshold_tables(folder.records, folder.study)
    shares = {row[:3:2]: row[-1] for row in table.rows}
    assert shares["slope, theta 20.0", "mujoco"].startswith("110.")


def test_what_does_not_change_between_the_ends_gets_no_number(tmp_path) -> None:
    records = [
        bare_record(trial, trial.planned_scene(), "abc", "completed", "")
        for trial in plan_trials(STUDY)
        if trial.scenario == "slope"
    ]
    for one in thresholds_of(records, STUDY.model_dump(exclude_none=True)):
        assert one.whole is None
        assert one.why == "stands from 0.1 to 0.5"


def test_the_resolved_study_reads_back_as_it_was(tmp_path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(to_toml(STUDY), encoding="utf-8")
    assert load_study(str(file)) == STUDY


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"parameter": "frction"}, "unknown parameter of slope 'frction'; did you mean 'friction'?"),
        ({"parameter": "theta"}, "parameter 'theta' must not be in 'parameters', because 'bisect' varies it"),
        ({"low": -1.0}, "friction must be a number from 0 to 2, got -1.0"),
        ({"low": 0.495}, "'high' must exceed 'low' by two tolerances or more, got 0.495 to"),
        ({"tolerance": 0.0}, "field 'scenario[0].bisect.tolerance': must be above 0"),
        ({"tolerence": 0.1}, "unknown field 'tolerence'; did you mean 'tolerance'?"),
    ],
)
def test_a_bisection_that_cannot_be_run_names_the_fix(change: dict[str, object], complaint: str) -> None:
    first = CONTENT["scenario"][0]
    content = CONTENT | {"scenario": [first | {"bisect": first["bisect"] | change}]}
    with pytest.raises(StudyError) as error:
        check_study(content, "my.toml")
    assert complaint in str(error.value)
