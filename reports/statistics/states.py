"""States of trials: correct, the kinds of error, and undecided with its cause."""

from __future__ import annotations

from collections import Counter
from typing import Literal, TypeAlias

from reports.records.trial import TrialRecord
from reports.statistics.groups import Group

State: TypeAlias = Literal[
    "right", "false_stand", "false_collapse", "creeps", "failed", "undecided", "not_playable", "open"
]
STATES: tuple[State, ...] = (
    "right",
    "false_stand",
    "false_collapse",
    "creeps",
    "failed",
    "undecided",
    "not_playable",
    "open",
)
"""All states in the order of a legend. ``undecided``: stopped by the time limit; ``not_playable``: impossible on the
engine; ``open``: theory does not say."""


def state_of(trial: TrialRecord) -> State:
    """Return the state of a trial."""
    if trial.status == "unsupported":
        return "not_playable"
    return "open" if trial.verdict == "none" else trial.verdict


def states_of(group: Group) -> Counter[State]:
    """Return the number of builds of a group in each state; repeats of a build count once."""
    return Counter(state_of(trial) for trial in group.draws)
