"""How long a plan takes: what is estimated, from what, and how it compares with runs that were timed."""

import json
from pathlib import Path

import pytest

from bench.execution.estimate import LEAST_S, RUN_S, START_MS, START_S, estimate
from bench.execution.past_trials import past_trials
from bench.machine.source_digest import PUBLISHED
from bench.studies.plan import later_trials, plan_trials
from bench.studies.schema import check_study, load_study

TIMED = json.loads((Path(__file__).parents[2] / "fixtures" / "run_times.json").read_text(encoding="utf-8"))
"""Runs of three studies: the machine's speed just before each, and how long its trials took."""
STUDY = check_study(
    {
        "name": "test",
        "engines": ["bullet", "mujoco"],
        "policies": ["none"],
        "seeds": 2,
        "scenario": [{"name": "leaning_tower"}],
    },
    "test",
)
TRIALS = plan_trials(STUDY)


def write(folder, *records: dict[str, object]) -> None:
    folder.mkdir()
    usual = {"engine": "bullet", "scene": "leaning_tower", "profile": "game", "policy": "none"}
    lines = [json.dumps(usual | record) for record in records]
    (folder / "trials.jsonl").write_text("\n".join(lines) + '\n{"torn')


def test_the_same_trials_count_most_then_others_of_their_engine_and_scene(tmp_path) -> None:
    write(tmp_path / "a", {"trial": TRIALS[0].id, "wall_s": 10.0}, {"trial": "other", "wall_s": 40.0})
    write(tmp_path / "b", {"trial": TRIALS[0].id, "wall_s": 20.0}, {"trial": "lost", "wall_s": None})
    write(tmp_path / "c", {"trial": "x", "engine": "dart", "scene": "y", "wall_s": 99.0})
    estimated = estimate(TRIALS, 60.0, [tmp_path / name for name in "abc"])
    assert (estimated.same, estimated.similar, estimated.guessed, estimated.unknown) == (1, 1, 0, 2)
    assert estimated.known_s == pytest.approx(15.0 + 20.0 + 2 * START_S)  # the median of two, and that of three
    assert estimated.folders == [tmp_path / "a", tmp_path / "b"]
    assert estimated.summary(jobs=1) == (
        f"4 trials: about {RUN_S + estimated.known_s:.0f} s (1 from the same trials, 1 from other trials of their "
        f"engine and scene, in {tmp_path}/a, {tmp_path}/b), and at most 2.0 min for 2 unknown trials"
    )


def test_other_policies_of_a_kind_stand_for_each_other_before_those_of_the_other_kind(tmp_path) -> None:
    alone = {"policy": "native", "wall_s": 10.0}
    steered = [{"trial": f"p{k}", "policy": "paper", "wall_s": 30.0} for k in range(3)]
    write(tmp_path / "a", {"trial": "n", **alone}, *steered)
    assert estimate(TRIALS[:1], 60.0, [tmp_path / "a"]).known_s == pytest.approx(10.0 + START_S)


def test_other_scenes_count_by_levels_and_simulated_seconds(tmp_path) -> None:
    """30 levels for 10 s in 30 s of wall time are 0.1 s a level and second; the tower has 13 levels and 17 s."""
    work = {"scene": "four_stack", "levels_planned": 30, "simulated_s": 10.0, "wall_s": 30.0}
    write(tmp_path / "a", {"trial": "x", **work})
    estimated = estimate(TRIALS, 60.0, [tmp_path / "a"])
    assert (estimated.guessed, estimated.unknown) == (4, 0), "of another engine, if there is none of its own"
    assert estimated.known_s == pytest.approx(4 * (0.1 * 13 * 17 + START_S))
    assert "4 from other scenes or engines" in estimated.summary(jobs=1)
    quick = {**work, "wall_s": 1e-6}
    write(tmp_path / "b", {"trial": "x", **quick})
    assert estimate(TRIALS, 60.0, [tmp_path / "b"]).known_s == pytest.approx(4 * (LEAST_S + START_S))


def test_times_are_scaled_to_this_machine_and_to_its_load(tmp_path) -> None:
    """The fixed calculation took 0.25 ms then and takes 0.5 ms now; the process gets half a core."""
    write(tmp_path / "a", {"trial": TRIALS[0].id, "wall_s": 10.0, "calibration_ms": 0.25})
    estimated = estimate(TRIALS[:1], 60.0, [tmp_path / "a"], calibration_ms=0.5, busy=2.0)
    assert estimated.known_s == pytest.approx(2 * (20.0 + START_S * 0.5 / START_MS))


def test_a_trial_is_stopped_at_its_limit_and_jobs_share_the_time(tmp_path) -> None:
    write(tmp_path / "a", {"trial": TRIALS[0].id, "wall_s": 300.0})
    estimated = estimate(TRIALS[:1], 100.0, [tmp_path / "a"], busy=3.0)
    assert estimated.known_s == pytest.approx(100.0 + 3 * START_S)
    assert f"about {RUN_S + estimated.known_s / 2:.0f} s" in estimated.summary(jobs=2)


def test_without_earlier_trials_only_the_limit_is_known(tmp_path) -> None:
    estimated = estimate(TRIALS, 60.0, [tmp_path])
    assert estimated.summary(jobs=1) == "4 trials: at most 4.0 min; there are no earlier trials to estimate from"


def test_trials_that_follow_by_bisection_are_counted() -> None:
    study = load_study("thresholds")
    bisected = len(plan_trials(study)) // 2
    assert len(later_trials(study)) > 4 * bisected
    assert {trial.parameters.get("friction") for trial in later_trials(study)} >= {0.375}


def test_published_trials_have_wall_times_and_calibrations() -> None:
    """Trials that were run before the calibration was recorded take the typical one of their folder."""
    paper = past_trials(PUBLISHED / "paper")
    assert len(paper) == 84
    assert all(trial.calibration_ms is not None for trial in paper)
    refused = [trial for trial in paper if trial.wall_s == 0.0]
    assert {(trial.engine, trial.scene) for trial in refused} == {("pymunk", "four_stack")}, "no planar scene"
    assert all(trial.level_s > 0 for trial in paper if trial not in refused)


@pytest.mark.parametrize("name", TIMED)
def test_the_published_trials_estimate_a_run_within_a_factor_of_two(name: str) -> None:
    """Nothing but what is published is known, and the speed of the machine when the run began."""
    run, study = TIMED[name], load_study(name)
    folders = sorted(path.parent for path in PUBLISHED.glob("*/trials.parquet"))
    speed = {"calibration_ms": run["calibration_ms"], "busy": run["busy"]}
    expected = estimate(plan_trials(study), study.limits.trial_wall_s, folders, **speed)
    assert expected.unknown == 0
    assert 0.5 < (RUN_S + expected.known_s) / run["seconds"] < 2.0
