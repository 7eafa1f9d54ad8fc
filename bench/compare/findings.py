"""What a gate finds out about one trial, and what all gates found out together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from scenarios.lookup import look_up

Gate: TypeAlias = Literal["outcome", "hash", "time"]
Judgement: TypeAlias = Literal["worse", "changed", "better", "same", "open"]
"""``open``: nothing could be decided, and the finding tells why. It is never counted as a pass."""

GATES: tuple[Gate, ...] = get_args(Gate)
ALARMS: frozenset[Judgement] = frozenset({"worse", "changed"})
_LONGEST = 200


@dataclass(frozen=True, slots=True)
class Finding:
    """What one gate says of one trial, or of a cell of trials."""

    gate: Gate
    trial: str
    judgement: Judgement
    told: str
    """What differs, or why nothing could be decided; empty where all is the same."""

    @property
    def is_alarm(self) -> bool:
        """Whether the gate fails by it."""
        return self.judgement in ALARMS


@dataclass(frozen=True, slots=True)
class Comparison:
    """Everything that two runs told when they were held against each other."""

    base: str
    """As the user named it."""
    head: str
    findings: Sequence[Finding]
    notes: Sequence[str] = ()
    """What differs between the runs as a whole, such as their machines."""
    about_times: str = ""
    """What the figures of the time gate are, where they are not parts of frames."""

    def alarms(self, gates: Collection[Gate] = GATES) -> list[Finding]:
        """The findings that fail one of ``gates``."""
        return [finding for finding in self.findings if finding.gate in gates and finding.is_alarm]

    def counts(self, gate: Gate) -> Counter[Judgement]:
        """How often a gate came to each judgement."""
        return Counter(finding.judgement for finding in self.findings if finding.gate == gate)


def chosen_gates(names: str) -> tuple[Gate, ...]:
    """The gates that a list such as ``outcome,time`` names; ``none`` names none.

    Raises:
        UnknownNameError: if one of them does not exist.
    """
    if names == "none":
        return ()
    known: dict[str, Gate] = {gate: gate for gate in GATES}
    wanted = {look_up("gate", name.strip(), known) for name in names.split(",")}
    return tuple(gate for gate in GATES if gate in wanted)


def plain(text: str) -> str:
    """Text of a file that anybody may have written: one line of printable letters, of a sane length."""
    cut = text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in cut)
