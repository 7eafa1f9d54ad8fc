"""The table of costs: time, memory, solver iterations and instructions."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from reports.records.trial import TrialRecord
from reports.statistics.groups import grouped, ordered_policies
from reports.tables.table import NOTHING, Table

_COSTS = ("memory_mib", "solver_iterations", "core_instructions")
_COLUMNS = (
    ("p50 ms", "frame_ms_p50", "{:.3f}", 1.0),
    ("step ms", "engine_ms", "{:.3f}", 1.0),
    ("core ms", "core_ms", "{:.3f}", 1.0),
    ("core kinstr", "core_instructions", "{:.0f}", 1e-3),
    ("iterations", "solver_iterations", "{:.1f}", 1.0),
    ("memory MiB", "memory_mib", "{:.1f}", 1.0),
)
"""Columns: title, field of the record, format, and factor from the unit of the field to the unit of the column."""
_COUNTED = "counted"


def cost_tables(records: Sequence[TrialRecord], environment: Mapping[str, Any]) -> list[Table]:
    """Return the table of costs in a list, which is empty if no trial with frame times has a cost in ``_COSTS``.

    Args:
        records: records of all trials of a study.
        environment: environment of the run; its sessions record whether the machine counts instructions.
    """
    played = [record for record in records if record.frame_ms_p50 is not None]
    if not any(getattr(record, name) is not None for record in played for name in _COSTS):
        return []
    set_ups = grouped(played, "engine", "profile")
    policies = ordered_policies(record.policy for record in played)
    rows = tuple(
        (engine, profile, policy, str(len(trials)), *(_median(trials, *column[1:]) for column in _COLUMNS))
        for (engine, profile), members in set_ups.items()
        for policy in policies
        if (trials := [record for record in members if record.policy == policy])
    )
    header = ("engine", "profile", "policy", "trials", *(column[0] for column in _COLUMNS))
    return [Table("Cost", header, rows, (_NOTE, *_instruction_notes(environment)), id="cost")]


_NOTE = (
    "Medians over the trials that have a value; trials differ in scene and height. p50, step and core: times in ms per "
    "frame. Kinstr: thousands of instructions per frame of the core in user code, without port calls. Iterations: of "
    "the engine's solver in the last step of a frame, of the island that took most; a dash where the engine does not "
    "report them. Memory: growth of the peak of the process's resident memory from before the engine was opened, with "
    "what the harness records; a dash for engines in a separate process."
)


def _median(trials: Sequence[TrialRecord], field: str, form: str, scale: float) -> str:
    """Return the median of a field as text; a dash without values, and for times of several machines."""
    values = [value for trial in trials if (value := getattr(trial, field)) is not None]
    is_of_several = len({trial.host for trial in trials}) > 1
    if not values or ("_ms" in field and is_of_several):
        return NOTHING
    return form.format(statistics.median(values) * scale)


def _instruction_notes(environment: Mapping[str, Any]) -> tuple[str, ...]:
    """Return a note for each reason why a machine counts no instructions."""
    reasons = (session.get("instructions", _COUNTED) for session in environment.get("sessions", ()))
    return tuple(f"Instructions: {reason}." for reason in dict.fromkeys(reasons) if reason != _COUNTED)
