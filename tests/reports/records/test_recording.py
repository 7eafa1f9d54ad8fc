"""A recording holds what happened to within its steps, and little else."""

from dataclasses import replace

import numpy as np
import pytest

from reports.records.recording import (
    FROZEN,
    LENGTH_STEP,
    LIVE,
    MOST_BYTES,
    QUATERNION_STEP,
    REMOVED,
    THINNED,
    Recorder,
    RecordingError,
    read_recording,
    write_recording,
)
from scenarios.model import Brick, World

PLANK = Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.0, 0.0))
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def see(recorder: Recorder, positions: dict[int, tuple], frozen=(), quaternion=UPRIGHT) -> None:
    bodies = np.array(list(positions), np.int64)
    poses = np.array(list(positions.values()), float).reshape(-1, 3)
    recorder.see(bodies, poses, np.tile(quaternion, (len(bodies), 1)), frozen, dict.fromkeys(positions, PLANK))


def test_what_rests_takes_one_row_and_what_moves_one_a_frame() -> None:
    recorder = Recorder(1 / 60)
    for frame in range(10):
        see(recorder, {0: (0, 0, 0.0039), 1: (0, 0, 0.1 - 0.001 * frame)})
    recording = recorder.finish()
    assert recording.frames == 10
    assert np.bincount(recording.body).tolist() == [1, 10]
    assert recording.position[recording.body == 1, 2].tolist() == [10000 - 100 * frame for frame in range(10)]


def test_trembling_is_not_kept_but_creep_is() -> None:
    recorder, rng = Recorder(1 / 60), np.random.default_rng(0)
    for frame in range(300):
        see(recorder, {0: tuple(rng.normal(0, 1e-5, 3)), 1: (1e-6 * frame, 0, 0)})  # 0.01 mm; 0.06 mm/s
    recording = recorder.finish()
    assert (recording.body == 0).sum() < 5
    last = recording.position[recording.body == 1][-1, 0] * LENGTH_STEP
    assert last == pytest.approx(299e-6, abs=6e-5), "never farther off than the dead band and half a step"


def test_states_change_with_freezing_waking_and_removal() -> None:
    recorder = Recorder(1 / 60)
    here = {0: (0, 0, 0)}
    for bricks, frozen in ((here, ()), (here, [0]), (here, [0]), (here, ()), ({}, ())):
        see(recorder, bricks, frozen)
    recording = recorder.finish()
    assert recording.state.tolist() == [LIVE, FROZEN, LIVE, REMOVED]
    assert recording.frame.tolist() == [0, 1, 3, 4]


def test_a_quaternion_and_its_negative_are_the_same_pose() -> None:
    recorder = Recorder(1 / 60)
    see(recorder, {0: (0, 0, 0)})
    see(recorder, {0: (0, 0, 0)}, quaternion=-UPRIGHT)
    assert len(recorder.finish().body) == 1


def fall(bricks: int, frames: int):
    """Bricks that all tumble, without end."""
    recorder, rng = Recorder(1 / 60), np.random.default_rng(1)
    bodies, position = np.arange(bricks), rng.normal(size=(bricks, 3))
    known = dict.fromkeys(range(bricks), PLANK)
    for _ in range(frames):
        position = position + rng.normal(0, 1e-3, position.shape)
        quaternion = rng.normal(size=(bricks, 4))
        quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
        recorder.see(bodies, position, quaternion, (), known)
    return recorder.finish()


def test_it_reads_back_as_it_was(tmp_path) -> None:
    recording = fall(5, 50)
    write_recording(tmp_path / "a.parquet", recording)
    again = read_recording(tmp_path / "a.parquet")
    for column in ("body", "frame", "position", "quaternion", "state"):
        np.testing.assert_array_equal(getattr(again, column), getattr(recording, column))
    assert (again.frame_s, again.frames, again.sizes, again.every) == (1 / 60, 50, recording.sizes, 1)
    lengths = np.linalg.norm(again.quaternion * QUATERNION_STEP, axis=1)
    np.testing.assert_allclose(lengths, 1, atol=2 * QUATERNION_STEP)  # four components, half a step each


def test_a_hundred_bricks_for_a_hundred_seconds_take_less_than_a_megabyte(tmp_path) -> None:
    """One brick a second, each falling for a tenth of it, on an engine whose bricks tremble by 0.01 mm."""
    recorder, rng = Recorder(1 / 60), np.random.default_rng(2)
    for frame in range(6000):
        count = frame // 60 + 1
        position = np.stack([np.zeros(count), np.zeros(count), 0.0078 * np.arange(count)], axis=1)
        position[-1, 2] += max(0.0, 5e-4 - 1e-4 * (frame % 60))
        quaternion = np.tile(UPRIGHT, (count, 1))
        noise = rng.normal(0, 1e-5, position.shape)
        recorder.see(np.arange(count), position + noise, quaternion, (), dict.fromkeys(range(count), PLANK))
    write_recording(tmp_path / "a.parquet", recorder.finish())
    assert (tmp_path / "a.parquet").stat().st_size < MOST_BYTES


def test_what_is_too_large_is_thinned_and_says_so(tmp_path) -> None:
    write_recording(tmp_path / "a.parquet", fall(100, 1500))
    again = read_recording(tmp_path / "a.parquet")
    assert again.every == THINNED
    assert set(again.frame % THINNED) == {0}


@pytest.mark.parametrize("content", [b"", b"not a table", None])
def test_a_missing_or_torn_recording_is_named(tmp_path, content) -> None:
    if content is not None:
        (tmp_path / "a.parquet").write_bytes(content)
    with pytest.raises(RecordingError, match=r"a\.parquet"):
        read_recording(tmp_path / "a.parquet")


def test_fixed_boxes_are_kept(tmp_path) -> None:
    table = Brick((0.4, 0.2, 0.1), 1.0, (0.0, 0.0, 0.05), (0.8, 0.0, 0.6, 0.0))
    recorder = Recorder(1 / 60, World(fixed=(table,)))
    see(recorder, {0: (0, 0, 0.1039)})
    write_recording(tmp_path / "one.parquet", recorder.finish())
    assert read_recording(tmp_path / "one.parquet").fixed == (table,)


def test_masses_friction_and_turning_gravity_are_kept(tmp_path) -> None:
    recorder = Recorder(1 / 60, World(friction=0.3))
    lift = replace(PLANK, moved=True)
    upright, bodies = np.tile([1.0, 0, 0, 0], (2, 1)), np.arange(2)
    for gravity in ((0.0, 0.0, -9.81), (1e-4, 0.0, -9.81), (0.5, 0.0, -9.8)):
        recorder.see(bodies, np.zeros((2, 3)), upright, (), {0: PLANK, 1: lift}, gravity)
    write_recording(tmp_path / "one.parquet", recorder.finish())
    physics = read_recording(tmp_path / "one.parquet").physics
    assert physics is not None
    assert (physics.friction, physics.masses) == (0.3, {0: PLANK.mass}), "only the host moves the other body"
    assert [physics.gravity_at(frame)[0] for frame in range(4)] == [0.0, 0.0, 0.5, 0.5]
