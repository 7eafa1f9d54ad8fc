"""The gallery of a page: final states of stacks with their stills and replays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.records.folder import replay_name, still_of
from reports.records.trial import TrialRecord
from reports.statistics.groups import Group, grouped
from reports.tables.outcomes import outcome


@dataclass(frozen=True, slots=True)
class Picture:
    """Picture of the final state of one trial."""

    policy: str
    href: str | None
    """Link to the still, relative to the page; None without a still."""
    outcome: str
    """Outcome of the trial, such as ``falls at 9 ✓``."""


@dataclass(frozen=True, slots=True)
class Shelf:
    """Pictures of the final states of one scene on one engine and profile under every policy."""

    theory: str
    """Expected outcome in words."""
    engine: str
    profile: str
    replay: str | None
    """Link to the replay, relative to the page; None without a replay."""
    pictures: tuple[Picture, ...]
    """One picture per policy, in the order of the groups."""


def shelves(report: Path, groups: Sequence[Group]) -> dict[str, list[Shelf]]:
    """Return the shelves with a replay or a still in the report, by scene, in the order of the groups."""
    stacks = grouped(groups, "key.scene", "key.engine", "key.profile")
    found: dict[str, list[Shelf]] = {}
    for (scene, engine, profile), those in stacks.items():
        pictures = tuple(_picture(report, group) for group in those)
        replay = next((href for group in those if (href := _replay(report, group)) is not None), None)
        if replay or any(picture.href for picture in pictures):
            shelf = Shelf(str(those[0].expectation), engine, profile, replay, pictures)
            found.setdefault(scene, []).append(shelf)
    return found


def _picture(report: Path, group: Group) -> Picture:
    trial = _first(report, group)
    href = f"stills/{still_of(Path(), trial)}" if still_of(report / "stills", trial).exists() else None
    return Picture(group.key.policy, href, outcome([trial]))


def _first(report: Path, group: Group) -> TrialRecord:
    """Return the first of a group's draws that has a still, or the first draw if none has a still."""
    drawn = (trial for trial in group.draws if still_of(report / "stills", trial).exists())
    return next(drawn, group.draws[0])


def _replay(report: Path, group: Group) -> str | None:
    names = (f"replays/{replay_name(trial)}.html" for trial in group.draws)
    return next((name for name in names if (report / name).exists()), None)
