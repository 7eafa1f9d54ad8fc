"""A live view of a running trial in the viewer of Rerun (https://rerun.io), which shows logged 3-D data.

The package ``rerun-sdk`` sends the poses and contains the viewer. The package is optional, because it takes 0.5 GB.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.records.recording import FloatArray
from reports.replays.drawing import COLOURS, FIXED_COLOUR
from reports.replays.errors import ExportError
from scenarios.model import Brick

APPLICATION = "stillstack"
"""Name of the application in Rerun."""
XYZW = [1, 2, 3, 0]
"""Order of the components of a quaternion in Rerun, as indices of (w, x, y, z)."""
_PATIENCE_S = 5.0
"""Time for which the end of a trial waits for a viewer to receive the last poses [s]."""


def require_rerun() -> Any:
    """Return the package ``rerun``.

    Raises:
        ExportError: if the package is missing.
    """
    try:
        import rerun  # an optional package
    except ImportError as error:
        raise ExportError(
            f"Rerun needs the package 'rerun-sdk' ({error}): install it with 'uv sync --group rerun'"
        ) from error
    return rerun


class LiveView:
    """Sender of the changed bricks of a running trial to an open viewer of Rerun, frame by frame."""

    def __init__(self, trial: str, policy: str, fixed: Sequence[Brick], address: str) -> None:
        """Connect to a viewer.

        Args:
            trial: id of the trial, which names the recording in the viewer.
            policy: policy of the trial.
            fixed: bodies that never move.
            address: address of the viewer, such as ``rerun+http://127.0.0.1:9876/proxy``. A viewer that does not answer
                loses the poses, and the trial continues.

        Raises:
            ExportError: if the package of Rerun is missing.
        """
        self._rerun = require_rerun()
        self._policy = policy
        self._stream = self._rerun.RecordingStream(APPLICATION, recording_id=trial)
        self._stream.connect_grpc(address)
        self._latest: dict[int, bytes] = {}
        self._first: dict[int, FloatArray] = {}
        log_fixed(self._rerun, self._stream, policy, fixed)

    def see(
        self,
        time: float,
        bodies: npt.NDArray[np.int64],
        position: FloatArray,
        quaternion: FloatArray,
        frozen: Collection[int],
        bricks: Mapping[int, Brick],
    ) -> None:
        """Send the bricks that changed since the previous frame; a box shows a brick of any shape.

        Args:
            time: simulated time [s].
            bodies: ids of the n bodies in the world, shape (n,).
            position: centres of the bodies [m], shape (n, 3), world frame.
            quaternion: orientations of the bodies (w, x, y, z), shape (n, 4), world frame.
            frozen: ids of the frozen bodies.
            bricks: brick of each body in the world, by id.
        """
        rerun, stream = self._rerun, self._stream
        stream.set_time("time", duration=time)
        for body, at, turn in zip(bodies.tolist(), position, quaternion, strict=True):
            now = at.tobytes() + turn.tobytes() + bytes([body in frozen])
            if self._latest.get(body) == now:
                continue
            self._latest[body] = now
            size = bricks[body].size
            has_fallen = np.linalg.norm(at - self._first.setdefault(body, at.copy())) > min(size)
            state = "fallen" if has_fallen else "frozen" if body in frozen else "live"
            box = rerun.Boxes3D(
                sizes=[size], centers=[at], quaternions=[turn[XYZW]], colors=[COLOURS[state]], fill_mode="solid"
            )
            stream.log(f"{self._policy}/bricks/{body}", box)
        for body in self._latest.keys() - set(bodies.tolist()):
            stream.log(f"{self._policy}/bricks/{body}", rerun.Clear(recursive=False))
            del self._latest[body]

    def close(self) -> None:
        """Send the remaining poses for at most ``_PATIENCE_S``, and disconnect."""
        self._stream.flush(timeout_sec=_PATIENCE_S)
        self._stream.disconnect()


@contextmanager
def live_view(trial: str, policy: str, fixed: Sequence[Brick], address: str) -> Iterator[LiveView]:
    """Yield a ``LiveView`` whose connection lasts until the end of the block.

    Raises:
        ExportError: if the package of Rerun is missing.
    """
    view = LiveView(trial, policy, fixed, address)
    try:
        yield view
    finally:
        view.close()


def open_viewer(port: int) -> str:
    """Open Rerun's viewer, and return the address of the viewer.

    The viewer runs until the user closes its window.

    Args:
        port: port on which the viewer listens.

    Raises:
        ExportError: if the package of Rerun is missing.
    """
    require_rerun().spawn(port=port, connect=False)
    return f"rerun+http://127.0.0.1:{port}/proxy"


def log_fixed(rerun: Any, stream: Any, policy: str, fixed: Sequence[Brick]) -> None:
    """Send the axes of the world, and the bodies that never move, as boxes."""
    stream.log(policy, rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    if fixed:
        turns = np.array([box.quaternion for box in fixed])[:, XYZW]
        boxes = rerun.Boxes3D(
            sizes=[box.size for box in fixed],
            centers=[box.position for box in fixed],
            quaternions=turns,
            colors=[FIXED_COLOUR] * len(fixed),
            fill_mode="solid",
        )
        stream.log(f"{policy}/fixed", boxes, static=True)
