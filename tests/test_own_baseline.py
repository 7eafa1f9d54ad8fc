"""The baseline that CI holds the suite's own outcomes against is of the study that CI runs."""

from __future__ import annotations

from pathlib import Path

from bench.compare.baseline import read_baseline
from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from scenarios.registry import with_defaults

ROOT = Path(__file__).parent.parent


def test_the_baseline_holds_every_trial_of_the_study_from_a_clean_commit():
    baseline = read_baseline(ROOT / "tests" / "baseline" / "ci.json")
    planned = plan_trials(load_study("ci"))
    assert [record.trial for record in baseline.trials] == [trial.id for trial in planned]
    for record, trial in zip(baseline.trials, planned, strict=True):
        scene = trial.build_scene()  # another one under the same name would be "not decided" for ever
        parameters = with_defaults(record.scenario, record.parameters)
        assert (parameters, record.expectation) == (scene.parameters, scene.expectation)
    assert not any(baseline.is_limited(record) for record in baseline.trials)
    assert not any(machine.modified for machine in baseline.machines.values())


def test_ci_runs_that_study_and_compares_it():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "bench run ci" in script
    assert "bench compare tests/baseline/ci.json" in script
