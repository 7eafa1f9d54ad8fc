"""Ground that tilts slowly under frozen stacks, as seen by who stands on it: gravity turns.

    uv run python -m tests.stability_core.tilt [--engine E] [--profile P] [--stack S]

writes ``docs/results/loads/tilt.md`` if nothing is left out; it goes on from where an earlier run was stopped.

Each stack comes to rest in the engine, by its own contacts, and is frozen by them. Gravity turns by ``FAST`` until one
degree before the limit, then by ``SLOW``. Limits of exact statics:

    column along its planks:    atan(mu) = 24.228 deg, it slides
    column across them:         atan(width / height) = 16.699 deg, it tips
    V:                          the judge (``scenarios.statics.truth``), with either normal of the ridge

*Onset* is the angle at which a plank is 1 % of a thickness off the place where it stood before the tilt, or turned by
0.5 deg. *Own exact* is the angle at which no forces in the Coulomb cones balance the planks, at the contacts that the
engine showed in the last frame before each pair was frozen. *Wake* is the angle at which the core first woke a plank.

The extension passes if it wakes within 0.05 deg of own exact, and if the onset with it lies within 0.25 deg of the
later of exact and the onset alone.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from adapters import open_engine
from adapters.base import Simulation
from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from bench.trial.gravity import turned
from bench.trial.onset_monitor import MOVED, TURNED
from bench.trial.own_contacts import OwnContacts, limit_slope
from scenarios.model import Brick, Vector, World
from scenarios.planks import MU, THICKNESS, WIDTH
from scenarios.scenes.card_house import card_house
from scenarios.scenes.plank_tower import plank_tower
from scenarios.statics.contact_patch import Patch, Ridge, contact_patches
from stability_core import StabilityExtension
from tests.stability_core.loaded_stacks import PAGES, kept_runs, table

ENGINES = ("bullet", "mujoco", "dart", "physx", "rapier")
PROFILES = ("game", "tuned")
POLICIES = ("alone", "equilibrium")
PLANKS = 10
FAST, SLOW = 5.0, 0.1
"""Speeds of the tilt [deg/s]."""
SLOWED, BEYOND = 1.0, 1.0
"""From how far below the limit on gravity turns slowly, and how far beyond it goes on [deg]."""
REST_S, LONGEST_REST_S = 1.0, 5.0
"""How long a stack stands alone before the tilt [s], and how long the extension may take to freeze all of it."""
NEAR_EXACT, NEAR_ONSET = 0.05, 0.25
"""Tolerances [deg]."""
RIDGES: tuple[Ridge, ...] = ("bisector", "face")
NAME = "tilt"


class Tilted(NamedTuple):
    """A stack and the direction in which its ground goes down."""

    bricks: tuple[Brick, ...]
    axis: tuple[float, float]
    """About which a table would turn by the right-hand rule."""
    exact: float
    """Limit [deg]; infinite to ask the judge."""

    def gravity(self, degrees: float) -> Vector:
        """Return gravity [m/s2] on ground that is tilted by ``degrees``."""
        return turned(World().gravity, self.axis, -math.radians(degrees))


def _v() -> tuple[Brick, ...]:
    return card_house(storeys=1).bricks


STACKS = {
    "column along": Tilted(plank_tower(levels=PLANKS).bricks, (0.0, 1.0), math.degrees(math.atan(MU))),
    "column across": Tilted(
        plank_tower(levels=PLANKS).bricks, (-1.0, 0.0), math.degrees(math.atan(WIDTH / (PLANKS * THICKNESS)))
    ),
    "V along": Tilted(_v(), (0.0, 1.0), math.inf),
    "V across": Tilted(_v(), (-1.0, 0.0), math.inf),
}


def limit_angle(stack: Tilted, patches: Sequence[Patch], centers: np.ndarray) -> float:
    """Return the angle [deg] up to which forces in the Coulomb cones of ``patches`` hold the stack; NaN without one."""
    limit = limit_slope(stack.bricks, World(friction=MU), stack.axis, patches, centers)
    return math.nan if limit is None else limit


def exact_angles(stack: Tilted) -> list[float]:
    """Return the limits [deg] by exact statics with either normal of the ridge; one that is known without."""
    if math.isfinite(stack.exact):
        return [stack.exact]
    centers = np.array([brick.position for brick in stack.bricks])
    return [limit_angle(stack, contact_patches(stack.bricks, ridge=ridge), centers) for ridge in RIDGES]


def play(engine: str, profile: str, name: str, policy: str) -> dict[str, Any]:
    """Play one run and return its figures [deg]; None for what did not happen."""
    stack = STACKS[name]
    exact = exact_angles(stack)
    simulation = open_engine(engine, profile, world=World(friction=MU), expected=stack.bricks)
    try:
        for brick in stack.bricks:
            simulation.spawn(brick)
        extension = None if policy == "alone" else StabilityExtension(simulation.port, policy)
        seen = OwnContacts()
        frozen = _rest(simulation, extension, seen)
        own = limit_angle(stack, seen.patches, simulation.poses()[1]) if extension else math.nan
        start = np.nanmin([*exact, own]) - SLOWED
        onset, wake = _tilt(simulation, extension, stack, float(start), max(exact) + BEYOND)
    finally:
        simulation.close()
    figures = {"exact": min(exact), "other": max(exact), "own": own, "onset": onset, "wake": wake}
    return {"frozen": frozen, **{key: None if math.isnan(value) else value for key, value in figures.items()}}


def _rest(simulation: Simulation, extension: StabilityExtension | None, seen: OwnContacts) -> bool:
    """Let the stack come to rest; return whether all of it was frozen."""
    frame_s = simulation.info.frame_s
    if extension is None:
        for _ in range(round(REST_S / frame_s)):
            simulation.step(frame_s)
        return False
    for _ in range(round(LONGEST_REST_S / frame_s)):
        simulation.step(frame_s)
        seen.see(simulation.port.contacts())
        extension.update(frame_s)
        if len(simulation.frozen) == len(simulation.bricks):
            return True
    return False


def _tilt(
    simulation: Simulation, extension: StabilityExtension | None, stack: Tilted, slow_from: float, end: float
) -> tuple[float, float]:
    """Turn gravity until the onset; return its angle [deg] and that of the first wake, NaN for what did not happen."""
    frame_s = simulation.info.frame_s
    _, position, quaternion = simulation.poses()
    degrees, wake = 0.0, math.nan
    while degrees < end:
        degrees += (FAST if degrees < slow_from else SLOW) * frame_s
        simulation.set_gravity(stack.gravity(degrees))
        if extension is not None:
            extension.gravity = stack.gravity(degrees)
        simulation.step(frame_s)
        if extension is not None and extension.update(frame_s).woken and math.isnan(wake):
            wake = degrees
        _, now, turn = simulation.poses()
        moved = float(np.linalg.norm(now - position, axis=1).max())
        angle = 2 * math.acos(min(1.0, float(np.abs((turn * quaternion).sum(axis=1)).min())))
        if moved > MOVED * THICKNESS or angle > TURNED:
            return degrees, wake
    return math.nan, wake


def passes(alone: dict[str, Any], steered: dict[str, Any]) -> dict[str, bool]:
    """Compare a run with the extension with exact statics, and with the run alone; what did not happen is too late."""
    wake, own, onset = steered["wake"], steered["own"], steered["onset"]
    passed = {"wake": wake is not None and own is not None and abs(wake - own) <= NEAR_EXACT}
    if alone["onset"] is not None:
        due = max(steered["exact"], alone["onset"])
        passed["onset"] = onset is not None and abs(onset - due) <= NEAR_ONSET
    return passed


def page(rows: Sequence[dict[str, Any]]) -> str:
    """Return the results as a page."""
    runs = {tuple(row["key"]): row for row in rows}
    lines = [
        "# Ground that tilts under frozen stacks",
        "",
        f"Made by `uv run python -m tests.stability_core.{NAME}`, whose docstring says how each run is made, what each",
        "column means and what passes. Angles in degrees; - did not happen; what does not pass is marked **no**.",
        "",
    ]
    for name, stack in STACKS.items():
        cells = [_cells(key, runs) for key in runs if key[2:] == (name, "equilibrium")]
        limits = " and ".join(f"{angle:.3f}" for angle in exact_angles(stack))
        lines += [f"## {name[0].upper()}{name[1:]}: exact {limits}", ""]
        head = ["engine", "profile", "frozen", "own exact", "wake", "onset", "onset alone"]
        lines += [*table(head, cells), ""]
    return "\n".join(lines)


def _cells(key: tuple[str, ...], runs: dict[tuple[str, ...], dict[str, Any]]) -> list[str]:
    engine, profile, name, _ = key
    steered, alone = runs[key], runs.get((engine, profile, name, "alone"))
    passed = passes(alone, steered) if alone else {}
    cells = [engine, profile, "all" if steered["frozen"] else "not all", _angle(steered["own"])]
    cells += [_angle(steered[figure]) + ("" if passed.get(figure, True) else " **no**") for figure in ("wake", "onset")]
    return [*cells, _angle(alone["onset"]) if alone else ""]


def _angle(degrees: float | None) -> str:
    return "-" if degrees is None else f"{degrees:.2f}"


def options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--engine", choices=ENGINES, nargs="+", default=ENGINES)
    parser.add_argument("--profile", choices=PROFILES, nargs="+", default=PROFILES)
    parser.add_argument("--stack", choices=tuple(STACKS), nargs="+", default=tuple(STACKS))
    return parser.parse_args()


if __name__ == "__main__":
    asked, core = options(), present_core()
    keys = list(product(asked.engine, asked.profile, asked.stack, POLICIES))
    found = page(kept_runs(NAME, core, keys, play))
    print(found)  # noqa: T201 - the result
    if len(keys) == len(ENGINES) * len(PROFILES) * len(STACKS) * len(POLICIES):
        write_page(PAGES / f"{NAME}.md", found, core)
