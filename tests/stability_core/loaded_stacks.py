"""Open stacks that stand, alone or frozen, and keep what was measured on them: shared by the measurements of loads.

Each measurement plays the same runs in four arms: the engine alone, and with the extension by ``equilibrium``, with and
without the contact forces that the engine reports, and by ``paper``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from adapters import open_engine
from adapters.base import Simulation
from bench.trial.stepping import PlainFrames, SteeredFrames
from scenarios.model import Brick, World
from scenarios.planks import MU

LEVEL_S = 0.25
"""Between the levels of a stack that an engine builds alone [s]: set down whole it sinks by up to 8 mm, or falls."""
SETTLED_S = 1.0
"""Time [s] that a stack has before anything happens: alone it comes to rest, else it is frozen from the first frame."""
PAGES = Path(__file__).parents[2] / "docs" / "results" / "loads"
KEPT = Path("results/loads")
"""Runs that are done, by core: an interrupted measurement goes on from there."""

FloatArray = npt.NDArray[np.float64]


class Arm(NamedTuple):
    """How a run is played."""

    policy: str | None
    """None for the engine alone."""
    reads_forces: bool = True
    """False to withhold the contact forces that the engine reports."""

    def profile(self, name: str) -> str:
        """Return the name of the engine's profile for this arm."""
        return name if self.reads_forces else f"{name}@forces=0"


ARMS = {
    "alone": Arm(None),
    "equilibrium": Arm("equilibrium"),
    "equilibrium, no forces": Arm("equilibrium", reads_forces=False),
    "paper": Arm("paper"),
}
NEEDED = ("alone", "equilibrium")
"""Arms without which a measurement's page is not written."""


class Standing(NamedTuple):
    """A stack that stands in an engine."""

    simulation: Simulation
    frames: PlainFrames | SteeredFrames
    bodies: tuple[int, ...]
    """Of the stack."""
    off_plan: float
    """Greatest distance [m] of a body from its planned place: large if the engine cannot hold the stack alone."""
    is_frozen: bool
    """True if each of them is frozen."""

    def play(self, seconds: float) -> int:
        """Play for ``seconds``; return how many bodies were woken."""
        woken = 0
        for _ in range(round(seconds / self.simulation.info.frame_s)):
            _, steering = self.frames.play()
            woken += len(steering.woken) if steering else 0
        return woken

    def positions(self) -> FloatArray:
        """Centres [m] of all bodies, also of those spawned later, shape (n, 3)."""
        return self.simulation.poses()[1]


@contextmanager
def standing(
    engine: str, profile: str, arm: Arm, bricks: Sequence[Brick], *, later: Sequence[Brick] = (), friction: float = MU
) -> Iterator[Standing]:
    """Build a stack and wait for ``SETTLED_S``: level by level alone, else set down whole and adopted by the extension.

    Args:
        engine: name of the engine.
        profile: name of its profile.
        arm: the engine alone, or a policy.
        bricks: the stack.
        later: what will be spawned later.
        friction: Coulomb coefficient of every pair.
    """
    simulation = open_engine(engine, arm.profile(profile), world=World(friction=friction), expected=[*bricks, *later])
    try:
        frames: PlainFrames | SteeredFrames
        if arm.policy is None:
            frames = PlainFrames(simulation)
            bodies = _built(simulation, bricks)
        else:
            bodies = tuple(simulation.spawn(brick) for brick in bricks)
            frames = SteeredFrames(simulation, arm.policy)
            frames.adopt(bodies)
        for _ in range(round(SETTLED_S / simulation.info.frame_s)):
            frames.play()
        off_plan = simulation.poses()[1] - np.array([brick.position for brick in bricks])
        farthest = float(np.linalg.norm(off_plan, axis=1).max())
        yield Standing(simulation, frames, bodies, farthest, set(bodies) <= simulation.frozen)
    finally:
        simulation.close()


def _built(simulation: Simulation, bricks: Sequence[Brick]) -> tuple[int, ...]:
    """Spawn the bricks, in the order of their levels, each level ``LEVEL_S`` after the one before."""
    bodies: list[int] = []
    for level, group in groupby(bricks, key=lambda brick: brick.level):
        for _ in range(round(LEVEL_S / simulation.info.frame_s) if level > 1 else 0):
            simulation.step(simulation.info.frame_s)
        bodies += [simulation.spawn(brick) for brick in group]
    return tuple(bodies)


def kept_runs(
    name: str, core: str, keys: Iterable[Sequence[Any]], play: Callable[..., dict[str, Any]], folder: Path = KEPT
) -> list[dict[str, Any]]:
    """Return what ``play`` found for each of ``keys``, its arguments; runs that the file of this core holds are kept.

    Delete the file when the measurement itself changes: its name depends on the core only.

    Args:
        name: of the measurement.
        core: digest of the core.
        keys: arguments of ``play``, of plain types.
        play: plays one run and returns plain figures.
        folder: where the file is.
    """
    file = folder / f"{name}-{core}.jsonl"
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    done = {json.dumps(row["key"]): row for row in map(json.loads, lines)}
    found = []
    with file.open("a", encoding="utf-8") as out:
        for key in keys:
            row = done.get(json.dumps(list(key)))
            if row is None:
                row = {"key": list(key), **play(*key)}
                out.write(json.dumps(row) + "\n")
                out.flush()
            found.append(row)
    return found


def left_out(arms: Iterable[str]) -> list[str]:
    """Return the lines of a page that name the arms which were not played."""
    played = set(arms)
    missing = [arm for arm in ARMS if arm not in played]
    return [f"Not played with this core: {'; '.join(missing)}.", ""] if missing else []


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table."""
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows)]
