"""The table of public threads."""

from bench.studies.schema import load_study
from reports.tables.threads import measured, thread_tables
from scenarios.model import Expectation
from scenarios.registry import build
from scenarios.scenes.from_file import EXAMPLES
from scenarios.threads import thread_of, threads
from tests.reports.studies import STANDS, failed, fallen, record

FLAX = {
    "scene": "own_scene-flax",
    "parameters": {"file": "issue_flax_15_60.toml", "size": 1.0, "mass": 1.0, "yaw": 0.0},
}
BULLET = {"scene": "own_scene-cube", "parameters": {"file": "issue_bullet3_3049.toml"}}
TIPS = Expectation("fall", "statics", 2)


def test_every_thread_has_its_scene_and_every_scene_its_answer_by_the_judge():
    for stem, thread in threads().items():
        scene = build("own_scene", file=f"{stem}.toml")
        assert scene.expectation.outcome in ("stand", "fall")
        assert "exact statics" in scene.expectation.theory
        repository, number = thread.name.split("#")
        assert f"https://github.com/{repository}/" in thread.url
        assert thread.url.endswith(f"/{number}")
        assert (EXAMPLES / f"{stem}.toml").exists()


def test_the_study_plays_every_thread():
    (chosen,) = load_study("issues").scenario
    assert sorted(chosen.parameters["file"]) == sorted(f"{stem}.toml" for stem in threads())


def test_a_scene_that_was_changed_is_of_no_thread():
    assert thread_of(FLAX["parameters"]) is not None
    assert thread_of({**FLAX["parameters"], "size": 3.0}) is None
    assert thread_of({"file": "lintel.toml"}) is None
    assert thread_of({}) is None
    assert thread_tables([record()]) == []


def test_a_row_a_thread_with_what_was_reported_measured_and_is_exact():
    creeps = record(**BULLET, verdict="creeps", creep_m_s=7.2e-6, creep_error_m_s=1e-7)
    tips = fallen(2, **FLAX, expectation=TIPS, verdict="right", collapse_s=2.34)
    stands = record(**FLAX, engine="rapier", expectation=TIPS, verdict="false_stand")
    (table,) = thread_tables([creeps, tips, stands, record(**BULLET, seed=1), record(**BULLET, policy="equilibrium")])
    assert table.header == ("thread", "scene", "policy", "reported", "exact", "bullet", "rapier")
    thread = ("bulletphysics/bullet3#3049", "issue_bullet3_3049")
    assert table.rows == (
        (*thread, "none", "creeps by 0.25 m in 10 h, 7 µm/s", str(STANDS), "creeps 7.2 µm/s ✗", "-"),
        (*thread, "equilibrium", "creeps by 0.25 m in 10 h, 7 µm/s", str(STANDS), "stands ✓", "-"),
        (
            "FlaxEngine/FlaxEngine#15",
            "issue_flax_15_60",
            "none",
            "slides off",
            str(TIPS),
            "falls at 2.3 s ✓",
            "stands ✗",
        ),
    )


def test_what_did_not_come_to_its_end_is_no_answer():
    assert measured(failed("timeout")) == "timed out"
    assert measured(failed("unsupported")) == "n/a"
    assert measured(failed("crashed")) == "crashed ✗"
    assert measured(None) == "-"


def test_no_engine_is_blamed_for_a_stack_in_neutral_balance():
    lost = {"scene": "own_scene-ice", "parameters": {"file": "issue_mujoco_366_mu0.toml"}, "collapse_s": 0.5}
    assert measured(fallen(2, **lost, verdict="none")) == "falls at 0.5 s"
