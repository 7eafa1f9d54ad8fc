"""Pairs of scenes: one must stand, the other must fall, and little but what decides differs.

Only a pair with both sides right counts: glue holds up the one that must fall, jelly lets down the one that must stand,
and each alone gets half of all trials right.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from reports.cells import Cell, ordered_policies
from reports.intervals import Estimate
from reports.records import CENSORED, TrialRecord, Verdict
from reports.shares import MISSES, Shares, count, shares
from reports.tables import NOTHING, Table
from reports.wording import percent
from scenarios.model import Expectation

ALL = "all"
"""Stands for all families together."""
_LETTERS = {"false_stand": "s", "false_collapse": "c", "failed": "f"}


@dataclass(frozen=True, slots=True)
class Pair:
    """The scenes of a pair on one engine and profile under one policy."""

    name: str
    family: str
    """Name of the scenario of which its scenes are variants."""
    judged: tuple[frozenset[Verdict], ...]
    """Verdicts of both sides, once for each seed at which theory can judge both."""
    undecided: int
    """Seeds at which it cannot: a side was stopped by the time limit, is impossible on the engine, or was built so
    near its limit that theory does not say."""


class SetUp(NamedTuple):
    """Who built the pairs."""

    engine: str
    profile: str
    policy: str


class PairRow(NamedTuple):
    """The pairs of one family, or of all, on one engine and profile under one policy."""

    set_up: SetUp
    family: str
    shares: Shares | None
    """None if there was nothing to judge."""
    undecided: int


def pairs_of(cells: Sequence[Cell]) -> list[Pair]:
    """The pairs among the cells of one engine, profile and policy; what lacks its partner is none."""
    sides: dict[str, list[Cell]] = {}
    for cell in cells:
        if cell.pair:
            sides.setdefault(cell.pair, []).append(cell)
    return [_pair(name, those) for name, those in sides.items() if are_opposed([cell.expectation for cell in those])]


def are_opposed(expectations: Sequence[Expectation]) -> bool:
    """Tell whether scenes ask for opposite things: one to stand and one to fall, or one to stand for a time first.

    A prebuilt stack must stand until a brick is taken, and then fall; its partner must fall at once.
    """
    outcomes = {one.outcome for one in expectations}
    stands_first = {one.not_before_s > 0.0 for one in expectations if one.outcome == "fall"}
    return "study" not in outcomes and (outcomes == {"stand", "fall"} or stands_first == {True, False})


def pair_shares(pairs: Sequence[Pair]) -> Shares | None:
    """Shares of the pairs' builds, a pair being what the bootstrap draws; None if none could be judged."""
    return shares([pair.judged for pair in pairs])


def pair_rows(cells: Sequence[Cell]) -> list[PairRow]:
    """All pairs of each set-up, then those of each family; empty if the study has no pairs."""
    groups: dict[SetUp, list[Cell]] = {}
    for cell in cells:
        groups.setdefault(SetUp(cell.key.engine, cell.key.profile, cell.key.policy), []).append(cell)
    rows = []
    for set_up in _in_order(groups):
        pairs = pairs_of(groups[set_up])
        for family in (ALL, *dict.fromkeys(pair.family for pair in pairs)) if pairs else ():
            those = [pair for pair in pairs if family in (ALL, pair.family)]
            rows.append(PairRow(set_up, family, pair_shares(those), sum(pair.undecided for pair in those)))
    return rows


def pair_tables(rows: Sequence[PairRow]) -> list[Table]:
    """The headline and the same by family; none if there are no pairs."""
    return [_headline(rows), _by_family(rows)] if rows else []


def pairs_csv(rows: Sequence[PairRow]) -> str:
    """Every share with the ends of its interval, a line a row."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ("right", *MISSES)
    ends = [f"{name}{end}" for name in names for end in ("", "_low", "_high")]
    writer.writerow([*SetUp._fields, "family", "judged", "undecided", *ends])
    for row in rows:
        estimates = [getattr(row.shares, name) for name in names] if row.shares is not None else []
        values = [value for one in estimates for value in (one.value, one.low, one.high)]
        judged = row.shares.n if row.shares is not None else 0
        writer.writerow([*row.set_up, row.family, judged, row.undecided, *values])
    return text.getvalue()


def _pair(name: str, sides: Sequence[Cell]) -> Pair:
    seeds = sorted(set.intersection(*({trial.seed for trial in side.draws} for side in sides)))
    builds = [[side.by_seed[seed][0] for side in sides] for seed in seeds]
    judged = [build for build in builds if _can_be_judged(build)]
    verdicts = tuple(frozenset(trial.verdict for trial in build) for build in judged)
    return Pair(name, sides[0].scenario, verdicts, len(builds) - len(judged))


def _can_be_judged(build: Sequence[TrialRecord]) -> bool:
    """Whether theory judges all sides of a build, and asks for opposite things."""
    decided = all(trial.verdict != "none" and trial.status not in CENSORED for trial in build)
    return decided and are_opposed([trial.expectation for trial in build])


def _in_order(groups: dict[SetUp, list[Cell]]) -> list[SetUp]:
    """Engines and profiles as they come, policies in their usual order."""
    engines = list(dict.fromkeys((set_up.profile, set_up.engine) for set_up in groups))
    policies = ordered_policies(set_up.policy for set_up in groups)
    return sorted(groups, key=lambda one: (engines.index((one.profile, one.engine)), policies.index(one.policy)))


def _headline(rows: Sequence[PairRow]) -> Table:
    told = [
        (*row.set_up, _counted(row.shares), *(_percent(row.shares, name) for name in ("right", *MISSES)), _some(row))
        for row in rows
        if row.family == ALL
    ]
    header = (*SetUp._fields, "pairs", "right", "false stand", "false collapse", "failed", "undecided")
    notes = (
        "Of pairs of scenes, one of which must stand and one fall: those with both sides right; those in which what "
        "must fall stood, in which something fell that must not (or not yet), and in which something sank, diverged or "
        "crashed. A pair may go wrong in more than one way.",
        "Undecided: a side was stopped by the time limit, is impossible on the engine, or was built too near its "
        f"limit; counted nowhere. {_intervals(rows)}",
    )
    return Table("Pairs with both sides right", header, tuple(told), notes)


def _by_family(rows: Sequence[PairRow]) -> Table:
    policies = ordered_policies(row.set_up.policy for row in rows)
    found = {(row.family, row.set_up): row for row in rows}
    families = dict.fromkeys(row.family for row in rows if row.family != ALL)
    engines = dict.fromkeys(row.set_up[:2] for row in rows)
    told = []
    for family in families:
        for engine, profile in engines:
            those = [found.get((family, SetUp(engine, profile, policy))) for policy in policies]
            if any(those):
                told.append((family, engine, profile, *(_family_cell(row) for row in those)))
    note = (
        "Pairs with both sides right, of those judged. s: false stands, c: false collapses, f: failed; pairs in which "
        f"they happened. “{NOTHING}”: none could be judged."
    )
    return Table("Pairs by family of scenes", ("family", *SetUp._fields[:2], *policies), tuple(told), (note,))


def _family_cell(row: PairRow | None) -> str:
    """Such as ``3/5 1s 1c``, or with an interval ``62/100 [50, 71] % 30s 8c``."""
    if row is None or row.shares is None:
        return NOTHING
    interval = percent(row.shares.right).partition(" [")[2]
    missed = [f"{number}{_LETTERS[miss]}" for miss in MISSES if (number := count(getattr(row.shares, miss)))]
    return " ".join([_counted(row.shares), *([f"[{interval} %"] if interval else []), *missed])


def _counted(told: Shares | None) -> str:
    return f"{told.right_count}/{told.n}" if told is not None else NOTHING


def _percent(told: Shares | None, name: str) -> str:
    estimate: Estimate | None = getattr(told, name) if told is not None else None
    return percent(estimate)


def _some(row: PairRow) -> str:
    return str(row.undecided) if row.undecided else NOTHING


def _intervals(rows: Sequence[PairRow]) -> str:
    if any(row.shares is not None and row.shares.right.low is not None for row in rows):
        return "95 % intervals by bootstrap over pairs and, within them, over seeds; none where it has no width."
    return "n = 1 build of each: no intervals."
