"""Estimate the duration of a plan from earlier trials, and the share of it that is a guess."""

from __future__ import annotations

import json
import statistics
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.studies.plan import Trial
from reports.records.folder import TRIALS

START_S = 0.1
"""Time per trial [s] for its process and its files."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimated time of trials, and its sources."""

    known_s: float
    """Total time of the trials with a known duration [s]."""
    same: int
    """Number of trials that were run before."""
    similar: int
    """Number of trials estimated from others of their engine and scene."""
    unknown: int
    limit_s: float
    """Longest time [s] of an unknown trial."""
    folders: Sequence[Path]
    """Results folders that were used."""

    def summary(self, jobs: int) -> str:
        """Return the estimate in words, for ``jobs`` trials at a time."""
        count = self.same + self.similar + self.unknown
        longest = f"at most {_duration(self.unknown * self.limit_s / jobs)}"
        if not self.folders:
            return f"{count} trials: {longest}; there are no earlier trials to estimate from"
        source = f"{self.same} from the same trials, {self.similar} from others of their engine and scene"
        folders = ", ".join(map(str, self.folders))
        rest = f", and {longest} for {self.unknown} unknown trials" if self.unknown else ""
        return f"{count} trials: about {_duration(self.known_s / jobs)} ({source}, in {folders}){rest}"


def estimate(trials: Iterable[Trial], limit_s: float, folders: Iterable[Path]) -> Estimate:
    """Estimate the time of ``trials``.

    Args:
        trials: the trials to run.
        limit_s: wall time [s] after which a trial is stopped.
        folders: folders of earlier results; folders without results are skipped.
    """
    same: dict[str, list[float]] = defaultdict(list)
    similar: dict[tuple[str, str], list[float]] = defaultdict(list)
    used: dict[Path, None] = {}
    wanted = list(trials)
    scenes = {(trial.engine, trial.scene) for trial in wanted}
    for folder in folders:
        for record in _records(folder / TRIALS):
            key = record.get("engine"), record.get("scene")
            if key in scenes and record.get("wall_s") is not None:
                same[record["trial"]].append(record["wall_s"])
                similar[key].append(record["wall_s"])
                used[folder] = None
    known = [same.get(trial.id) or similar.get((trial.engine, trial.scene)) for trial in wanted]
    return Estimate(
        known_s=sum(min(statistics.median(times), limit_s) + START_S for times in known if times),
        same=sum(trial.id in same for trial in wanted),
        similar=sum(times is not None for times in known) - sum(trial.id in same for trial in wanted),
        unknown=sum(times is None for times in known),
        limit_s=limit_s,
        folders=list(used),
    )


def _records(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the readable lines; an estimate ignores the others."""
    try:
        with path.open(encoding="utf-8", errors="replace") as lines:
            for line in lines:
                try:
                    record = json.loads(line)
                except ValueError:
                    continue
                if isinstance(record, dict) and "trial" in record:
                    yield record
    except OSError:
        return


def _duration(seconds: float) -> str:
    for unit, length in (("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}" if seconds >= 10 * length else f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"
