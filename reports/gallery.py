"""How each stack ended, in pictures: what a page shows of its stills and replays, and a figure of some of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import matplotlib.image as mpl_image
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from reports.cells import Cell, CellKey, ordered_policies
from reports.records import TrialRecord
from reports.replay import replay_name
from reports.stills import COLOURS, still_of
from reports.tables import outcome

_INCHES, _TITLE_INCHES = 2.1, 0.3


@dataclass(frozen=True, slots=True)
class Picture:
    """How one trial ended."""

    policy: str
    href: str | None
    """Of its still, seen from the page; None if there is none."""
    told: str
    """Such as ``falls at 9 ✓``."""


@dataclass(frozen=True, slots=True)
class Shelf:
    """One stack of a scene on one engine and profile under every policy."""

    theory: str
    engine: str
    profile: str
    replay: str | None
    """Its replay, seen from the page; None if there is none."""
    pictures: tuple[Picture, ...]


def shelves(report: Path, cells: Sequence[Cell]) -> dict[str, list[Shelf]]:
    """By scene, the stacks of which a report has a replay or a still, in the order of the cells."""
    stacks: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        stacks.setdefault((cell.key.scene, cell.key.engine, cell.key.profile), []).append(cell)
    found: dict[str, list[Shelf]] = {}
    for (scene, engine, profile), those in stacks.items():
        pictures = tuple(_picture(report, cell) for cell in those)
        replay = next((href for cell in those if (href := _replay(report, cell)) is not None), None)
        if replay or any(picture.href for picture in pictures):
            shelf = Shelf(str(those[0].expectation), engine, profile, replay, pictures)
            found.setdefault(scene, []).append(shelf)
    return found


def gallery_figure(stills: Path, cells: Sequence[Cell], engine: str, profile: str, scenes: Sequence[str]) -> Figure:
    """Stills of one engine: a row a scene, a column a policy.

    Args:
        stills: folder that holds the stills.
        cells: of the study.
        engine: shown.
        profile: shown.
        scenes: shown, in this order.

    Raises:
        FileNotFoundError: if one of the stills is missing.
    """
    by_key = {cell.key: cell for cell in cells}
    policies = ordered_policies(key.policy for key in by_key if key[1:3] == (engine, profile))
    lines = [[by_key[CellKey(scene, engine, profile, policy)].draws[0] for policy in policies] for scene in scenes]
    shown = [_without_margins([mpl_image.imread(still_of(stills, trial)) for trial in line]) for line in lines]
    heights = [_INCHES * line[0].shape[0] / line[0].shape[1] + _TITLE_INCHES for line in shown]
    figure = Figure((_INCHES * len(policies), sum(heights) + _TITLE_INCHES), layout="constrained")
    panels = figure.subplots(len(scenes), len(policies), squeeze=False, height_ratios=heights)
    for panel, trial, picture in zip(panels.ravel(), chain(*lines), chain(*shown), strict=True):
        panel.imshow(picture, interpolation="antialiased")
        panel.set_axis_off()
        panel.set_title(f"{trial.policy}: {outcome([trial])}", fontsize=9)
    states = [Patch(color=(r / 255, g / 255, b / 255), label=state) for state, (r, g, b) in COLOURS.items()]
    figure.legend(handles=states, loc="outside lower center", ncols=len(states), frameon=False, fontsize=9)
    return figure


def _without_margins(pictures: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Pictures of one height without the rows that are empty in all of them, shape (height, width, 4) each."""
    drawn = np.flatnonzero(np.any([picture[..., 3].any(axis=1) for picture in pictures], axis=0))
    return [picture[drawn[0] : drawn[-1] + 1] if len(drawn) else picture for picture in pictures]


def _picture(report: Path, cell: Cell) -> Picture:
    trial = _first(report, cell)
    href = f"stills/{still_of(Path(), trial)}" if still_of(report / "stills", trial).exists() else None
    return Picture(cell.key.policy, href, outcome([trial]))


def _first(report: Path, cell: Cell) -> TrialRecord:
    """The trial that was drawn, else the first."""
    drawn = (trial for trial in cell.draws if still_of(report / "stills", trial).exists())
    return next(drawn, cell.draws[0])


def _replay(report: Path, cell: Cell) -> str | None:
    names = (f"replays/{replay_name(trial)}.html" for trial in cell.draws)
    return next((name for name in names if (report / name).exists()), None)
