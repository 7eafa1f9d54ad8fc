"""The verdict of a study in one sentence, and the table of the ranking with the reason for each place."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from reports.records.trial import TrialRecord
from reports.statistics.groups import ALONE
from reports.statistics.pairs import SetUp
from reports.statistics.ranking import Creep, Place, Ranking
from reports.statistics.states import STATES, State
from reports.tables.table import NOTHING, Table
from reports.tables.wording import MICRO, creep_doubt, micrometres, some

STATE_WORDS: dict[State, tuple[str, str]] = {
    "right": ("correct", "correct"),
    "false_stand": ("false stand", "false stands"),
    "false_collapse": ("false collapse", "false collapses"),
    "creeps": ("creeping", "creeping"),
    "failed": ("failed", "failed"),
    "undecided": ("undecided", "undecided"),
    "not_playable": ("not playable", "not playable"),
    "open": ("not judged", "not judged"),
}
"""Words for each state: for one build, and for several builds."""
REFERENCE = "ref."
"""Entry of a reference engine in the column of places."""
P50, P99, CREEP = "p50 [ms], median scene", "p99 [ms], slowest scene", "creep [µm/s] of limit"
"""Heads of the costs in the ranking."""
_PERCENTILES = (5, 95)
"""Percentiles of the calibration times, whose ratio measures the variation of the machine's speed."""


def sentence(ranking: Ranking, unfinished: int = 0) -> str:
    """Return the verdict of the study in one sentence.

    The cases, in order:

    - the ranking has no units: the sentence points to the tables;
    - all set-ups run reference engines: the sentence states that these engines have no place in the ranking;
    - no set-up is right in all units: the sentence names the first set-up of the ranking, with its misses;
    - the set-ups with all units right have no comparable frame times: the sentence names these set-ups;
    - otherwise: the sentence names the cheapest set-up with all units right.

    Args:
        ranking: the ranking of the study.
        unfinished: number of planned trials without a record.
    """
    have = "planned trial has" if unfinished == 1 else "planned trials have"
    still = f" ({unfinished} {have} no record yet)" if unfinished else ""
    if not ranking.units:
        return f"No scene of this study is judged right or wrong; its tables hold the results{still}."
    everything = _everything(ranking)
    if not ranking.places:
        return f"Reference engines only, which have no place in a ranking of products{still}."
    if not ranking.all_right:
        best = ranking.places[0]
        held = f"{best.right} right, {_misses(best)}"
        return f"No set-up is right in {everything}; the nearest is {name(best.set_up)}: {held}{_cost(best)}{still}."
    first = ranking.all_right[0]
    if first.frame_ms is None:
        names = some([name(place.set_up) for place in ranking.all_right])
        return f"Right in {everything}{_caveat(ranking)}: {names}; no comparable frame times{still}."
    return (
        f"Cheapest set-up that is right in {everything}{_caveat(ranking)}: {name(first.set_up)}{_cost(first)}{still}."
    )


def name(set_up: SetUp) -> str:
    """Return a set-up as text, such as ``rapier game with paper``."""
    return f"{set_up.engine} {set_up.profile} {'alone' if set_up.policy == ALONE else f'with {set_up.policy}'}"


def ranking_table(ranking: Ranking, records: Sequence[TrialRecord]) -> Table:
    """Return the ranking as a table: place, set-up, counts, costs and the reason; no rows without units.

    Args:
        ranking: the ranking of the study.
        records: records of the study, whose calibration times show the variation of the machine's speed.
    """
    placed = [(str(number), place) for number, place in enumerate(ranking.places, start=1)]
    listed = [*placed, *((REFERENCE, place) for place in ranking.references)]
    causes = [*reasons(ranking), *(_misses(place) or "right in all" for place in ranking.references)]
    rows = tuple(
        (
            number,
            *place.set_up,
            f"{place.right}/{len(ranking.units)}",
            milliseconds(place.frame_ms),
            milliseconds(place.slowest.frame_ms_p99 if place.slowest is not None else None),
            _of_limit(place.creep),
            reason,
        )
        for (number, place), reason in zip(listed, causes, strict=True)
        if ranking.units
    )
    header = ("place", *SetUp._fields, "right", P50, P99, CREEP, "reason")
    return Table("Ranking", header, rows, _notes(ranking, records), folds=True, id="ranking")


def reasons(ranking: Ranking) -> list[str]:
    """Return the reason for the place of each set-up, in the order of the places."""
    found: list[str] = []
    for _, tied in groupby(ranking.places, key=lambda place: (place.right, place.wrong)):
        found += _reasons_of_tied(list(tied), len(found) + 1)
    return found


def milliseconds(time_ms: float | None) -> str:
    """Format a time [ms] with two significant digits, from 100 ms on without decimals; return a dash for None.

    A time below 0.001 ms has three decimals.
    """
    if time_ms is None:
        return NOTHING
    decimals = 3 if time_ms < 1e-3 else max(0, 1 - math.floor(math.log10(time_ms)))
    return f"{time_ms:.{decimals}f}"


def counted(number: int, state: State) -> str:
    """Return the number of builds in a state as text, such as ``2 false stands``."""
    return f"{number} {STATE_WORDS[state][number != 1]}"


def _everything(ranking: Ranking) -> str:
    """Return the units of the study as text, such as ``all 53 pairs and 9 other scenes (1240 builds)``."""
    other = "other " if ranking.pairs else ""
    kinds = ((ranking.pairs, "", "pair"), (ranking.scenes, other, "scene"))
    parts = [_all_of(count, kind, noun) for count, kind, noun in kinds if count]
    if len(parts) > 1 and all(part.startswith("all ") for part in parts):
        parts[1] = parts[1].removeprefix("all ")
    builds = f" ({len(ranking.units)} builds)" if len(ranking.units) > ranking.pairs + ranking.scenes else ""
    return f"{' and '.join(parts)}{builds}"


def _all_of(count: int, kind: str, noun: str) -> str:
    """Return the number and name of all members of a set, such as ``the only pair`` or ``all 9 scenes``."""
    if count == 1:
        return f"the only {kind}{noun}"
    return f"{'both' if count == 2 else f'all {count}'} {kind}{noun}s"


def _caveat(ranking: Ranking) -> str:
    """Return a warning if all scenes demand the same outcome, because a set-up may give that outcome for any scene."""
    if len(ranking.outcomes) != 1:
        return ""
    outcome = next(iter(ranking.outcomes))
    return f", which must {outcome}" if ranking.pairs + ranking.scenes == 1 else f", though every scene must {outcome}"


def _cost(place: Place) -> str:
    time = "" if place.frame_ms is None else f", {milliseconds(place.frame_ms)} ms a frame"
    return time + _creep(place.creep)


def _creep(creep: Creep | None) -> str:
    if creep is None:
        return ", creep not measured"
    speed = creep.m_s * MICRO
    doubt = f" (not certainly more than its limit of {creep.limit_m_s * MICRO:.1f})" if creep.is_uncertain else ""
    return f", creeps {speed:.1f} µm/s{doubt}" if speed >= 0.05 else ", creeps less than 0.05 µm/s"


def _of_limit(creep: Creep | None) -> str:
    """Format a creep and its limit [µm/s], as ``0.60 of 1.28``, with its interval if uncertain; a dash for None."""
    if creep is None:
        return NOTHING
    speed, limit = (micrometres(value * MICRO) for value in (creep.m_s, creep.limit_m_s))
    if not creep.is_uncertain:
        return f"{speed} of {limit}"
    interval, mark = creep_doubt(creep.m_s, creep.error_m_s)
    return f"{speed}{interval} of {limit} {mark}"


def _misses(place: Place) -> str:
    """Return the counts of units that are not right as text, such as ``1 false stand, 2 undecided``."""
    counts = [counted(place.states[state], state) for state in STATES if state != "right" and place.states.get(state)]
    return ", ".join([*counts, *([f"{place.missing} without records"] if place.missing else [])])


def _reasons_of_tied(places: Sequence[Place], first: int) -> Iterator[str]:
    """Yield the reason for each place among set-ups with equal counts, sorted by frame time."""
    cheapest = places[0].frame_ms
    for place in places:
        base = _misses(place) or "right in all"
        if len(places) == 1:
            yield base
        elif place.frame_ms is None or not cheapest:
            yield f"{base}; no comparable frame time"
        elif place is places[0]:
            yield f"{base}; cheapest of {len(places)} with these counts"
        else:
            yield f"{base}; {place.frame_ms / cheapest:.1f} times the p50 of place {first}"


def _notes(ranking: Ranking, records: Sequence[TrialRecord]) -> tuple[str, ...]:
    order = (
        f"Order: most right of {len(ranking.units)} with a known answer (builds of pairs, of other scenes each alone; "
        "not playable and undecided ones are not right), then fewest wrong, then the least p50."
    )
    units = (
        "p50, median scene: median over scenes of the median frame time. p99, slowest scene: 99 of 100 frames take at "
        "most so long in the scene where they take longest. Creep: of the brick nearest to its limit (1 % of its "
        "thickness a minute), or farthest beyond it, over all stacks that must stand; ?: above the limit, but its 95 % "
        "interval [in brackets] reaches below, so that the stack counts as still; trembles: the interval reaches 0, so "
        "that the brick shakes, and its direction is not known."
    )
    if ranking.references:
        units += (
            f" “{REFERENCE}”: a reference engine, written after a published method; it is no product and has no place."
        )
    calibrations = [record.calibration_ms for record in records if record.calibration_ms is not None]
    low, high = np.percentile(calibrations, _PERCENTILES) if calibrations else (1.0, 1.0)
    if high / low < 1.05:
        return order, units
    speed = (
        f"The machine's speed varied by a factor of {high / low:.1f} between trials (5th to 95th percentile of a fixed "
        "calculation): frame times that differ by less may change places."
    )
    return order, units, speed
