"""Blows and slow pushes on frozen stacks, against the same stacks alone.

    uv run python -m tests.stability_core.struck_wall [--runs N] [--engine E] [--profile P] [--strike S]

writes ``docs/results/loads/struck_wall.md`` if nothing but arms is left out, and neither of those compared; it goes on
from where an earlier run was stopped.

- Throws: a cube of 0.1 kg strikes the middle of a wall of 25 planks, across it, at one third of its height, with 2 or
  10 m/s. It is let go ``FLIGHT_S`` before the blow, so that the extension sees it come.
- Slow push: a cube of 1 kg slides on the ground into the ends of a tower of 8 planks, which it reaches with 0.45 m/s,
  in the second frame after its impulse (see ``SLIDE``).

Before that the stack stood for a second; with the extension it was set down whole, and all of it is frozen. Run number
i shifts the striker by up to ``MOST_SHIFT`` along each axis, alike in all arms; one that slides stays on the ground.
Where a plank of the stack alone is more than a quarter of its thickness off its place before the blow, the engine does
not hold the stack, and there is nothing to compare with.

The extension passes if the median number of displaced planks and the median momentum given to the stack lie within the
5-95 % range of the runs alone, widened by 25 %, and if the 95th percentile of the farthest displacement of a plank is
at most 1.5 times that alone. "Widened by 25 %" has two readings, and the page shows both:

- by length: each end is moved outwards by a quarter of the length of the range;
- by ends: from 0.75 times the lower end to 1.25 times the upper one.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from scenarios.model import Brick, Vector
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH
from scenarios.scenes.brick_wall import brick_wall
from scenarios.scenes.plank_tower import plank_tower
from tests.stability_core.loaded_stacks import (
    ARMS,
    NEEDED,
    PAGES,
    FloatArray,
    Standing,
    kept_runs,
    left_out,
    standing,
    table,
)

SEED = 20261128
"""Named before the first run, and never changed."""
RUNS = 20
ENGINES = ("bullet", "mujoco")
PROFILES = ("game", "tuned")
MOST_SHIFT = 0.5e-3
"""[m]"""
GRAVITY = 9.81
"""[m/s2]"""
FLIGHT_S = 0.06
"""From the throw to the blow [s]: 3.6 frames, so that the blow falls within a frame, not between two."""
SLIDE = 12e-3
"""What a sliding striker has before it [m]: 1.4 frames. A blow within the very step in which its impulse is given is
seen by nobody: from 5 mm the tower is woken after that step, when as a rock it has taken all of the momentum."""
HELD_S = 0.2
"""How long [s] a striker that slides stands before it is pushed; the extension is notified that a user holds it."""
EXCHANGE_S = 0.05
"""After the blow, when the striker's momentum is read [s]: a cube that was thrown has not yet reached the ground."""
WATCH_S = 2.0
"""From the throw or push to the end [s]."""
WIDENED = 0.25
"""By how much the range of the runs alone is widened."""
READINGS = ("by length", "by ends")
"""What that may mean."""
ABSURD = 1e3
"""Displacement [m] from which the engine's numbers have diverged; the run ends there."""
MOST_OFF_PLAN = THICKNESS / 4
"""How far [m] a plank of the stack alone may be off its place before the blow."""
MOST_FLIGHT = 1.5
"""Farthest displacement over that alone, at the 95th percentile."""
NAME = "struck_wall"


class Strike(NamedTuple):
    """What strikes which stack."""

    stack: tuple[Brick, ...]
    mass: float
    """[kg]"""
    edge: float
    """[m]"""
    speed: float
    """On arrival [m/s]."""
    slides: bool = False

    def striker(self, shift: FloatArray) -> Brick:
        """Return the striker where it is let go, moved by ``shift`` [m], shape (3,)."""
        if self.slides:
            place = np.array([-(LENGTH + self.edge) / 2 - SLIDE, 0.0, self.edge / 2]) + shift * (1.0, 1.0, 0.0)
        else:
            height = max(brick.position[2] + brick.size[2] / 2 for brick in self.stack)
            place = np.array([0.0, -(WIDTH + self.edge) / 2 - self.speed * FLIGHT_S, height / 3]) + shift
        x, y, z = place.tolist()
        return Brick((self.edge,) * 3, self.mass, (x, y, z))

    @property
    def along(self) -> int:
        """Axis of the blow."""
        return 0 if self.slides else 1

    @property
    def impulse(self) -> Vector:
        """Impulse [N s] with which the striker is let go."""
        if self.slides:  # the ground slows it down on its way
            return self.mass * math.sqrt(self.speed**2 + 2 * MU * GRAVITY * SLIDE), 0.0, 0.0
        return 0.0, self.mass * self.speed, self.mass * GRAVITY * FLIGHT_S / 2

    @property
    def blow_s(self) -> float:
        """From the impulse to the blow [s]."""
        if self.slides:
            return (self.impulse[0] / self.mass - self.speed) / (MU * GRAVITY)
        return FLIGHT_S


WALL = brick_wall(courses=10, width=2).bricks
TOWER = plank_tower(levels=8).bricks
STRIKES = {
    "thrown at 2 m/s": Strike(WALL, 0.1, 0.03, 2.0),
    "thrown at 10 m/s": Strike(WALL, 0.1, 0.03, 10.0),
    "slow push": Strike(TOWER, 1.0, 0.05, 0.45, slides=True),
}


def shift_of(run: int) -> FloatArray:
    """Return the shift [m] of run number ``run``, shape (3,)."""
    return np.random.default_rng([SEED, run]).uniform(-MOST_SHIFT, MOST_SHIFT, 3)


def play(engine: str, profile: str, name: str, arm: str, run: int) -> dict[str, Any]:
    """Play one run and return its figures."""
    strike = STRIKES[name]
    striker = strike.striker(shift_of(run))
    with standing(engine, profile, ARMS[arm], strike.stack, later=[striker]) as stack:
        return {"frozen": stack.is_frozen, "off_plan": stack.off_plan, **_struck(stack, strike, striker)}


def _struck(stack: Standing, strike: Strike, striker: Brick) -> dict[str, Any]:
    simulation, before = stack.simulation, stack.positions()
    body = simulation.spawn(striker)
    woken = 0
    if strike.slides:
        woken += stack.play(simulation.info.frame_s)
        stack.frames.disturb([body])
        woken += stack.play(HELD_S)
    simulation.push(body, strike.impulse)
    read_s = strike.blow_s + EXCHANGE_S
    given, farthest, displaced = math.nan, 0.0, 0
    for frame in range(1, round(WATCH_S / simulation.info.frame_s) + 1):
        try:
            woken += stack.play(simulation.info.frame_s)
        except ValueError:  # the core refuses poses that are not finite
            break
        moved = np.linalg.norm(stack.positions()[: len(before)] - before, axis=1)
        if not moved.max() <= ABSURD:  # true for NaN too
            break
        farthest, displaced = max(farthest, float(moved.max())), int((moved > THICKNESS).sum())
        if math.isnan(given) and frame * simulation.info.frame_s >= read_s:
            given = strike.mass * (strike.speed - float(simulation.velocities()[0][-1, strike.along]))
    else:
        return {"displaced": displaced, "momentum": given, "farthest": farthest, "woken": woken, "diverged": False}
    return {"displaced": displaced, "momentum": given, "farthest": farthest, "woken": woken, "diverged": True}


def wide_range(values: Sequence[float], reading: str) -> tuple[float, float]:
    """Return the 5-95 % range of ``values``, widened as ``READINGS`` says."""
    low, high = np.percentile(values, [5, 95]).tolist()
    if reading == "by length":
        return low - WIDENED * (high - low), high + WIDENED * (high - low)
    return (1 - WIDENED) * low, (1 + WIDENED) * high


def failures(alone: Sequence[dict[str, Any]], steered: Sequence[dict[str, Any]]) -> dict[str, tuple[str, ...]]:
    """Compare the runs of an arm with those alone: the readings that fail, by figure.

    Flights are not compared where numbers diverged alone.
    """

    def values(runs: Sequence[dict[str, Any]], figure: str) -> list[float]:
        return [run[figure] for run in runs]

    failed = {}
    for figure in ("displaced", "momentum"):
        median = float(np.median(values(steered, figure)))
        ranges = {reading: wide_range(values(alone, figure), reading) for reading in READINGS}
        failed[figure] = tuple(reading for reading, (low, high) in ranges.items() if not low <= median <= high)
    if not any(values(alone, "diverged")):
        farthest, limit = (float(np.percentile(values(runs, "farthest"), 95)) for runs in (steered, alone))
        is_near = farthest <= MOST_FLIGHT * limit and not any(values(steered, "diverged"))
        failed["farthest"] = () if is_near else READINGS
    return failed


def page(rows: Sequence[dict[str, Any]]) -> str:
    """Return the results as a page."""
    lines = [
        "# Blows and slow pushes on frozen stacks",
        "",
        f"Made by `uv run python -m tests.stability_core.{NAME}`, whose docstring says how each run is made and what",
        f"passes (seed {SEED}). Figures are medians, with the 5-95 % range in brackets. Momentum is the striker's on",
        f"arrival less that {EXCHANGE_S * 1e3:g} ms after the blow, along the blow; of a cube that slides the ground",
        "takes a part of it. Displaced: planks that end more than their thickness away from where they stood.",
        "Farthest: greatest displacement of a plank at any time; in brackets its 95th percentile. Diverged: runs that",
        "ended early because the engine's numbers grew beyond all bounds; where they did alone, flights are not",
        'compared. What does not pass is marked **no**; what passes by one reading of "widened by 25 %" only, with the',
        "reading by which it does not: **no** by length, or **no** by ends.",
        "",
        *left_out(row["key"][3] for row in rows),
    ]
    groups: dict[tuple[str, ...], list[dict[str, Any]]] = {}
    for row in rows:
        groups.setdefault(tuple(row["key"][:4]), []).append(row)
    for name in STRIKES:
        cells = [_cells(key, runs, groups) for key, runs in groups.items() if key[2] == name]
        head = ["engine", "profile", "with", "runs", "diverged", "all frozen", "woken"]
        lines += [f"## {name.capitalize()}", ""]
        lines += [*table([*head, "displaced", "momentum [mN s]", "farthest [mm]"], cells), ""]
    return "\n".join(lines)


def _cells(
    key: tuple[str, ...], runs: Sequence[dict[str, Any]], groups: dict[tuple[str, ...], list[dict[str, Any]]]
) -> list[str]:
    engine, profile, name, arm = key
    alone = groups.get((engine, profile, name, "alone"), [])
    stands = all(run["off_plan"] <= MOST_OFF_PLAN for run in alone)
    failed = failures(alone, runs) if alone and stands and arm != "alone" else {}
    output = arm if stands else "alone: does not stand" if arm == "alone" else f"{arm}, not compared"
    cells = [engine, profile, output, f"{len(runs)}", f"{sum(run['diverged'] for run in runs)}"]
    cells.append(f"{sum(run['frozen'] for run in runs)}")
    cells.append(f"{np.median([run['woken'] for run in runs]):g}")
    for figure, factor in (("displaced", 1), ("momentum", 1e3), ("farthest", 1e3)):
        low, median, high = factor * np.percentile([run[figure] for run in runs], [5, 50, 95])
        spread = f"{high:.3g}" if figure == "farthest" else f"{low:.3g}-{high:.3g}"
        cells.append(f"{median:.3g} ({spread})" + _verdict(failed.get(figure, ())))
    return cells


def _verdict(failed: Sequence[str]) -> str:
    if not failed:
        return ""
    return " **no**" if len(failed) == len(READINGS) else f" **no** {failed[0]}"


def options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--engine", choices=ENGINES, nargs="+", default=ENGINES)
    parser.add_argument("--profile", choices=PROFILES, nargs="+", default=PROFILES)
    parser.add_argument("--strike", choices=tuple(STRIKES), nargs="+", default=tuple(STRIKES))
    parser.add_argument("--arm", choices=tuple(ARMS), nargs="+", default=tuple(ARMS))
    return parser.parse_args()


if __name__ == "__main__":
    asked, core = options(), present_core()
    keys = list(product(asked.engine, asked.profile, asked.strike, asked.arm, range(asked.runs)))
    found = page(kept_runs(NAME, core, keys, play))
    print(found)  # noqa: T201 - the result
    if set(product(ENGINES, PROFILES, STRIKES, NEEDED, range(RUNS))) <= set(keys):
        write_page(PAGES / f"{NAME}.md", found, core)
