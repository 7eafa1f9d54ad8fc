"""The heat map of a study: a row per set-up in the order of the ranking, a column per scene, the state in each cell.

A study of many scenes has a map by family of scenes first, which fits on a screen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reports.page.scene_names import OWN_SCENE
from reports.statistics.groups import Group, grouped
from reports.statistics.pairs import SetUp
from reports.statistics.ranking import Ranking
from reports.statistics.states import STATES, State, states_of
from reports.statistics.success_rates import MISSES
from reports.tables.verdict import STATE_WORDS, counted

MISSING = "missing"
"""Class of a cell without a trial."""
MOST_SCENES = 30
"""Most scenes of a study without a map by family: about the columns that fit on a screen."""


@dataclass(frozen=True, slots=True)
class Column:
    """A scene, or a family of scenes."""

    name: str
    """Its name in the comparison."""
    family: str
    """Name of its scenario; empty for a scene of the user's own."""
    rest: str
    """The name without the family."""
    is_first: bool
    """True for the first column of its family."""
    note: str
    """The outcome that theory demands, or the number of scenes."""


@dataclass(frozen=True, slots=True)
class Cell:
    """The outcomes of a set-up in a column."""

    state: str
    """State that the cell shows, or ``MISSING``."""
    count: str
    """Number of builds in that state if others are in another; else empty."""
    words: str
    """What it shows, in words."""


@dataclass(frozen=True, slots=True)
class Row:
    """A set-up."""

    set_up: SetUp
    right: str
    """Correct builds of all: ``52/53``."""
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class HeatMap:
    """A whole map."""

    by: str
    """What a column is, as a filter of the comparison: ``scene``, or ``text`` for a family."""
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    legend: tuple[tuple[str, str], ...]
    """The states that occur, in order, with their words."""


def heat_maps(groups: Sequence[Group], ranking: Ranking, names: Mapping[str, str]) -> list[HeatMap]:
    """Return the map by scene; of a study of more than ``MOST_SCENES``, the map by family before it.

    Args:
        groups: all groups of the study.
        ranking: their ranking, whose order the rows have.
        names: names of the scenes by id.
    """
    scenes = grouped(groups, "key.scene")
    by_scene = _map("scene", scenes, _scene_columns([group for (group, *_) in scenes.values()], names), ranking)
    families = grouped(groups, "scenario")
    if len(scenes) <= MOST_SCENES or len(families) == 1:
        return [by_scene]
    columns = [
        Column(name, "", name, False, f"{len({group.key.scene for group in members})} scenes")
        for (name,), members in families.items()
    ]
    return [_map("text", families, columns, ranking), by_scene]


def _map(by: str, members: Mapping[tuple[str], list[Group]], columns: Sequence[Column], ranking: Ranking) -> HeatMap:
    states: dict[tuple[SetUp, int], Counter[State]] = {}
    for number, groups in enumerate(members.values()):
        for group in groups:
            states.setdefault((SetUp(*group.key[1:]), number), Counter()).update(states_of(group))
    rows = tuple(
        Row(
            place.set_up,
            f"{place.right}/{len(ranking.units)}",
            tuple(_cell(states.get((place.set_up, number))) for number in range(len(columns))),
        )
        for place in ranking.places
    )
    shown = {cell.state for row in rows for cell in row.cells}
    legend = [(str(state), STATE_WORDS[state][0]) for state in STATES if state in shown]
    legend += [(MISSING, "no trial")] if MISSING in shown else []
    return HeatMap(by, tuple(columns), rows, tuple(legend))


def _scene_columns(groups: Sequence[Group], names: Mapping[str, str]) -> list[Column]:
    columns: list[Column] = []
    for group in groups:
        name = names[group.key.scene]
        family = "" if group.scenario == OWN_SCENE else group.scenario
        rest = name.removeprefix(family).removeprefix("-") if family else name
        is_first = bool(family) and not any(column.family == family for column in columns[-1:])
        columns.append(Column(name, family, rest, is_first, str(group.expectation)))
    return columns


def _cell(states: Counter[State] | None) -> Cell:
    if not states:
        return Cell(MISSING, "", "no trial")
    state, builds = _shown(states), states.total()
    if builds == 1:
        return Cell(state, "", STATE_WORDS[state][0])
    count = states[state]
    return Cell(state, str(count) if count < builds else "", f"{counted(count, state)} of {builds}")


def _shown(states: Counter[State]) -> State:
    """Return the state that stands for several builds: the most frequent error, without one any but correct."""
    for candidates in (MISSES, [state for state in STATES if state != "right"]):
        present = [state for state in candidates if states.get(state)]
        if present:
            return max(present, key=lambda state: states[state])
    return "right"
