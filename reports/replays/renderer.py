"""Drawing of views in a separate process, because VTK ends its process if the machine has no renderer."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.records.recording import FloatArray
from reports.replays.camera import CAMERAS, Camera
from reports.replays.errors import ExportError
from reports.replays.timeline import BoolArray
from scenarios.shapes import Shape
from scenarios.surfaces import surface_of

_ROOT = Path(__file__).parents[2]
"""Folder of the checkout."""
_LONGEST_S = 900
"""Time limit of ``draw_pictures`` [s]. A video has no limit, because the user chooses the length of a video."""
_CHANNELS = 4

ByteArray = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class View:
    """The poses and colours of n bricks, fixed bodies included, in f frames, seen by one camera."""

    pixels: tuple[int, int]
    """Width and height of the pictures [pixels]."""
    low: FloatArray
    """Lower corner of the visible space [m], shape (3,)."""
    high: FloatArray
    """Upper corner of the visible space [m], shape (3,)."""
    sizes: FloatArray
    """Edge lengths of the bricks [m], shape (n, 3)."""
    position: FloatArray
    """Centres [m], shape (f, n, 3), world frame."""
    quaternion: FloatArray
    """Orientations (w, x, y, z), shape (f, n, 4), world frame, of any length."""
    colour: ByteArray
    """Red, green and blue from 0 to 255, shape (f, n, 3)."""
    shown: BoolArray
    """True for each brick in the picture, shape (f, n)."""
    camera: Camera = CAMERAS["corner"]
    shapes: tuple[Shape, ...] = ()
    """Shapes of the bricks; empty if all are boxes."""

    def order(self, poses: Path, paths: Sequence[Path] = ()) -> dict[str, Any]:
        """Write the arrays of this view to a file, and return the order (the renderer's input) for this view.

        Args:
            poses: file of the arrays.
            paths: files of the pictures, one for each frame; without paths, the pictures go to standard output.
        """
        names = ("sizes", "position", "quaternion", "colour", "shown")
        np.savez(poses, **{name: getattr(self, name) for name in names})
        camera = self.camera
        return {
            "poses": str(poses),
            "paths": [str(path.resolve()) for path in paths],
            "pixels": self.pixels,
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "camera": (camera.azimuth, camera.elevation, camera.distance),
            "surfaces": {row: self._surface(row) for row, shape in enumerate(self.shapes) if shape != "box"},
        }

    def _surface(self, row: int) -> dict[str, Any]:
        """Return the surface [m] of a brick other than a box, in the frame of the brick."""
        x, y, z = self.sizes[row].tolist()
        surface = surface_of(self.shapes[row], (x, y, z))
        return {"corners": surface.corners.tolist(), "faces": surface.faces, "is_round": surface.is_round}


def draw_pictures(views: Sequence[tuple[View, Sequence[Path]]]) -> None:
    """Draw each view with a transparent background into its files, one for each frame.

    Raises:
        ExportError: if the machine has no renderer, or the renderer fails or takes too long.
    """
    with tempfile.TemporaryDirectory(prefix="stillstack-") as scratch:
        orders = [view.order(Path(scratch) / f"{n}.npz", paths) for n, (view, paths) in enumerate(views)]
        command = _command(Path(scratch), orders)
        try:
            subprocess.run(command, cwd=_ROOT, capture_output=True, text=True, check=True, timeout=_LONGEST_S)
        except subprocess.TimeoutExpired as error:
            count = sum(len(paths) for _, paths in views)
            raise ExportError(
                f"the renderer must draw {'1 picture' if count == 1 else f'{count} pictures'} within its time limit of "
                f"{_LONGEST_S} s, but did not: draw fewer pictures, or wait until the machine is idle"
            ) from error
        except subprocess.CalledProcessError as error:
            raise ExportError(_reason(error.returncode, error.stderr)) from error


@contextmanager
def drawn_frames(views: Sequence[View]) -> Iterator[Iterator[list[ByteArray]]]:
    """Draw views with equally many frames in a process that ends with the block.

    Yields:
        Iterator of the pictures of all views in each frame: RGBA, each of shape (height, width, 4).

    Raises:
        ExportError: from the iterator, if the machine has no renderer, or the renderer fails.
    """
    with tempfile.TemporaryDirectory(prefix="stillstack-") as scratch, (Path(scratch) / "errors").open("wb") as errors:
        orders = [view.order(Path(scratch) / f"{number}.npz") for number, view in enumerate(views)]
        command = _command(Path(scratch), orders)
        process = subprocess.Popen(command, cwd=_ROOT, stdout=subprocess.PIPE, stderr=errors)
        try:
            yield _frames(process, views, Path(errors.name))
        finally:
            process.kill()
            process.communicate()


def _frames(process: subprocess.Popen[bytes], views: Sequence[View], errors: Path) -> Iterator[list[ByteArray]]:
    assert process.stdout is not None
    for _ in range(len(views[0].position)):
        pictures = []
        for width, height in (view.pixels for view in views):
            raw = process.stdout.read(width * height * _CHANNELS)
            if len(raw) < width * height * _CHANNELS:
                raise ExportError(_reason(process.wait(), errors.read_text(encoding="utf-8", errors="replace")))
            pictures.append(np.frombuffer(raw, np.uint8).reshape(height, width, _CHANNELS))
        yield pictures


def _command(folder: Path, orders: Sequence[dict[str, Any]]) -> list[str]:
    order = folder / "order.json"
    order.write_text(json.dumps(orders), encoding="utf-8")
    return [sys.executable, "-m", "reports.replays.rendering", str(order)]


def _reason(returncode: int, errors: str) -> str:
    if returncode < 0:
        return (
            f"the renderer ended by signal {-returncode}, mostly because the machine has no renderer: "
            "run 'apt-get install libegl1', or 'apt-get install libosmesa6'"
        )
    last = errors.strip().splitlines()[-1] if errors.strip() else "no error output"
    fix = (
        "install the package with 'uv sync'"
        if "No module named" in last
        else "remove the cause, or run 'apt-get install libegl1' on a machine without a renderer"
    )
    return f"the renderer ended with status {returncode} ({last}): {fix}"
