"""States of trials: right, the kinds of error, and the reasons why a trial has no judgement."""

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
"""All states, in the order of a legend. The states after the kinds of error are:

- ``undecided``: the time limit stopped the trial;
- ``not_playable``: the engine does not support the scene;
- ``open``: theory demands no outcome, or a stack that must stand is in neutral balance.
"""


def state_of(trial: TrialRecord) -> State:
    """Return the state of a trial."""
    if trial.status == "unsupported":
        return "not_playable"
    return "open" if trial.verdict == "none" else trial.verdict


def states_of(group: Group) -> Counter[State]:
    """Return the number of seeds of a group in each state; only the first repeat of a seed counts."""
    return Counter(state_of(trial) for trial in group.draws)
