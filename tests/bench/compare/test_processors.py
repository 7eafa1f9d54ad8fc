"""Pose hashes of several models of processor stand side by side in a baseline, and each is compared with its own."""

import numpy as np
import pytest
from typer.testing import CliRunner

from bench.cli.app import app
from bench.compare.baseline import read_baseline, write_baseline
from bench.compare.comparison import compare_runs
from bench.compare.findings import Finding
from bench.compare.renewal import renewed
from bench.compare.side import Baseline, BaselineError
from reports.records.pose_trace import PoseTracer, write_pose_trace

UPRIGHT = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture
def on(make):
    """Makes a run on a processor, of which the environment has the same name."""

    def on(processor: str, pose_hash: str, sources: str = "one", **changes: object) -> Baseline:
        machine = make.machine.model_copy(update={"processor": processor, "sources": sources})
        record = make.record(environment=processor, pose_hash=pose_hash, **changes)
        return make.side(record, machines={processor: machine})

    return on


def hash_finding(base: Baseline, head: Baseline) -> Finding:
    (finding,) = [one for one in compare_runs(base, head, ("base", "head")).findings if one.gate == "hash"]
    return finding


def test_hashes_of_both_processors_are_kept_and_each_is_compared_with_its_own(on, tmp_path) -> None:
    both = renewed(on("P2", "bb"), on("P1", "aa"))
    assert (both.kept, both.dropped) == ({"P1": 1}, {})
    write_baseline(both.baseline, tmp_path / "both.json")
    base = read_baseline(tmp_path / "both.json")
    for processor, pose_hash in (("P1", "aa"), ("P2", "bb")):
        assert hash_finding(base, on(processor, pose_hash)).judgement == "same"
        changed = hash_finding(base, on(processor, "cc"))
        assert (changed.judgement, changed.message) == ("changed", f"poses cc, were {pose_hash}, on {processor}")
    assert hash_finding(base, on("P3", "aa")).message == "on P3, was on P1, P2"


def test_a_comparison_names_only_the_processor_of_the_records(on) -> None:
    both = renewed(on("P2", "bb"), on("P1", "aa")).baseline
    assert "processor: P3, was P2" in compare_runs(both, on("P3", "aa"), ("base", "head")).notes


def test_a_third_processor_joins_and_the_first_renews_its_own(on) -> None:
    three = renewed(on("P3", "cc"), renewed(on("P2", "bb"), on("P1", "aa")).baseline).baseline
    again = renewed(on("P1", "aa", sources="other"), three)
    assert again.kept == {"P2": 1, "P3": 1}, "the poses here are those of before, so that the others still hold"
    assert sorted(again.baseline.pose_hashes(again.baseline.trials[0]).items()) == [
        ("P1", "aa"),
        ("P2", "bb"),
        ("P3", "cc"),
    ]


@pytest.mark.parametrize(
    ("new", "why"),
    [
        (("P1", "changed"), "poses changed on a processor that is known"),
        (("P3", "cc", "other"), "other sources, on a processor that is new"),
    ],
)
def test_hashes_that_may_no_longer_hold_are_dropped(on, new, why) -> None:
    both = renewed(on("P2", "bb"), on("P1", "aa")).baseline
    found = renewed(on(*new), both)
    assert not found.kept, why
    assert found.dropped["P2"] == 1
    assert not found.baseline.poses


def test_another_version_of_the_engine_drops_them(on) -> None:
    assert renewed(on("P2", "bb", engine_version="2.0"), on("P1", "aa")).dropped == {"P1": 1}


def traced(side: Baseline, folder, nudged: int = 10_000) -> Baseline:
    """The run with a trace: two bodies, of which the second is nudged by a bit from a frame on."""
    tracer = PoseTracer()
    for frame in range(100):
        position = np.array([[0.0, 0.0, 0.01], [0.0, 0.0, 0.02 - 1e-6 * frame]])
        if frame >= nudged:
            position[1, 2] = np.nextafter(position[1, 2], 1.0)
        tracer.see(np.array([0, 1]), position, np.tile(UPRIGHT, (2, 1)))
    folder.mkdir()
    path = folder / "t.parquet"
    write_pose_trace(path, tracer.finish())
    return side.with_trace_files({side.trials[0].pose_hash: path})


def test_the_first_frame_and_body_that_differ_are_named_with_both_values(on, tmp_path) -> None:
    base = traced(on("P1", "aa"), tmp_path / "base")
    head = traced(on("P1", "bb"), tmp_path / "head", nudged=37)
    value = 0.02 - 1e-6 * 37
    assert hash_finding(base, head).message == (
        f"poses bb, were aa; first in frame 37: body 1, z = {np.nextafter(value, 1.0):.17g} m, was {value:.17g} m"
    )


def test_a_baseline_file_names_frame_and_body_too(on, tmp_path) -> None:
    """And those of another processor, whose traces came with its hashes."""
    first = traced(on("P1", "aa"), tmp_path / "base")
    write_baseline(renewed(on("P2", "bb"), first).baseline, tmp_path / "base.json")
    head = traced(on("P1", "cc"), tmp_path / "head", nudged=37)
    message = hash_finding(read_baseline(tmp_path / "base.json"), head).message
    assert "first in frame 37: body 1, now at (0, 0, 0.019963) m" in message
    assert message.endswith("on P1")
    assert len(message) < 200, "the length at which a table cuts it"


def test_where_no_frame_of_the_traces_differs_their_length_is_named(on, tmp_path) -> None:
    base, head = traced(on("P1", "aa"), tmp_path / "base"), traced(on("P1", "bb"), tmp_path / "head")
    assert hash_finding(base, head).message == "poses bb, were aa; the first 100 frames are the same"


def test_a_trace_that_somebody_edited_is_an_error(on, make, tmp_path) -> None:
    base = on("P1", "aa").model_copy(update={"traces": {"aa": "%"}})
    head = traced(on("P1", "bb"), tmp_path / "head")
    with pytest.raises(BaselineError, match="create the baseline again"):
        hash_finding(base, head)


def test_the_command_keeps_hashes_of_other_processors_and_says_so(on, tmp_path) -> None:
    """As on two machines of one commit, and then with other poses on the second."""
    file = tmp_path / "baseline.json"
    kept, dropped = "1 pose hashes of P1 are kept", "1 pose hashes of P1 are dropped"
    for processor, pose_hash, note in (("P1", "aa", ""), ("P2", "bb", kept), ("P2", "cc", dropped)):
        write_baseline(on(processor, pose_hash), tmp_path / "run.json")
        result = CliRunner().invoke(app, ["baseline", str(tmp_path / "run.json"), "-o", str(file)])
        assert result.exit_code == 0, result.output
        assert note in result.output
