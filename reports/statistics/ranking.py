"""The ranking of set-ups (engine, profile and policy) by correct outcomes and then by frame time.

A unit is one seed of a pair of scenes, or of a scene without a partner, with a known answer. A unit of a pair is right
only if both trials are right, so that a policy that freezes everything gets no pair right. The ranking counts all units
of the study for every set-up. A unit that a set-up did not play or decide is not right.

Reference engines are not products. Therefore they have a list of their own, and no place in the ranking.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from reports.records.trial import TrialRecord
from reports.statistics.groups import Group, grouped
from reports.statistics.pairs import SetUp, are_opposed
from reports.statistics.scores import SlowestScene, middle, slowest_scene
from reports.statistics.states import State, state_of
from reports.statistics.success_rates import MISSES

NOT_DECIDED: tuple[State, ...] = ("not_playable", "undecided")
"""States of a trial in which its pair is neither right nor wrong. The pair then has the first of these states that one
of its trials has."""


class Unit(NamedTuple):
    """Unit of the ranking: one seed of a pair, or of a scene without a partner."""

    name: str
    """Id of the pair or of the scene."""
    is_pair: bool
    seed: int


class Creep(NamedTuple):
    """Creep of the brick with the greatest ratio of creep to creep limit."""

    m_s: float
    """Creep [m/s]."""
    limit_m_s: float
    """Creep limit of the brick [m/s]."""
    is_uncertain: bool = False
    """True if the creep exceeds its limit, but the stack counts as still, because the interval of the creep reaches
    below the limit."""
    error_m_s: float | None = None
    """Half width of the 95 % interval of the creep [m/s]; None without a measured interval."""


@dataclass(frozen=True, slots=True)
class Place:
    """Place of a set-up in the ranking, with its counts and costs."""

    set_up: SetUp
    states: Mapping[State, int]
    """Number of units by state; a pair with several kinds of error counts once for each kind."""
    right: int
    """Number of units that are right."""
    wrong: int
    """Number of units with an error."""
    missing: int
    """Number of units of the study for which the set-up lacks a record."""
    frame_ms: float | None
    """Median over scenes of the median frame time [ms], without scenes whose times come from several machines; None if
    no scene remains."""
    slowest: SlowestScene | None
    """The scene with the greatest 99th percentile of the frame time, without scenes whose times come from several
    machines; None if no scene remains."""
    creep: Creep | None
    """Creep with the greatest ratio to its limit, of all stacks that must stand and did not fall. Stacks in neutral
    balance do not count. None without a measured creep."""


@dataclass(frozen=True)
class Ranking:
    """Ranking of all set-ups of a study."""

    units: frozenset[Unit]
    """Units with a known answer."""
    outcomes: frozenset[str]
    """Outcomes that the units demand: ``stand``, ``fall`` or both."""
    places: tuple[Place, ...]
    """Places of the set-ups of products, the best first."""
    references: tuple[Place, ...] = ()
    """Places of the set-ups of reference engines in a list of their own, the best first."""

    @cached_property
    def pairs(self) -> int:
        """Number of different pairs."""
        return len({unit.name for unit in self.units if unit.is_pair})

    @cached_property
    def scenes(self) -> int:
        """Number of different scenes without a partner."""
        return len({unit.name for unit in self.units if not unit.is_pair})

    @cached_property
    def all_right(self) -> tuple[Place, ...]:
        """Places of the set-ups that are right in all units, the least frame time first."""
        return tuple(place for place in self.places if place.right == len(self.units))


def rank(groups: Sequence[Group], references: Collection[str] = ()) -> Ranking:
    """Return the ranking of the set-ups of all groups.

    Args:
        groups: the groups of a study.
        references: names of the reference engines, which have no place.

    The sort keys, in this order:

    - the number of right units, in descending order;
    - the number of wrong units, in ascending order;
    - the frame time, in ascending order, with missing times last;
    - the order of the groups.
    """
    sides = _sides(groups)
    by_set_up = grouped(groups, "key.engine", "key.profile", "key.policy")
    states = {SetUp(*key): dict(_units(members, sides)) for key, members in by_set_up.items()}
    units = frozenset(unit for of_set_up in states.values() for unit in of_set_up)
    places = [_place(set_up, of_set_up, len(units), by_set_up[set_up]) for set_up, of_set_up in states.items()]
    outcomes = frozenset(group.expectation.outcome for group in groups) - {"study"}
    ordered = sorted(places, key=_order)
    return Ranking(
        units,
        outcomes,
        tuple(place for place in ordered if place.set_up.engine not in references),
        tuple(place for place in ordered if place.set_up.engine in references),
    )


def _sides(groups: Sequence[Group]) -> dict[str, frozenset[str]]:
    """Return the scenes of each pair with opposite demands, by the id of the pair."""
    pairs = grouped([group for group in groups if group.pair], "pair")
    return {
        name: frozenset(group.key.scene for group in members)
        for (name,), members in pairs.items()
        if are_opposed([group.expectation for group in members])
    }


def _units(groups: Sequence[Group], sides: Mapping[str, frozenset[str]]) -> Iterator[tuple[Unit, frozenset[State]]]:
    """Yield the units of one set-up, with the states of each unit."""
    for (pair,), members in grouped(groups, "pair").items():
        if pair not in sides:
            for trial in (trial for group in members for trial in group.draws):
                if trial.expectation.outcome != "study":
                    yield Unit(trial.scene, False, trial.seed), frozenset({state_of(trial)})
        elif {group.key.scene for group in members} == sides[pair]:
            for seed in sorted(set.intersection(*(set(group.by_seed) for group in members))):
                build = [group.by_seed[seed][0] for group in members]
                if are_opposed([trial.expectation for trial in build]):
                    yield Unit(pair, True, seed), _states(build)


def _states(build: Sequence[TrialRecord]) -> frozenset[State]:
    """Return the states of a unit of a pair.

    The states, in this order:

    - ``not_playable`` or ``undecided`` if a trial of the unit has this state;
    - ``right`` if all trials are right;
    - else the kinds of error of the trials.
    """
    states = {state_of(trial) for trial in build}
    undecided = next((state for state in NOT_DECIDED if state in states), None)
    if undecided is not None:
        return frozenset({undecided})
    return frozenset(states if states == {"right"} else states - {"right"})


def _place(set_up: SetUp, units: Mapping[Unit, frozenset[State]], total: int, groups: Sequence[Group]) -> Place:
    return Place(
        set_up,
        Counter(state for states in units.values() for state in states),
        right=sum(states == {"right"} for states in units.values()),
        wrong=sum(not states.isdisjoint(MISSES) for states in units.values()),
        missing=total - len(units),
        frame_ms=middle(groups, "frame_ms_p50"),
        slowest=slowest_scene(groups),
        creep=_creep(groups),
    )


def _creep(groups: Sequence[Group]) -> Creep | None:
    """Return the creep with the greatest ratio to its limit; None without a measured creep.

    Stacks with the verdict ``none``, such as a stack in neutral balance, do not count, because such stacks may creep.
    """
    measured = [
        Creep(trial.creep_m_s, trial.creep_limit_m_s, trial.creep_is_uncertain, trial.creep_error_m_s)
        for group in groups
        for trial in group.draws
        if trial.creep_m_s is not None and trial.creep_limit_m_s
        if trial.expectation.outcome == "stand" and trial.verdict != "none"
    ]
    return max(measured, key=lambda creep: creep.m_s / creep.limit_m_s, default=None)


def _order(place: Place) -> tuple[int, int, float]:
    return -place.right, place.wrong, math.inf if place.frame_ms is None else place.frame_ms
