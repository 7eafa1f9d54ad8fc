"""The caveats that the page of a study shows first, such as failed, censored, missing and mixed trials."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import Status, TrialRecord
from reports.tables.wording import quantity, some


def problems(
    records: Sequence[TrialRecord], missing: Sequence[str], without_frames: Sequence[str], again: str
) -> list[str]:
    """Return the caveats that the page shows first, such as failed, censored, missing and mixed trials.

    Args:
        records: records of the study.
        missing: ids of planned trials without a record.
        without_frames: ids of trials without complete frames.
        again: the command that runs the study; backticks mark the command in a caveat.
    """
    words: dict[Status, tuple[str, str]] = {
        "timeout": (
            "was stopped by the time limit: its levels are lower bounds, neither right nor wrong",
            "were stopped by the time limit: their levels are lower bounds, neither right nor wrong",
        ),
        "diverged": ("diverged", "diverged"),
        "crashed": ("crashed the engine's process", "crashed the engine's process"),
        "error": ("ended in an error", "ended in an error"),
        "out_of_memory": ("ran out of memory", "ran out of memory"),
        "unsupported": ("was not possible on its engine", "were not possible on their engines"),
    }
    ends = [record.status for record in records]
    found = [
        f"{number} of {quantity(len(ends), 'trial')} {text[number > 1]}."
        for status, text in words.items()
        if (number := ends.count(status))
    ]
    earlier = [one for one in records if one.mean_motion_m_s is not None and one.creep_m_s is None]
    if earlier:
        found.append(
            f"Creep not measured: {quantity(len(earlier), 'trial')} stood in records from before format 3, the first "
            f"that measures creep, so that a creeping stack counts as right there. Measure it: `{again}`. The other "
            f"{quantity(len(ends) - len(earlier), 'trial')} measured it, or fell, stopped or were not played."
        )
    if missing:
        have = "planned trial has" if len(missing) == 1 else "planned trials have"
        found.append(f"{len(missing)} {have} no record (not yet run, or interrupted): {some(missing)}.")
    if len(without_frames) == len(records) > 1:
        found.append("No trial has its frames here (published folders keep none): the page shows no traces of them.")
    elif without_frames:
        found.append(
            f"Frames of {quantity(len(without_frames), 'trial')} are missing or incomplete: {some(without_frames)}."
        )
    hosts = {record.host for record in records if record.host is not None}
    if len(hosts) > 1:
        found.append(f"Trials ran on {len(hosts)} machines: a row that mixes them shows no times.")
    if len({record.environment for record in records}) > 1:
        found.append("Trials come from several environments (commits, versions or machines): compare with care.")
    return found
