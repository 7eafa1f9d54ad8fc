"""Findings of the gates: of one gate about one trial, and of all gates together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from scenarios.lookup import look_up

Gate: TypeAlias = Literal["outcome", "hash", "time"]
Judgement: TypeAlias = Literal["worse", "changed", "better", "same", "open"]
"""``open``: nothing could be decided, and the finding states why. It never counts as a pass."""

GATES: tuple[Gate, ...] = get_args(Gate)
ALARMS: frozenset[Judgement] = frozenset({"worse", "changed"})
_LONGEST = 200


@dataclass(frozen=True, slots=True)
class Finding:
    """The judgement of one gate on one trial, or on a group of trials."""

    gate: Gate
    trial: str
    judgement: Judgement
    message: str
    """The difference, or why nothing could be decided; empty where all is the same."""

    @property
    def is_alarm(self) -> bool:
        """True if the gate fails by it."""
        return self.judgement in ALARMS


@dataclass(frozen=True, slots=True)
class Comparison:
    """All findings of a comparison."""

    base: str
    """Name given by the user."""
    head: str
    findings: Sequence[Finding]
    notes: Sequence[str] = ()
    """Differences between the runs as a whole, such as their machines."""
    about_times: str = ""
    """Meaning of the time gate's figures, where they are not parts of frames."""

    def alarms(self, gates: Collection[Gate] = GATES) -> list[Finding]:
        """Return the findings that fail one of ``gates``."""
        return [finding for finding in self.findings if finding.gate in gates and finding.is_alarm]

    def counts(self, gate: Gate) -> Counter[Judgement]:
        """Return the number of findings of a gate by judgement."""
        return Counter(finding.judgement for finding in self.findings if finding.gate == gate)


def chosen_gates(names: str) -> tuple[Gate, ...]:
    """Return the gates named in a list such as ``outcome,time``; ``none`` names none.

    Raises:
        UnknownNameError: if one of them does not exist.
    """
    if names == "none":
        return ()
    known: dict[str, Gate] = {gate: gate for gate in GATES}
    wanted = {look_up("gate", name.strip(), known) for name in names.split(",")}
    return tuple(gate for gate in GATES if gate in wanted)


def plain(text: str) -> str:
    """Return untrusted text of a file as one line of printable letters, of limited length."""
    cut = text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in cut)
