"""How long a plan takes: what is estimated, and from what."""

import json

from bench.execution.estimate import START_S, estimate
from bench.studies.plan import plan_trials
from bench.studies.schema import check_study

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
    lines = [json.dumps({"engine": "bullet", "scene": "leaning_tower"} | record) for record in records]
    (folder / "trials.jsonl").write_text("\n".join(lines) + '\n{"torn')


def test_the_same_trials_tell_most_then_others_of_their_engine_and_scene(tmp_path) -> None:
    write(tmp_path / "a", {"trial": TRIALS[0].id, "wall_s": 10.0}, {"trial": "other", "wall_s": 40.0})
    write(tmp_path / "b", {"trial": TRIALS[0].id, "wall_s": 20.0}, {"trial": "lost", "wall_s": None})
    write(tmp_path / "c", {"trial": "x", "engine": "dart", "wall_s": 99.0})
    estimated = estimate(TRIALS, 60.0, [tmp_path / name for name in "abc"])
    assert (estimated.same, estimated.similar, estimated.unknown) == (1, 1, 2)
    assert estimated.known_s == 15.0 + 20.0 + 2 * START_S  # the median of two, and that of three
    assert estimated.folders == [tmp_path / "a", tmp_path / "b"]
    assert estimated.summary(jobs=1) == (
        f"4 trials: about 35 s (1 from the same trials, 1 from others of their engine and scene, in {tmp_path}/a, "
        f"{tmp_path}/b), and at most 2.0 min for 2 unknown trials"
    )


def test_a_trial_is_stopped_at_its_limit_and_jobs_share_the_time(tmp_path) -> None:
    write(tmp_path / "a", {"trial": TRIALS[0].id, "wall_s": 300.0})
    estimated = estimate(TRIALS[:1], 100.0, [tmp_path / "a"])
    assert estimated.known_s == 100.0 + START_S
    assert "about 50 s" in estimated.summary(jobs=2)


def test_without_earlier_trials_only_the_limit_is_known(tmp_path) -> None:
    estimated = estimate(TRIALS, 60.0, [tmp_path])
    assert estimated.summary(jobs=1) == "4 trials: at most 4.0 min; there are no earlier trials to estimate from"
