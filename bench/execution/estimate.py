"""How long a plan will take, told from earlier trials, and how much of that is a guess."""

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
"""Share of each trial [s] for its process and its files."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Time that trials will take, and what it was told from."""

    known_s: float
    """Of the trials of which something is known [s], one after another."""
    same: int
    """Number of trials that were run before."""
    similar: int
    """Number of those that only others of their engine and scene stand for."""
    unknown: int
    limit_s: float
    """Longest time [s] that an unknown trial may take."""
    folders: Sequence[Path]
    """The results that were used."""

    def told(self, jobs: int) -> str:
        """In words, for ``jobs`` trials at a time."""
        count = self.same + self.similar + self.unknown
        longest = f"at most {_duration(self.unknown * self.limit_s / jobs)}"
        if not self.folders:
            return f"{count} trials: {longest}; no earlier trials tell more"
        source = f"{self.same} from the same trials, {self.similar} from others of their engine and scene"
        folders = ", ".join(map(str, self.folders))
        rest = f", and {longest} for {self.unknown} of which nothing is known" if self.unknown else ""
        return f"{count} trials: about {_duration(self.known_s / jobs)} ({source}, in {folders}){rest}"


def estimate(trials: Iterable[Trial], limit_s: float, folders: Iterable[Path]) -> Estimate:
    """How long ``trials`` will take.

    Args:
        trials: what will be run.
        limit_s: wall time [s] after which a trial is stopped.
        folders: where earlier results may be; those that hold none are passed over.
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
    """The lines that can be read: an estimate need not complain of the others."""
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
