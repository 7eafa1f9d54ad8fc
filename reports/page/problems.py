"""The caveats that the page of a study shows first: failed, censored, missing and mixed trials."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import Status, TrialRecord
from reports.tables.wording import some


def problems(records: Sequence[TrialRecord], missing: Sequence[str], without_frames: Sequence[str]) -> list[str]:
    """Return the caveats that the page shows first: failed, censored, missing and mixed trials."""
    words: dict[Status, str] = {
        "timeout": "were stopped by the time limit: their levels are lower bounds, neither right nor wrong",
        "diverged": "diverged",
        "crashed": "crashed the engine's process",
        "error": "ended in an error",
        "out_of_memory": "ran out of memory",
        "unsupported": "were not possible on their engine",
    }
    ends = [record.status for record in records]
    found = [f"{ends.count(s)} of {len(ends)} trials {text}." for s, text in words.items() if s in ends]
    earlier = [one for one in records if one.mean_motion_m_s is not None and one.creep_m_s is None]
    if earlier:
        found.append(f"{len(earlier)} trials are from before format 3: their verdicts do not consider creep.")
    if missing:
        found.append(f"{len(missing)} planned trials have no record (not yet run, or interrupted): {some(missing)}.")
    if len(without_frames) == len(records) > 1:
        found.append("No trial has its frames here (published folders keep none): the page shows no traces of them.")
    elif without_frames:
        found.append(f"Frames of {len(without_frames)} trials are missing or incomplete: {some(without_frames)}.")
    hosts = {record.host for record in records if record.host is not None}
    if len(hosts) > 1:
        found.append(f"Trials ran on {len(hosts)} machines: a row that mixes them shows no times.")
    if len({record.environment for record in records}) > 1:
        found.append("Trials come from several environments (commits, versions or machines): compare with care.")
    return found
