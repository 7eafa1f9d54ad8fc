"""How each stack ended, in pictures: what a page shows of its stills and replays, and a figure of some of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib.image as mpl_image
from matplotlib.figure import Figure

from reports.cells import Cell, CellKey, ordered_policies
from reports.records import TrialRecord
from reports.replay import replay_name
from reports.stills import still_of
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
    size = (_INCHES * len(policies), (_INCHES + _TITLE_INCHES) * len(scenes))
    figure = Figure(size, layout="constrained")
    panels = figure.subplots(len(scenes), len(policies), squeeze=False)
    for scene, line in zip(scenes, panels, strict=True):
        for policy, panel in zip(policies, line, strict=True):
            trial = by_key[CellKey(scene, engine, profile, policy)].draws[0]
            panel.imshow(mpl_image.imread(still_of(stills, trial)), interpolation="antialiased")
            panel.set_axis_off()
            panel.set_title(f"{policy}: {outcome([trial])}", fontsize=9)
    return figure


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
