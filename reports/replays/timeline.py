"""The poses of all bricks of a recording at any time, interpolated between kept frames as in a replay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.records.recording import FROZEN, LENGTH_STEP, QUATERNION_STEP, REMOVED, FloatArray, Recording

BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Poses:
    """Poses and states of all n bricks of a recording at one time, in the order of their ids.

    The bricks include bricks that are not yet, or no longer, in the world.
    """

    position: FloatArray
    """Centres [m], shape (n, 3), world frame."""
    quaternion: FloatArray
    """Orientations (w, x, y, z), shape (n, 4), world frame, unit length."""
    present: BoolArray
    """True for each brick in the world, shape (n,)."""
    frozen: BoolArray
    """True for each frozen brick, shape (n,); for a brick that is not yet in the world, its first state counts."""
    fallen: BoolArray
    """True for each brick whose distance from its first position exceeds its least edge length, shape (n,)."""

    @property
    def states(self) -> list[str]:
        """State of each brick in a picture: ``fallen``, else ``frozen``, else ``live``."""
        states: list[str] = np.where(self.fallen, "fallen", np.where(self.frozen, "frozen", "live")).tolist()
        return states


class Timeline:
    """Access to a recording by time."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self._begin = np.flatnonzero(np.diff(recording.body, prepend=-1))
        """First row of each brick, shape (n,)."""
        self._end = np.append(self._begin[1:], len(recording.body))[: len(self._begin)]
        """Row after the last row of each brick, shape (n,)."""
        self.bodies: npt.NDArray[np.int64] = recording.body[self._begin].astype(np.int64)
        """Ids of the n bricks, ascending, shape (n,)."""
        self.sizes: FloatArray = np.array([recording.sizes[body] for body in self.bodies.tolist()]).reshape(-1, 3)
        """Edge lengths [m], shape (n, 3)."""
        self.first: FloatArray = np.asarray(recording.position[self._begin] * LENGTH_STEP, np.float64)
        """First positions [m], shape (n, 3), world frame."""
        turn = recording.quaternion[self._begin].astype(np.float64)
        self.first_turn: FloatArray = turn / np.linalg.norm(turn, axis=1, keepdims=True)
        """First orientations (w, x, y, z), shape (n, 4), world frame, unit length."""
        span = np.repeat(np.arange(len(self._begin)), self._end - self._begin)
        self._keys = span * (recording.frames + 1) + recording.frame

    @property
    def end_s(self) -> float:
        """Simulated time of the recording [s]."""
        return self.recording.frames * self.recording.frame_s

    def at(self, time: float) -> Poses:
        """Return the poses at a simulated time [s].

        Before the first frame and after the last frame, return the poses of the nearest frame.
        """
        recording, count = self.recording, len(self.bodies)
        frame = min(max(time / recording.frame_s, 0.0), max(recording.frames - 1, 0))
        row = np.searchsorted(self._keys, np.arange(count) * (recording.frames + 1) + frame, side="right") - 1
        has_begun = row >= self._begin
        row = np.maximum(row, self._begin)
        following = np.minimum(row + 1, np.maximum(self._end - 1, 0))
        gap = recording.frame[following] - recording.frame[row]
        moves = has_begun & (gap > 0) & (gap <= recording.every)
        share = np.where(moves, (frame - recording.frame[row]) / np.maximum(gap, 1), 0.0)[:, None]
        position = ((1 - share) * recording.position[row] + share * recording.position[following]) * LENGTH_STEP
        turned = (1 - share) * recording.quaternion[row] + share * recording.quaternion[following]
        state = recording.state[row]
        return Poses(
            position,
            turned * QUATERNION_STEP / np.linalg.norm(turned * QUATERNION_STEP, axis=1, keepdims=True),
            has_begun & (state != REMOVED),
            state == FROZEN,
            np.linalg.norm(position - self.first, axis=1) > self.sizes.min(axis=1, initial=np.inf),
        )
