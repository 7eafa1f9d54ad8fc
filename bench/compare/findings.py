"""Findings of the gates: the judgement of one gate on one trial, and all findings of a comparison."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from scenarios.lookup import look_up

Gate: TypeAlias = Literal["outcome", "hash", "time"]
"""Name of a gate: ``outcome`` judges verdict, levels, sink and creep, ``hash`` judges poses bit for bit, ``time``
judges parts of a frame."""
Judgement: TypeAlias = Literal["worse", "changed", "better", "same", "open"]
"""Result of a gate. ``open`` means that the gate cannot decide, for the reason in the finding's message; such a
finding is neither a pass nor an alarm."""

GATES: tuple[Gate, ...] = get_args(Gate)
"""All gates."""
ALARMS: frozenset[Judgement] = frozenset({"worse", "changed"})
"""Judgements that fail a gate."""
_LONGEST = 200
"""Greatest length of untrusted text [characters]."""


@dataclass(frozen=True, slots=True)
class Finding:
    """The judgement of one gate on one trial, or on a group of trials."""

    gate: Gate
    trial: str
    judgement: Judgement
    message: str
    """The difference, the ratio of times, or the reason for which the gate could not decide; empty for the same outcome
    or the same poses."""
    base: str = ""
    """Values of the base, to show beside the values of the head; empty if the message contains all values."""
    head: str = ""
    """Values of the head."""

    @property
    def is_alarm(self) -> bool:
        """True if this finding fails its gate."""
        return self.judgement in ALARMS


@dataclass(frozen=True, slots=True)
class Comparison:
    """All findings of a comparison."""

    base: str
    """Name of the base, given by the user."""
    head: str
    """Name of the head, given by the user."""
    findings: Sequence[Finding]
    notes: Sequence[str] = ()
    """Differences between the runs as a whole, such as their machines."""
    about_times: str = ""
    """Explanation of the figures of the time gate; empty if these figures are the usual parts of a frame."""
    missing: int = 0
    """Number of trials of the base that the head does not have."""
    expected: int = 0
    """Number of trials of the base."""

    def alarms(self, gates: Collection[Gate] = GATES) -> list[Finding]:
        """Return the findings that fail a gate in ``gates``."""
        return [finding for finding in self.findings if finding.gate in gates and finding.is_alarm]

    def counts(self, gate: Gate) -> Counter[Judgement]:
        """Return the number of findings of a gate, by judgement."""
        return Counter(finding.judgement for finding in self.findings if finding.gate == gate)


def without_repeat(trial: str) -> str:
    """Return the id of a trial without the number of the repeat."""
    name, separator, repeat = trial.rpartition(".r")
    return name if separator and repeat.isdigit() else trial


def chosen_gates(names: str) -> tuple[Gate, ...]:
    """Return the gates named in a list such as ``outcome,time``; ``none`` stands for an empty list.

    Raises:
        UnknownNameError: if a named gate does not exist.
    """
    if names == "none":
        return ()
    known: dict[str, Gate] = {gate: gate for gate in GATES}
    wanted = {look_up("gate", name.strip(), known) for name in names.split(",")}
    return tuple(gate for gate in GATES if gate in wanted)


def plain(text: str) -> str:
    """Return untrusted text of a file as one line of at most ``_LONGEST`` printable characters."""
    cut = text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in cut)
