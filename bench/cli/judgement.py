"""Printed answer of the judge about a scene: verdict, margins, and the forces or the mechanism."""

from __future__ import annotations

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.model import Scene
from scenarios.statics import judge
from scenarios.statics.contact_patch import GROUND
from scenarios.statics.scene_judge import Judgement, SceneMargins

MOST_ROWS = 40
"""Greatest number of rows of a printed table. A caption states the number of further rows."""
MOVES = 1e-3
"""Ratio of the greatest component of a brick's virtual velocity to the greatest component of all bricks. At or below
this ratio the brick does not count as moving."""


def print_judgement(scene: Scene, console: Console) -> None:
    """Judge a scene and print the answer.

    Raises:
        ValueError: if bricks overlap, or a number is out of range; the message names the brick.
    """
    answer = judge(scene)
    when = "" if answer.state is None else f", {len(answer.state.present)} bricks in place at {answer.state.time:g} s"
    console.print(f"{scene.variant}: {answer.verdict}{when}", highlight=False, soft_wrap=True)
    console.print(answer.why, highlight=False, soft_wrap=True)
    if answer.margins is not None:
        console.print(_margins(scene, answer, answer.margins))
        console.print(_forces(answer))
    if len(answer.mechanism):
        console.print(_mechanism(answer))


def _margins(scene: Scene, answer: Judgement, margins: SceneMargins) -> Table:
    assert answer.state is not None
    present = answer.state.present
    weakest, first = int(margins.load_n.argmin()), int(margins.tilt_deg.argmin())
    table = _table("Margins", "of", "up to", "decided by")
    load = margins.load_n[weakest]
    weight = scene.bricks[present[weakest]].mass * float(np.linalg.norm(scene.world.gravity))
    more = "no limit" if np.isinf(load) else f"{load:.4g} N ({load / weight:.3g} of its weight)"
    table.add_row("load on one brick", more, f"brick {present[weakest]}")
    table.add_row("tilt of the ground", f"{margins.tilt_deg[first]:.3f} deg", f"brick {present[first]}")
    used = f"down to {margins.friction:.4f} of {scene.world.friction:g}"
    table.add_row("friction", used if margins.friction else "needs none", "all contacts")
    table.caption = "Equilibrium only: a drop has energy, and a wedged brick may fall earlier."
    return table


def _forces(answer: Judgement) -> Table:
    table = _table("Forces that hold it (an example)", "on", "from", "force x, y, z [N]", "friction used")
    for pair in answer.forces[:MOST_ROWS]:
        x, y, z = pair.force
        first = "ground" if pair.first == GROUND else f"brick {pair.first}"
        table.add_row(f"brick {pair.second}", first, f"{x:.4g}, {y:.4g}, {z:.4g}", f"{pair.friction_used:.3f}")
    return _counted(table, len(answer.forces))


def _mechanism(answer: Judgement) -> Table:
    assert answer.state is not None
    table = _table("Mechanism", "brick", "moves along x, y, z", "turns about x, y, z")
    speeds = np.abs(answer.mechanism).max(axis=1)
    moving = np.flatnonzero(speeds > MOVES * speeds.max())
    for row in moving[:MOST_ROWS].tolist():
        motion = [f"{part:.3g}" for part in answer.mechanism[row].tolist()]
        table.add_row(f"brick {answer.state.present[row]}", ", ".join(motion[:3]), ", ".join(motion[3:]))
    return _counted(table, len(moving))


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, caption_justify="left")
    for column in columns:
        table.add_column(column, overflow="fold")
    return table


def _counted(table: Table, count: int) -> Table:
    if count > MOST_ROWS:
        table.caption = f"{count - MOST_ROWS} more rows: scenarios.statics.judge(scene) returns all"
    return table
