"""The table of outcomes, which shows the outcome of each group of trials and whether theory agrees."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from reports.records.trial import CENSORED, TrialRecord
from reports.statistics.groups import ALONE, Group, GroupKey, grouped, groups_of, judged_trials, ordered_policies
from reports.tables.table import NOTHING, Table
from reports.tables.wording import some
from scenarios.divisions import TUNED_ON

_WENT_WRONG = {
    "diverged": "diverged",
    "crashed": "crashed",
    "error": "error",
    "out_of_memory": "no memory",
    "unsupported": "n/a",
}
TITLE = "Outcomes"
"""Title of the table."""
ADOPTED = "†"
"""Mark of trials in which the core froze bodies of a prebuilt stack before the first step after their placement."""
CREEPS_NOTE = (
    "“creeps”: it stood, but in the last half of the watch the 95 % interval of a brick's creep lay above the limit "
    "(by default 1 % of its thickness a minute)."
)
ADOPTED_NOTE = f"{ADOPTED}: prebuilt; the core judged the stack by statics and froze bodies before the first step."


def outcomes_table(records: Sequence[TrialRecord]) -> Table:
    """Return the table of outcomes: a row per scene, engine and profile, a column per policy."""
    groups = groups_of(records)
    several = len({group.key.profile for group in groups}) > 1
    entries = {group.key: outcome(group.trials) for group in groups}
    policies = ordered_policies(record.policy for record in records)
    rows = []
    for (scene, engine, profile), trials in grouped(records, "scene", "engine", "profile").items():
        name = f"{engine} {profile}" if several else engine
        ends = (entries.get(GroupKey(scene, engine, profile, policy), NOTHING) for policy in policies)
        rows.append((scene, str(trials[0].expectation), name, *ends))
    notes = ["✓ as theory demands, ✗ not, no mark: not judged. n/m: n of m levels stood."]
    notes += [
        "“falls at k”: it toppled, slid or dropped when k levels were complete, 0: before the first was; “sinks at k”: "
        "it sank upright by half a plank."
    ]
    if any(record.verdict == "creeps" for record in records):
        notes.append(CREEPS_NOTE)
    if any(record.status in CENSORED for record in records):
        notes.append("≥: stopped by the time limit, so a lower bound. Counted as neither right nor wrong.")
    if any(record.adopted for record in records):
        notes.append(ADOPTED_NOTE)
    if any(record.status == "unsupported" for record in records):
        notes.append("n/a: the engine cannot play the scene.")
    if tuned := [name for name in TUNED_ON if any(record.scenario == name for record in records)]:
        notes.append(f"Profiles were tuned on {some(tuned)}; other scenes are held out.")
    if alone := _stands_alone(records):
        notes.append(f"Stands on the engine alone, so that only time and stillness can improve: {some(alone)}.")
    notes.append(f"{_seeds(groups)} Profile: {some(list(dict.fromkeys(record.profile for record in records)))}.")
    header = ("scene", "theory", "engine", *policies)
    return Table(TITLE, header, tuple(rows), tuple(notes), id="outcomes")


def outcome(trials: Sequence[TrialRecord]) -> str:
    """Return the entry for the trials of a group: levels or end, the mark and, for several trials, the number right.

    The entry is a dash without trials.
    """
    if not trials:
        return NOTHING
    judged, mark_of_adopted = judged_trials(trials), adopted_mark(trials)
    right = sum(trial.verdict == "right" for trial in judged)
    if len(trials) == 1:
        return f"{_end(trials[0])}{mark_of_adopted}{' ✓' if right else ' ✗' if judged else ''}"
    levels = sorted(trial.height_levels for trial in trials if trial.status not in _WENT_WRONG)
    if not levels:
        return _WENT_WRONG[trials[0].status]
    at_least = "≥" if any(trial.status in CENSORED for trial in trials) else ""
    varied = f" ({levels[0]}-{levels[-1]})" if levels[0] < levels[-1] else ""
    reached = f"{at_least}{_plain(statistics.median(levels))}{varied}/{trials[0].levels_planned}{mark_of_adopted}"
    if not judged:
        return reached
    mark = "✓" if right == len(judged) else "~" if right else "✗"
    return f"{reached} {mark} {right}/{len(judged)}"


def adopted_mark(trials: Sequence[TrialRecord]) -> str:
    """Return ``ADOPTED`` if this mark applies to one of the trials, else an empty string."""
    return ADOPTED if any(trial.adopted for trial in trials) else ""


def _end(trial: TrialRecord) -> str:
    if trial.status in _WENT_WRONG:
        return _WENT_WRONG[trial.status]
    if trial.status in CENSORED:
        return f"≥{trial.height_levels}/{trial.levels_planned}"
    if trial.collapse_level is not None:
        return f"{'sinks' if trial.collapse_kind == 'sink' else 'falls'} at {trial.collapse_level}"
    return f"{trial.height_levels}/{trial.levels_planned}{' creeps' if trial.verdict == 'creeps' else ''}"


def _stands_alone(records: Sequence[TrialRecord]) -> list[str]:
    """Return scene, engine and profile of each stack that must stand, and stands on the engine alone."""
    several = len({record.profile for record in records}) > 1
    return [
        f"{scene} on {engine}{f' {profile}' if several else ''}"
        for (scene, engine, profile), trials in grouped(records, "scene", "engine", "profile").items()
        if (alone := [trial for trial in trials if trial.policy == ALONE])
        and trials[0].expectation.outcome == "stand"
        and all(trial.verdict == "right" for trial in alone)
    ]


def _seeds(groups: Sequence[Group]) -> str:
    counts = sorted({len(group.trials) for group in groups})
    n = "-".join(map(str, [counts[0], counts[-1]][: len(counts)])) if counts else "0"
    legend = ""
    if counts[-1:] > [1]:
        legend = " (median and range of the levels that stood, then how many trials were right: ✓ all, ~ some, ✗ none)"
    return f"n = {n} trial{'' if n == '1' else 's'} per entry: seeds and repeats{legend}."


def _plain(value: float) -> str:
    return f"{value:g}"
