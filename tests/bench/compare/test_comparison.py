"""What can be compared is; the rest is message, and is neither a regression nor a pass."""

import json
from pathlib import Path

import pytest

from bench.compare.baseline import read_baseline
from bench.compare.comparison import NothingInCommonError, compare_runs
from bench.compare.failures import SideFailedError
from bench.compare.findings import GATES, Finding
from bench.compare.render import headline, tables
from bench.studies.tolerance import Tolerance

NAMES = ("base", "head")
FELL = {"status": "collapsed", "height_levels": 2, "collapse_level": 3, "verdict": "false_collapse", "pose_hash": "bb"}
ELSEWHERE = "bullet.game.four_stack-4.paper.s0.r0"


def only(base, head, gate="outcome", **options) -> Finding:
    """The one finding of a gate."""
    (finding,) = [one for one in compare_runs(base, head, NAMES, **options).findings if one.gate == gate]
    return finding


def test_a_regression_alarms_both_gates(make) -> None:
    found = compare_runs(make.side(), make.side(make.record(**FELL)), NAMES)
    assert [(alarm.gate, alarm.judgement) for alarm in found.alarms()] == [("outcome", "worse"), ("hash", "changed")]
    assert [alarm.gate for alarm in found.alarms(["hash"])] == ["hash"]
    assert not compare_runs(make.side(), make.side(), NAMES).alarms()


def test_missing_and_new_trials_are_reported(make) -> None:
    both, other = make.record(), make.record(trial=ELSEWHERE, scene="four_stack-4")
    for base, head, message in (
        (make.side(both, other), make.side(both), "missing in head"),
        (make.side(both), make.side(both, other), "new: not in base"),
    ):
        found = compare_runs(base, head, NAMES)
        assert Finding("outcome", ELSEWHERE, "open", message) in found.findings
        assert not found.alarms()


def test_runs_of_other_trials_are_refused(make) -> None:
    with pytest.raises(NothingInCommonError, match="no trial in common"):
        compare_runs(make.side(), make.side(make.record(trial=ELSEWHERE)), NAMES)


def test_another_version_of_the_engine_is_reported_and_judged_only_if_asked_for(make) -> None:
    head = make.side(make.record(engine_version="2.0", **FELL))
    found = only(make.side(), head)
    assert (found.judgement, found.message[:24]) == ("open", "bullet 2.0, was 1.0 (--a")
    assert only(make.side(), head, across_versions=True).judgement == "worse"
    assert only(make.side(), head, "hash", across_versions=True).judgement == "open"


@pytest.mark.parametrize(
    "change",
    [
        {"parameters": {"levels": 3, "gap": 1}},
        {"levels_planned": 4},
        {"expectation": {"outcome": "study", "theory": "open"}},
    ],
)
def test_another_scene_under_the_same_name_is_reported(make, change) -> None:
    assert only(make.side(), make.side(make.record(**FELL | change))).message == "another scene under the same name"


def test_poses_of_other_versions_are_compared_only_on_request(make) -> None:
    base, head = make.side(), make.side(make.record(engine_version="2.0", pose_hash="bb"))
    assert only(base, head, "hash", across_versions=True).judgement == "open"
    assert only(base, head, "hash", poses=True).judgement == "changed"
    same = make.side(make.record(engine_version="2.0"))
    assert only(base, same, "hash", poses=True).judgement == "same"


def test_missing_trials_are_alarms_on_request_and_always_counted(make) -> None:
    base = make.side(make.record(), make.record(trial=ELSEWHERE, scene="four_stack-4"))
    assert not compare_runs(base, make.side(), NAMES).alarms()
    assert "1 of 2 trials are missing" in headline(compare_runs(base, make.side(), NAMES), GATES)
    (alarm,) = compare_runs(base, make.side(), NAMES, require_all=True).alarms()
    assert (alarm.trial, alarm.judgement) == (ELSEWHERE, "worse")


def test_a_side_that_failed_is_never_a_base_to_be_better_than(make) -> None:
    broken = {"status": "error", "message": "no such knob", "verdict": "failed"}
    for sides in ((make.side(make.record(**broken)), make.side()), (make.side(), make.side(make.record(**broken)))):
        with pytest.raises(SideFailedError, match=r"the only trial has no result.*no such knob"):
            compare_runs(*sides, NAMES)
    other = make.record(engine="dart", trial="dart.game.four_stack-3.paper.s0.r0")
    base = make.side(make.record(), other.model_copy(update=broken))
    found = compare_runs(base, make.side(make.record(), other), NAMES)
    assert not [one for one in found.findings if one.judgement == "better"]
    assert [one.message for one in found.findings if one.trial == "dart"] == [
        "in base none of the 1 trials has a result; the first failure: error: no such knob"
    ]


def test_equal_findings_of_repeats_share_a_row_with_the_values_of_both_sides(make) -> None:
    def side(**change):
        name = make.name.removesuffix("0")
        return make.side(*(make.record(**{"trial": f"{name}{k}", "repeat": k, **change}) for k in range(3)))

    (worse,) = [one for one in tables(compare_runs(side(), side(**FELL), NAMES), GATES) if one.title[:5] == "Worse"]
    outcome = [row for row in worse.rows if row[0] == "outcome"]
    assert worse.header == ("gate", "trial", "what", "base", "head")
    assert [row[1] for row in outcome] == [f"{make.name.removesuffix('.r0')} (x3)"]
    assert outcome[0][3].startswith("right, 3 of 3 levels")
    assert outcome[0][4].startswith("false_collapse, 2 of 3 levels, falls at 3")


def test_a_parameter_that_did_not_exist_had_its_default(make) -> None:
    """Records of before the 4-stack had a gap to choose."""
    head = make.side(make.record(**FELL, parameters={"levels": 3, "gap": 2.0}))
    assert only(make.side(), head).judgement == "worse"


def test_what_the_clock_ended_is_not_judged(make) -> None:
    """Nor is a stack that was still falling when its time was up."""
    late = make.record(**FELL, wall_s=60.0)
    for slow in (make.record(status="timeout", height_levels=1, verdict="undecided"), late):
        for sides in ((make.side(), make.side(slow)), (make.side(slow), make.side())):
            found = compare_runs(*sides, NAMES)
            assert [one.judgement for one in found.findings] == ["open"]
            assert "stopped by its time limit" in found.findings[0].message
    assert only(make.side(), make.side(make.record(**FELL, wall_s=59.0))).judgement == "worse"


def test_on_another_processor_only_outcomes_are_judged(make) -> None:
    other = make.machine.model_copy(update={"processor": "P2"})
    times = {make.name: parts(core=0.5)}
    head = make.side(make.record(**FELL), machines={"here": other}, shares={make.name: parts(core=5.0)})
    found = compare_runs(make.side(shares=times), head, NAMES)
    judged = {one.gate: one.judgement for one in found.findings}
    assert judged == {"outcome": "worse", "hash": "open", "time": "open"}
    assert "processor: P2, was P1" in found.notes


def test_without_a_description_of_the_machine_nothing_is_known_to_repeat_itself(make) -> None:
    found = compare_runs(make.side(machines={}), make.side(make.record(**FELL), machines={}), NAMES)
    assert [(one.gate, one.judgement) for one in found.findings] == [("outcome", "open")]


def test_an_engine_that_does_not_repeat_itself_is_judged_by_groups_and_never_by_its_poses(make) -> None:
    def side(**change):
        name = "dart.game.four_stack-3.none.s0.r"
        return make.side(
            *(make.record(engine="dart", trial=f"{name}{k}", repeat=k, **change) for k in range(5)),
        )

    found = compare_runs(side(), side(**FELL), NAMES)
    assert [(one.gate, one.trial, one.judgement) for one in found.findings] == [
        ("outcome", "dart.game.four_stack-3.none.s0", "worse")
    ]


def test_a_studys_tolerances_are_those_of_the_head(make) -> None:
    loose = {"four_stack": Tolerance(levels=1)}
    less = make.record(height_levels=2)
    assert only(make.side(), make.side(less, tolerances=loose)).judgement == "same"
    assert only(make.side(tolerances=loose), make.side(less)).judgement == "worse"


def parts(core: float, engine: float = 1.0) -> dict[str, float]:
    """Shares of a frame as a run keeps them, of an engine that takes ``engine`` times as long as it did."""
    return {"engine": 1.0, "readback": 0.3 / engine, "core": core / engine}


def timed(make, sources="of the base", pose_hash="aa", **times):
    """A run of four seeds with such times."""
    names = [f"bullet.game.four_stack-3.paper.s{seed}.r0" for seed in range(4)]
    return make.side(
        *(make.record(trial=name, seed=seed, pose_hash=pose_hash) for seed, name in enumerate(names)),
        machines={"here": make.machine.model_copy(update={"sources": sources})},
        shares={name: parts(**times) for name in names},
    )


def judged(base, head) -> dict[str, str]:
    """What the timing gate says of each part."""
    found = compare_runs(base, head, NAMES).findings
    return {one.trial.removeprefix("bullet.game."): one.judgement for one in found if one.gate == "time"}


def test_a_slower_core_is_found_against_the_engine_if_it_did_the_same(make) -> None:
    base = timed(make, core=0.5)
    other = judged(base, timed(make, "of the head", core=0.6))
    assert other == {"core / engine": "worse", "readback / engine": "same"}
    assert judged(base, timed(make, "of the head", core=0.6, pose_hash="bb")) == {"bullet.game": "open"}


def test_another_version_of_an_engine_is_no_reference_part_even_with_the_same_poses(make) -> None:
    """A faster release would make the core look slower."""
    base, head = timed(make, core=0.5), timed(make, "of the head", core=0.5, engine=0.5)
    newer = [record.model_copy(update={"engine_version": "99"}) for record in head.trials]
    found = compare_runs(base, head.model_copy(update={"trials": newer}), NAMES, poses=True).findings
    assert {one.judgement for one in found if one.gate == "hash"} == {"same"}
    assert [(one.trial, one.judgement) for one in found if one.gate == "time"] == [("bullet.game", "open")]


def test_a_slower_engine_is_found_against_the_core_if_that_is_the_same_code(make) -> None:
    """Another build of an engine may let bricks go another way; the core's typical frame costs the same."""
    base = timed(make, core=0.5)
    slower = {"engine / core": "worse", "readback / core": "same"}
    for pose_hash in ("aa", "bb"):
        assert judged(base, timed(make, core=0.5, engine=1.2, pose_hash=pose_hash)) == slower
    assert judged(base, base) == {"engine / core": "same", "readback / core": "same"}


def test_without_a_known_version_of_the_code_the_core_is_no_reference_part(make) -> None:
    assert set(judged(timed(make, None, core=0.5), timed(make, None, core=0.5))) == {
        "core / engine",
        "readback / engine",
    }


def test_a_baseline_of_format_1_is_converted_when_it_is_read() -> None:
    """Its trials that the time limit stopped were called failed."""
    path = Path(__file__).parents[2] / "fixtures" / "format_1" / "baseline.json"
    old = json.loads(path.read_text(encoding="utf-8"))["trials"]
    assert [(one["format"], one["verdict"]) for one in old] == [(1, "right"), (1, "failed")]
    baseline = read_baseline(path)
    assert [(one.format, one.verdict) for one in baseline.trials] == [(3, "right"), (3, "undecided")]
    found = [one for one in compare_runs(baseline, baseline, NAMES).findings if one.gate == "outcome"]
    assert sorted(one.judgement for one in found) == ["open", "same"]
