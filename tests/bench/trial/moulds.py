"""Program that pours bricks into moulds, removes the walls, and strikes a brick: how much keeps its place.

    python -m tests.bench.trial.moulds --engine physx --policy none --policy weld --draws 4

The figures are in ``docs/related_work.md``. A row is a pile of one draw: the share of bricks that keep their place in
the 5 s after the walls are removed, the joints at the end of this time, and what the strike parts and moves.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from functools import cache
from statistics import fmean, median
from typing import NamedTuple

import numpy as np

from adapters import open_engine
from bench.studies.policies import BENCH_POLICIES
from bench.trial.playback import Playback
from bench.welding import WeldExtension
from bench.welding.balance import residuals
from bench.welding.settings import MAX_RESIDUAL
from reports.records.frames import FrameRow
from scenarios.model import Remove, Scene
from scenarios.registry import build
from stability_core.port import FloatArray, IntArray
from stability_core.settings import ROUNDING_S

WATCH_S = 5.0
"""Time [s] after the removal of the walls, and after the strike."""
BLOW_S = 0.2
"""Time [s] after the strike within which a joint parts by the strike itself."""
STRIKE = 2.0
"""Speed [m/s] of the struck brick."""


@dataclass(frozen=True, slots=True)
class Mould:
    """What became of one pile."""

    kept: float
    """Share of the bricks that move less than a thickness in the 5 s after the walls are removed."""
    joints: int
    """Number of joints before the strike."""
    parted: int
    """Number of joints that part within 0.2 s after the strike, or 0 without joints."""
    moved: int
    """Number of bricks that move by a thickness in the 5 s after the strike."""
    unheld: int
    """Number of bricks whose own weight no contact forces hold, in the first frame without walls; 0 without joints."""
    frame_ms: float
    """Median time [ms] of a frame in the 5 s after the walls are removed."""


@cache
def mould(engine: str, policy: str, bricks: int = 30, draw: int = 1, profile: str = "tuned") -> Mould:
    """Play one pile, with a strike 5 s after the walls are removed."""
    scene = build("mould", bricks=bricks, draw=draw, strike=STRIKE)
    removed_s = max(action.time for action in scene.actions if isinstance(action, Remove))
    struck_s = removed_s + WATCH_S
    rows, seen = _played(scene, engine, profile, policy, removed_s)
    removed, struck, last = (
        min(seen, key=lambda frame: abs(frame.time_s - time)) for time in (removed_s, struck_s, struck_s + WATCH_S)
    )
    thickness = min(scene.bricks[-1].size)

    def away(before: _Seen, after: _Seen) -> list[bool]:
        return [bool(np.linalg.norm(place - before.places[body]) >= thickness) for body, place in after.places.items()]

    def within(begin: float, end: float) -> list[FrameRow]:
        return [row for row in rows if begin < row.time_s <= end]

    return Mould(
        kept=1.0 - fmean(away(removed, struck)),
        joints=struck.joints,
        parted=sum(row.parted or 0 for row in within(struck_s, struck_s + BLOW_S)),
        moved=sum(away(struck, last)),
        unheld=max(frame.unheld for frame in seen),
        frame_ms=median(row.frame_ms for row in within(removed_s, struck_s)),
    )


class _Seen(NamedTuple):
    """A frame: its time [s], the places [m] of the bodies, and the number of joints.

    ``unheld`` is the number of unheld bodies in the first frame without walls, and 0 in all other frames.
    """

    time_s: float
    places: dict[int, FloatArray]
    joints: int
    unheld: int


def _unheld(extension: WeldExtension) -> int:
    """Return the number of bodies whose own weight no contact forces hold."""
    rows = extension._bodies.rows
    center, size, mass = (np.ascontiguousarray(rows[name]) for name in ("center", "size", "mass"))
    lacking = residuals(center, size, mass, extension.gravity, extension._recent_touches(), False)
    return int(np.count_nonzero(lacking > MAX_RESIDUAL))


def _played(
    scene: Scene, engine: str, profile: str, policy: str, removed_s: float
) -> tuple[list[FrameRow], list[_Seen]]:
    seen: list[_Seen] = []
    simulation = open_engine(engine, profile, world=scene.world, expected=scene.bricks)

    def note(now: float, bodies: IntArray, position: FloatArray, *_: object) -> None:
        extension = getattr(playback._frames, "_extension", None)
        joints = unheld = 0
        if isinstance(extension, WeldExtension):
            joints = len(extension.joined)
            is_first = now > removed_s + ROUNDING_S and seen[-1].time_s <= removed_s + ROUNDING_S
            unheld = _unheld(extension) if is_first else 0
        seen.append(_Seen(now, dict(zip(bodies.tolist(), position, strict=True)), joints, unheld))

    try:
        steering = policy if BENCH_POLICIES[policy].is_steered else None
        playback = Playback(scene, simulation, steering, 900.0, lambda _: None, on_frame=note)
        playback.run()
        return playback.rows, seen
    finally:
        simulation.close()


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", required=True)
    parser.add_argument("--policy", action="append", required=True)
    parser.add_argument("--bricks", type=int, default=30)
    parser.add_argument("--draws", type=int, default=1)
    arguments = parser.parse_args()
    for policy in arguments.policy:
        moulds = [mould(arguments.engine, policy, arguments.bricks, draw + 1) for draw in range(arguments.draws)]
        for draw, one in enumerate(moulds, 1):
            print(f"{arguments.engine} {policy} draw {draw}: {one}", flush=True)  # noqa: T201 - a command
        kept = fmean(one.kept for one in moulds)
        line = f"{arguments.engine} {policy}: kept {kept:.2f} of {arguments.bricks} bricks in {len(moulds)} piles"
        print(line, flush=True)  # noqa: T201 - a command


if __name__ == "__main__":
    _main()
