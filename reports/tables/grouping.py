"""How trials are grouped into the rows of a study's tables."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import ordered_policies
from reports.tables.table import NOTHING


def policies_of(records: Iterable[TrialRecord]) -> list[str]:
    """Return the policies of some records, in their usual order."""
    return ordered_policies(record.policy for record in records)


def engine_names(records: Sequence[TrialRecord]) -> Callable[[str, str], str]:
    """How to name an engine: with its profile where several are compared."""
    several = len({record.profile for record in records}) > 1
    return lambda engine, profile: f"{engine} {profile}" if several else engine


def grouped(
    records: Iterable[TrialRecord], key: Callable[[TrialRecord], tuple[str, ...]]
) -> list[tuple[tuple[str, ...], list[TrialRecord]]]:
    """Records by a key, keys in the order in which they first appear."""
    groups: dict[tuple[str, ...], list[TrialRecord]] = {}
    for record in records:
        groups.setdefault(key(record), []).append(record)
    return list(groups.items())


def measured(
    records: Sequence[TrialRecord], further: Callable[[TrialRecord], tuple[str, ...]] = lambda _: ()
) -> list[tuple[tuple[str, ...], list[TrialRecord]]]:
    """Trials that played at least a few frames, by scene, engine, profile, policy and what ``further`` tells apart."""
    policies = policies_of(records)
    ran = [record for record in records if record.frame_ms_p50 is not None]
    scenes = list(dict.fromkeys(record.scene for record in records))
    engines = list(dict.fromkeys((record.engine, record.profile) for record in records))
    ran.sort(key=lambda r: (scenes.index(r.scene), engines.index((r.engine, r.profile)), policies.index(r.policy)))
    return grouped(ran, lambda r: (r.scene, r.engine, r.profile, r.policy, *further(r)))


def median_text(trials: Sequence[TrialRecord], field: str, form: str, scale: float = 1.0) -> str:
    """Format the median of a field, times ``scale``; a dash if no trial has it."""
    values = [value * scale for trial in trials if (value := getattr(trial, field)) is not None]
    return form.format(statistics.median(values)) if values else NOTHING
