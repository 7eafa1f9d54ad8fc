"""The heat map of a study: a row per set-up in the order of the ranking, a column per scene, the state in each cell.

A study of more than ``MOST_SCENES`` scenes of several families also has a map by family. The map by family comes first,
because this map fits on a screen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reports.page.scene_names import OWN_SCENE
from reports.statistics.groups import Group, grouped
from reports.statistics.pairs import SetUp
from reports.statistics.ranking import Ranking, rank
from reports.statistics.states import STATES, State, states_of
from reports.statistics.success_rates import MISSES
from reports.tables.verdict import STATE_WORDS, counted
from reports.tables.wording import quantity

MISSING = "missing"
"""Name of the state of a cell without a trial, also as a class in the style sheet of the page."""
MOST_SCENES = 30
"""Greatest number of scenes of a study without a map by family, because about 30 columns fit on a screen."""


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a heat map: a scene, or a family of scenes."""

    name: str
    """Name of the scene or family in the comparison."""
    family: str
    """Name of the scenario of a scene; empty for a user's own scene, and for a family."""
    scenario: str
    """Name of the scenario of a scene, or of the family, by which the page filters columns."""
    rest: str
    """Name without the family. If the name is the family alone, the text is empty in the first column of the family,
    and ``unvaried`` in other columns."""
    is_first: bool
    """True for the first of neighbouring columns of one family; False for own scenes and for families."""
    note: str
    """Outcome that theory demands of a scene, or the number of scenes of a family."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Cell of a heat map: the outcomes of a set-up in a column."""

    state: str
    """State that the cell shows, or ``MISSING``."""
    count: str
    """Number of builds in that state if some builds have another state; else empty."""
    words: str
    """Description of the cell in words."""


@dataclass(frozen=True, slots=True)
class Row:
    """Row of a heat map: a set-up with its cells."""

    set_up: SetUp
    right: str
    """Right units over all units, such as ``52/53``."""
    cells: tuple[Cell, ...]
    right_in: Mapping[str, str]
    """Right units over all units of each family alone, such as ``5/6``, by the name of the family; without families
    that have no units."""


@dataclass(frozen=True, slots=True)
class HeatMap:
    """Heat map with its columns, rows and legend."""

    by: str
    """Name of the comparison's filter that selects the rows of one column of this map: ``scene`` if columns are scenes,
    ``family`` if columns are families."""
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    right: tuple[int, ...]
    """Number of set-ups that are right in all builds of each column."""
    legend: tuple[tuple[str, str], ...]
    """States that occur in the map, each with its description, in the order of ``STATES``."""


def heat_maps(groups: Sequence[Group], ranking: Ranking, names: Mapping[str, str]) -> list[HeatMap]:
    """Return the map by scene, after a map by family if more than ``MOST_SCENES`` scenes belong to several families.

    Args:
        groups: all groups of the study.
        ranking: ranking of the study, which gives the order of the rows.
        names: names of the scenes, by id.
    """
    scenes = grouped(groups, "key.scene")
    families = grouped(groups, "scenario")
    right_in = _right_in({name: members for (name,), members in families.items()})
    scene_columns = _scene_columns([group for (group, *_) in scenes.values()], names)
    by_scene = _map("scene", scenes, scene_columns, ranking, right_in)
    if len(scenes) <= MOST_SCENES or len(families) == 1:
        return [by_scene]
    columns = [
        Column(name, "", name, name, False, quantity(len({group.key.scene for group in members}), "scene"))
        for (name,), members in families.items()
    ]
    return [_map("family", families, columns, ranking, right_in), by_scene]


def _right_in(families: Mapping[str, Sequence[Group]]) -> dict[SetUp, dict[str, str]]:
    """Return right units over all units, by set-up and by the families with units that the set-up played."""
    right: dict[SetUp, dict[str, str]] = {}
    for name, members in families.items():
        ranking = rank(members)
        for place in ranking.places if ranking.units else ():
            right.setdefault(place.set_up, {})[name] = f"{place.right}/{len(ranking.units)}"
    return right


def _map(
    by: str,
    members: Mapping[tuple[str], list[Group]],
    columns: Sequence[Column],
    ranking: Ranking,
    right_in: Mapping[SetUp, Mapping[str, str]],
) -> HeatMap:
    states: dict[tuple[SetUp, int], Counter[State]] = {}
    for number, groups in enumerate(members.values()):
        for group in groups:
            states.setdefault((SetUp(*group.key[1:]), number), Counter()).update(states_of(group))
    rows = tuple(
        Row(
            place.set_up,
            f"{place.right}/{len(ranking.units)}",
            tuple(_cell(states.get((place.set_up, number))) for number in range(len(columns))),
            right_in.get(place.set_up, {}),
        )
        for place in (*ranking.places, *ranking.references)
    )
    shown = {cell.state for row in rows for cell in row.cells}
    legend = [(str(state), STATE_WORDS[state][0]) for state in STATES if state in shown]
    legend += [(MISSING, "no trial")] if MISSING in shown else []
    right = [sum(row.cells[number].state == "right" for row in rows) for number in range(len(columns))]
    return HeatMap(by, tuple(columns), rows, tuple(right), tuple(legend))


def _scene_columns(groups: Sequence[Group], names: Mapping[str, str]) -> list[Column]:
    columns: list[Column] = []
    for group in groups:
        name = names[group.key.scene]
        family = "" if group.scenario == OWN_SCENE else group.scenario
        rest = name.removeprefix(family).removeprefix("-") if family else name
        is_first = bool(family) and not any(column.family == family for column in columns[-1:])
        rest = rest if rest or is_first else "unvaried"
        columns.append(Column(name, family, group.scenario, rest, is_first, str(group.expectation)))
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
    """Return the state that a cell of several builds shows.

    The function returns the first of these states that occurs:

    - the most frequent error;
    - the most frequent state that is not ``right``;
    - ``right``.
    """
    for candidates in (MISSES, [state for state in STATES if state != "right"]):
        present = [state for state in candidates if states.get(state)]
        if present:
            return max(present, key=lambda state: states[state])
    return "right"
