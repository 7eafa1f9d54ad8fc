"""The tables of pairs of scenes: all pairs together, and the pairs of each family."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

from reports.statistics.groups import ordered_policies
from reports.statistics.intervals import Estimate
from reports.statistics.pairs import (
    ALL,
    PairedScenes,
    PairRow,
    SetUp,
)
from reports.statistics.success_rates import MISSES, SuccessRates, count, misses_shown
from reports.tables.table import NOTHING, Table
from reports.tables.wording import percent

_LETTERS = {"false_stand": "s", "false_collapse": "c", "creeps": "r", "failed": "f"}


def pair_tables(rows: Sequence[PairRow], scenes: Sequence[PairedScenes]) -> list[Table]:
    """Return the table of all pairs and the table by family; empty without pairs.

    Args:
        rows: success rates of the pairs.
        scenes: scenes of each family; the notes give their numbers in pairs and without a partner.
    """
    return [_headline(rows, _coverage(scenes)), _by_family(rows, _coverage_of_families(scenes))] if rows else []


def paired_scenes_table(scenes: Sequence[PairedScenes], names: Mapping[str, str]) -> Table:
    """Return the table of the scenes of each family, in pairs and without a partner.

    Args:
        scenes: scenes of each family.
        names: names of the scenes, by id.
    """

    def named(ids: Sequence[str]) -> str:
        return ", ".join(names[one] for one in ids) or NOTHING

    lines = tuple((one.family, str(one.pairs), named(one.paired), named(one.alone)) for one in scenes)
    header = ("family", "pairs", "scenes in pairs", "scenes without a partner, in no table of pairs")
    return Table("Scenes of the pairs", header, lines, folds=True, id="paired_scenes")


def pairs_csv(rows: Sequence[PairRow]) -> str:
    """Return the rows as CSV, with the success rate, the rate of each error, and the ends of their intervals."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ("right", *MISSES)
    ends = [f"{name}{end}" for name in names for end in ("", "_low", "_high")]
    writer.writerow([*SetUp._fields, "family", "judged", "undecided", *ends])
    for row in rows:
        estimates = [getattr(row.success_rates, name) for name in names] if row.success_rates is not None else []
        values = [value for one in estimates for value in (one.value, one.low, one.high)]
        judged = row.success_rates.n if row.success_rates is not None else 0
        writer.writerow([*row.set_up, row.family, judged, row.undecided, *values])
    return text.getvalue()


def _headline(rows: Sequence[PairRow], coverage: str) -> Table:
    misses = misses_shown(row.success_rates for row in rows)
    lines = [
        (
            *row.set_up,
            right_of_judged(row.success_rates),
            *(_percent(row.success_rates, name) for name in ("right", *misses)),
            _some(row),
        )
        for row in rows
        if row.family == ALL
    ]
    header = (*SetUp._fields, "pairs", "right", *(miss.replace("_", " ") for miss in misses), "undecided")
    notes = (
        coverage,
        "Pairs of scenes, one of which must stand and one fall: both outcomes correct; false stands (the scene that "
        "must fall stood), false collapses (a scene fell that must not, or too early), creeps (the scene that must "
        "stand crept), and failures (a scene sank, diverged or crashed). A pair may have several kinds of error.",
        "Undecided: a side was stopped by the time limit, is impossible on the engine, or was built too near its "
        f"limit; counted nowhere. {_intervals(rows)}",
    )
    return Table("Pairs with both outcomes correct", header, tuple(lines), notes, id="pairs")


def _by_family(rows: Sequence[PairRow], coverage: str) -> Table:
    policies = ordered_policies(row.set_up.policy for row in rows)
    found = {(row.family, row.set_up): row for row in rows}
    families = dict.fromkeys(row.family for row in rows if row.family != ALL)
    engines = dict.fromkeys(row.set_up[:2] for row in rows)
    lines = []
    for family in families:
        for engine, profile in engines:
            those = [found.get((family, SetUp(engine, profile, policy))) for policy in policies]
            if any(those):
                lines.append((family, engine, profile, *(_family_cell(row) for row in those)))
    note = (
        "Pairs with both outcomes correct, of those judged. s: false stands, c: false collapses, r: creeps, f: failed; "
        f"pairs with them. “{NOTHING}”: none could be judged."
    )
    return Table(
        "Pairs by family of scenes",
        ("family", *SetUp._fields[:2], *policies),
        tuple(lines),
        (coverage, note),
        id="pairs_by_family",
    )


def _coverage(scenes: Sequence[PairedScenes]) -> str:
    """Return a sentence with the number of scenes that pairs judge, and the number of all scenes of the study."""
    pairs = sum(one.pairs for one in scenes)
    paired, alone = sum(len(one.paired) for one in scenes), sum(len(one.alone) for one in scenes)
    counted_pairs = "The only pair" if pairs == 1 else f"The {pairs} pairs"
    judged = f"{counted_pairs} judge{'s' * (pairs == 1)} {paired} of {paired + alone} scenes"
    other = "the other" if alone == 1 else f"the other {alone}"
    return f"{judged}; no table of pairs counts {other}." if alone else f"{judged}."


def _coverage_of_families(scenes: Sequence[PairedScenes]) -> str:
    """Return a sentence that names the families of which pairs judge some scenes only."""
    some = [f"{one.family} {len(one.paired)} of {len(one.paired) + len(one.alone)}" for one in scenes if one.alone]
    if not some:
        return "Pairs judge all scenes of each family."
    rest = "; of all other families all" if len(some) < len(scenes) else ""
    return f"Scenes in pairs: {', '.join(some)}{rest}."


def _family_cell(row: PairRow | None) -> str:
    """Return the entry of a family, such as ``3/5 1s 1c``, or with an interval ``62/100 [50, 71] % 30s 8c``."""
    if row is None or row.success_rates is None:
        return NOTHING
    interval = percent(row.success_rates.right).partition(" [")[2]
    missed = [f"{number}{_LETTERS[miss]}" for miss in MISSES if (number := count(getattr(row.success_rates, miss)))]
    return " ".join([right_of_judged(row.success_rates), *([f"[{interval} %"] if interval else []), *missed])


def right_of_judged(rates: SuccessRates | None) -> str:
    """Return the ratio of right to judged pairs or trials as text, such as ``38/46``; a dash without judged trials."""
    return f"{rates.right_count}/{rates.n}" if rates is not None else NOTHING


def _percent(rates: SuccessRates | None, name: str) -> str:
    estimate: Estimate | None = getattr(rates, name) if rates is not None else None
    return percent(estimate)


def _some(row: PairRow) -> str:
    return str(row.undecided) if row.undecided else NOTHING


def _intervals(rows: Sequence[PairRow]) -> str:
    if any(row.success_rates is not None and row.success_rates.right.low is not None for row in rows):
        return "95 % intervals by bootstrap over pairs and, within them, over seeds; none where it has no width."
    return "n = 1 build of each: no intervals; run more builds with `--seeds 20`."
