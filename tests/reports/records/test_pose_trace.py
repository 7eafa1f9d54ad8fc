"""Two traces part at the first pose that differs in its last bit, and say which it was."""

import base64
import zlib

import numpy as np
import pytest

from reports.records import pose_trace
from reports.records.pose_trace import (
    PoseTrace,
    PoseTraceError,
    PoseTracer,
    parting,
    read_pose_trace,
    unpacked,
    write_pose_trace,
)

UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def sinking(frames: int = 50, bodies: int = 3, gone_from: int = 1000, nudged: tuple[int, int] = (-1, -1)) -> PoseTrace:
    """Bodies that sink; the last leaves the world at a frame, and one body is nudged by one bit from a frame on."""
    tracer = PoseTracer()
    for frame in range(frames):
        ids = np.arange(bodies if frame < gone_from else bodies - 1)
        position = np.column_stack([0.1 * ids, np.zeros(len(ids)), 0.01 * (ids + 1) - 1e-6 * frame])
        if frame >= nudged[0] >= 0:
            position[nudged[1], 2] = np.nextafter(position[nudged[1], 2], 1.0)
        tracer.see(ids, position, np.tile(UPRIGHT, (len(ids), 1)))
    return tracer.finish()


def test_equal_runs_do_not_part() -> None:
    assert parting(sinking(), sinking()) is None
    assert parting(sinking(50), sinking(40)) is None, "only the frames that both have are compared"


@pytest.mark.parametrize(("frame", "body"), [(0, 0), (17, 2), (49, 1)])
def test_the_last_bit_of_one_coordinate_is_found_in_its_frame(frame, body) -> None:
    base, head = sinking(), sinking(nudged=(frame, body))
    found = parting(base, head)
    assert (found.frame, found.body, found.bodies) == (frame, body, 1)
    before, now = found.poses
    assert now[2] == np.nextafter(before[2], 1.0)
    assert np.array_equal(np.delete(now, 2), np.delete(before, 2))


def test_a_removed_body_is_a_difference() -> None:
    found = parting(sinking(), sinking(gone_from=9))
    assert (found.frame, found.body) == (9, 2)
    assert np.isfinite(found.poses[0]).all()
    assert np.isnan(found.poses[1]).all()


def test_a_body_at_rest_has_one_row() -> None:
    tracer = PoseTracer()
    for _ in range(100):
        tracer.see(np.array([4]), np.zeros((1, 3)), np.array([UPRIGHT]))
    trace = tracer.finish()
    assert (trace.frames, trace.frame.tolist(), trace.body.tolist()) == (100, [0], [4])


def test_a_trace_ends_and_says_how_many_frames_it_has(monkeypatch) -> None:
    monkeypatch.setattr(pose_trace, "MOST_ROWS", 30)
    assert sinking().frames == 10
    assert parting(sinking(), sinking(nudged=(17, 2))) is None


def test_a_trace_keeps_its_rows_in_a_file_and_in_a_text(tmp_path) -> None:
    trace = sinking(gone_from=9)
    write_pose_trace(tmp_path / "t.parquet", trace)
    read, text = read_pose_trace(tmp_path / "t.parquet"), unpacked(trace.packed())
    assert np.array_equal(read.pose, trace.pose, equal_nan=True)
    for kept in (read, text):
        assert kept.frames == trace.frames
        for name in ("frame", "body", "digest"):
            assert np.array_equal(getattr(kept, name), getattr(trace, name)), name
    found = parting(text, sinking(gone_from=9, nudged=(17, 1)))
    assert (found.frame, found.body) == (17, 1)
    assert found.poses[0] is None


def test_of_ten_thousand_changes_of_a_bit_hardly_one_has_the_same_digest() -> None:
    """By chance 10,000 / 65,536 of a change; five have a probability of 1e-6."""
    rng = np.random.default_rng(1)
    pose = rng.normal(size=(10_000, 7))
    changed = pose.copy()
    column = rng.integers(0, 7, len(pose))
    rows = np.arange(len(pose))
    changed[rows, column] = np.nextafter(pose[rows, column], np.inf)
    assert (pose_trace._digests(pose) == pose_trace._digests(changed)).sum() < 5


@pytest.mark.parametrize("text", ["", "%%%", "AAAA", base64.b64encode(zlib.compress(b"1234567")).decode()])
def test_a_text_that_is_no_trace_is_refused(text) -> None:
    with pytest.raises(PoseTraceError, match="not a packed trace"):
        unpacked(text)


def test_a_small_text_does_not_fill_the_memory() -> None:
    bomb = base64.b64encode(zlib.compress(bytes(50_000_000), 9)).decode()
    with pytest.raises(PoseTraceError, match="too long"):
        unpacked(bomb)


@pytest.mark.parametrize("content", [None, b"", b"PAR1"])
def test_a_file_that_is_no_trace_is_refused(tmp_path, content) -> None:
    path = tmp_path / "t.parquet"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(PoseTraceError, match="run the trial again"):
        read_pose_trace(path)
