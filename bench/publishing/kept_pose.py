"""Measure how many planks of a falling leaning tower keep their pose on the plank below.

``uv run python -m bench.publishing.kept_pose`` writes the page ``docs/results/equilibrium/kept_pose.md``, and a picture
of each fall beside the page.

A real leaning tower turns about the edge of its lowest plank and does not break up before it hits the ground. The
measured fall begins with the frame before the core unfreezes the tower. It ends with the first frame in which a falling
plank touches the ground. A plank keeps its pose relative to the plank below up to a motion of half a thickness and a
turn of 5 degrees. The count leaves out the lowest plank, because this plank does not fall, and the second plank,
because the tower turns on the lowest plank.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from adapters import open_engine
from bench.machine.core_digest import present_core
from bench.machine.source_digest import PUBLISHED
from bench.publishing.page_marks import write_page
from bench.trial.measure import BoolArray
from bench.trial.playback import Playback
from scenarios.geometry import Boxes, FloatArray, rotation
from scenarios.planks import LENGTH, THICKNESS
from scenarios.registry import build

ENGINES = ("bullet", "mujoco", "dart")
"""Engines of the measured falls."""
POLICIES = ("paper", "equilibrium")
"""Policies of the measured falls."""
FOLDER = PUBLISHED / "equilibrium"
"""Folder of the page and its pictures."""
MOVED = THICKNESS / 2
"""Displacement relative to the plank below [m] from which a plank has lost its pose."""
TURNED = np.radians(5.0)
"""Rotation relative to the plank below [rad] from which a plank has lost its pose."""
STRUCK = 1e-3
"""Height of a corner above the ground [m] below which the corner counts as touching the ground. A plank falls farther
than this height in one frame, so that the measured fall is at most one frame too short."""


@dataclass(frozen=True)
class Fall:
    """Poses of one tower from its release, when the core unfreezes the tower, to its first touch of the ground."""

    poses: list[tuple[FloatArray, FloatArray]]
    """Positions (n, 3) [m] and quaternions (n, 4) [w, x, y, z] of n planks per frame, from the frame before the
    release."""
    frame_s: float
    """Length of a frame [s]."""
    woken: int
    """Number of planks that the core unfroze in the frame of the release."""

    @property
    def kept(self) -> BoolArray:
        """Mask of the planks that keep their pose on the plank below, from the third plank on, shape (n - 2,)."""
        begin, end = (seen_from_below(*self.poses[frame]) for frame in (0, -1))
        moved = np.linalg.norm(end[0] - begin[0], axis=1)
        cosine = ((np.einsum("nij,nij->n", begin[1], end[1])) - 1) / 2
        kept: BoolArray = (moved < MOVED) & (np.arccos(np.clip(cosine, -1, 1)) < TURNED)
        return kept[1:]

    @property
    def tilt(self) -> float:
        """Absolute rotation of the top plank about y in the last frame [rad]."""
        w, x, y, z = self.poses[-1][1][-1]
        return float(abs(np.arctan2(2 * (w * y - z * x), 1 - 2 * (x * x + y * y))))


def seen_from_below(position: FloatArray, quaternion: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the poses of all planks but the lowest, in the frame of reference of the plank below.

    Args:
        position: positions of n planks from bottom to top [m], shape (n, 3), world frame.
        quaternion: quaternions [w, x, y, z] of these planks, shape (n, 4).

    Returns:
        Positions [m], shape (n - 1, 3), and rotation matrices, shape (n - 1, 3, 3).
    """
    axes = rotation(quaternion)
    below = np.swapaxes(axes[:-1], 1, 2)
    return np.einsum("nij,nj->ni", below, np.diff(position, axis=0)), below @ axes[1:]


def watch_fall(engine: str, policy: str) -> Fall:
    """Build a leaning tower until the tower falls, and return the fall.

    Raises:
        StopIteration: if the core never unfreezes a plank.
    """
    scene = build("leaning_tower")
    simulation = open_engine(engine, "game", world=scene.world, sleeping="off", expected=scene.bricks)
    poses: list[tuple[FloatArray, FloatArray]] = []

    def keep(_: Any) -> None:
        _, position, quaternion = simulation.poses()
        poses.append((position.copy(), quaternion.copy()))

    play = Playback(scene, simulation, policy, np.inf, keep)
    play.run()
    release = next(row.frame for row in play.rows if row.woken)
    size = np.array([brick.size for brick in play.builder.bricks])
    fall = []
    for position, quaternion in poses[release - 1 :]:
        fall.append((position, quaternion))
        corners = Boxes.at(size[: len(position)], position, quaternion).corners
        if corners[1:, :, 2].min() < STRUCK:
            break
    outcome = Fall(fall, simulation.info.frame_s, play.rows[release].woken or 0)
    simulation.close()
    return outcome


def table(falls: dict[tuple[str, str], Fall]) -> str:
    """Return the page with the results, as Markdown."""
    lines = [
        "# How a leaning tower falls",
        "",
        "Made by `uv run python -m bench.publishing.kept_pose`, whose docstring defines the count: the planks that",
        "keep their pose on the plank below until the tower strikes the ground. Scene `leaning_tower`, profile `game`.",
        "The fall lasts from the release to the first touch of the ground; the tilt is the top plank's by then.",
        "",
        "| Engine | policy | woken | kept | fall, s | tilt, deg | picture |",
        "|---|---|---|---|---|---|---|",
    ]
    for (engine, policy), fall in falls.items():
        lines.append(
            f"| {engine} | `{policy}` | {fall.woken} | {fall.kept.sum()} of {len(fall.kept)} "
            f"| {(len(fall.poses) - 1) * fall.frame_s:.2f} | {np.degrees(fall.tilt):.0f} "
            f"| [side view](kept_pose_{engine}_{policy}.svg) |"
        )
    return "\n".join([*lines, ""])


def picture(fall: Fall) -> str:
    """Return an SVG picture of the tower at the beginning, in the middle and at the end of the fall.

    The picture is a side view with x to the right and z up.
    """
    moments = [0, len(fall.poses) // 2, len(fall.poses) - 1]
    pitch, height = 3.2 * LENGTH, 1.2 * LENGTH
    scale = 2000
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {3 * pitch * scale:.0f} {height * scale:.0f}">',
        f'<path d="M0 {height * scale - 2:.0f}H{3 * pitch * scale:.0f}" stroke="black" stroke-width="2"/>',
    ]
    for place, frame in enumerate(moments):
        position, quaternion = fall.poses[frame]
        for center, axes in zip(position, rotation(quaternion), strict=True):
            signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
            corners = [center + axes[:, 0] * a * LENGTH / 2 + axes[:, 2] * b * THICKNESS / 2 for a, b in signs]
            points = " ".join(
                f"{(x + place * pitch + LENGTH) * scale:.0f},{(height - z) * scale - 2:.0f}" for x, _, z in corners
            )
            parts.append(f'<polygon points="{points}" fill="#d9b98c" stroke="#5a4020"/>')
        parts.append(
            f'<text x="{place * pitch * scale + 10:.0f}" y="30" font-size="24">{frame * fall.frame_s:.2f} s</text>'
        )
    return "\n".join([*parts, "</svg>", ""])


def main() -> None:
    """Simulate every fall and write the page with its pictures."""
    core = present_core()
    falls = {(engine, policy): watch_fall(engine, policy) for engine in ENGINES for policy in POLICIES}
    write_page(FOLDER / "kept_pose.md", table(falls), core)
    for (engine, policy), fall in falls.items():
        (FOLDER / f"kept_pose_{engine}_{policy}.svg").write_text(picture(fall), encoding="utf-8")


if __name__ == "__main__":
    main()
