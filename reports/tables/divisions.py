"""The table of divisions: success rates on the scenes that tuned the profiles, and on held-out scenes."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import Group, grouped, groups_of, ordered_policies
from reports.statistics.pairs import pair_success_rates, pairs_of
from reports.tables.pairs import right_of_judged
from reports.tables.table import NOTHING, Table
from scenarios.divisions import TUNED_ON, is_held_out


def division_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of divisions in a list, which is empty unless both divisions have judged trials."""
    groups = [group for group in groups_of(records) if group.judged]
    if len({is_held_out(group.scenario) for group in groups}) < 2:
        return []
    set_ups = grouped(groups, "key.engine", "key.profile")
    policies = ordered_policies(group.key.policy for group in groups)
    rows = tuple(
        (engine, profile, policy, *_scores(those))
        for (engine, profile), members in set_ups.items()
        for policy in policies
        if (those := [group for group in members if group.key.policy == policy])
    )
    notes = (
        f"Tuned on: scenes of {', '.join(TUNED_ON)}, on which profiles were tuned. Held out: all others; no setting of "
        "an engine was chosen by them. Trials right of those judged, and pairs with both outcomes correct.",
    )
    header = ("engine", "profile", "policy", "tuned on", "%", "held out", "%", "pairs tuned on", "pairs held out")
    return [Table("Divisions", header, rows, notes, id="divisions")]


def _scores(groups: Sequence[Group]) -> tuple[str, ...]:
    tuned, held_out = ([group for group in groups if is_held_out(group.scenario) == wanted] for wanted in (False, True))
    pairs = (right_of_judged(pair_success_rates(pairs_of(those))) for those in (tuned, held_out))
    return (*_right(tuned), *_right(held_out), *pairs)


def _right(groups: Sequence[Group]) -> tuple[str, str]:
    """Return two entries: right trials over judged trials, and the success rate in percent."""
    judged = sum(len(group.judged) for group in groups)
    right = sum(group.count("right") for group in groups)
    return (f"{right}/{judged}", f"{100 * right / judged:.0f}") if judged else (NOTHING, NOTHING)
