"""Estimate the duration of a plan from earlier trials, here or published, scaled to this machine.

A wall time is scaled by the fixed calculation that every trial takes the time of (``bench.machine.calibration``): what
it takes now over what it took then. For each trial the first of these that is known counts, as a median:

1. the same trial;
2. others of its engine, profile, scene and policy: other seeds, an earlier version;
3. others of its engine and scene, with an extension if it has one, else without;
4. others of its engine, or else of any, likewise: wall time per level and simulated second.
"""

from __future__ import annotations

import os
import statistics
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from bench.execution.past_trials import PastTrial, past_trials
from bench.studies.plan import Trial
from bench.studies.policies import BENCH_POLICIES

START_S = 0.3
"""Share of each trial [s] for its process, its files and the harness: 0.3 to 0.5 s on a machine whose fixed calculation
takes ``START_MS``."""
START_MS = 0.125
"""See ``START_S`` [ms]."""
RUN_S = 4.0
"""Start of a run [s]: it loads engines and harness once."""
LEAST_S = 0.2
"""Least wall time of a trial [s] that is estimated from what there is to simulate: opening an engine takes as long."""

MOST_LISTED = 3
"""Folders of one parent that are listed by their names."""

Source: TypeAlias = Literal["same", "similar", "guessed"]
Setting: TypeAlias = PastTrial | Trial


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimated time of trials, and its sources."""

    known_s: float
    """Total time of the trials that can be estimated [s], one after another."""
    same: int
    """Number of trials that were run before."""
    similar: int
    """Number of trials estimated from others of their engine and scene."""
    guessed: int
    """Number of trials estimated from other scenes."""
    unknown: int
    limit_s: float
    """Longest time [s] of an unknown trial."""
    folders: Sequence[Path]
    """Results folders that were used."""

    def summary(self, jobs: int) -> str:
        """Return the estimate in words, for ``jobs`` trials at a time."""
        count = self.same + self.similar + self.guessed + self.unknown
        longest = f"at most {_duration(self.unknown * self.limit_s / jobs)}"
        if not self.folders:
            return f"{count} trials: {longest}; there are no earlier trials to estimate from"
        counts = {
            "from the same trials": self.same,
            "from others of their engine and scene": self.similar,
            "from other scenes": self.guessed,
        }
        source = ", ".join(f"{number} {words}" for words, number in counts.items() if number)
        folders = _listed(self.folders)
        rest = f", and {longest} for {self.unknown} unknown trials" if self.unknown else ""
        return f"{count} trials: about {_duration(RUN_S + self.known_s / jobs)} ({source}, in {folders}){rest}"


def estimate(
    trials: Iterable[Trial],
    limit_s: float,
    folders: Iterable[Path],
    *,
    calibration_ms: float | None = None,
    busy: float = 1.0,
) -> Estimate:
    """Estimate the time of ``trials``.

    Args:
        trials: the trials to run.
        limit_s: wall time [s] after which a trial is stopped.
        folders: folders of earlier results; folders without results are skipped.
        calibration_ms: time of the fixed calculation on this machine now; None leaves wall times as they are.
        busy: how many times longer anything takes because others use the machine.
    """
    wanted = list(trials)
    past = {folder: past_trials(folder) for folder in folders}
    known = _Known([trial for of_folder in past.values() for trial in of_folder], calibration_ms)
    found = [known.wall_s(trial) for trial in wanted]
    start_s = START_S * (1.0 if calibration_ms is None else calibration_ms / START_MS)
    seconds = [min(busy * wall_s, limit_s) + busy * start_s for wall_s, _ in filter(None, found)]
    sources = Counter(source for _, source in filter(None, found))
    return Estimate(
        known_s=sum(seconds),
        same=sources["same"],
        similar=sources["similar"],
        guessed=sources["guessed"],
        unknown=found.count(None),
        limit_s=limit_s,
        folders=[folder for folder, of_folder in past.items() if known.uses(of_folder, wanted)]
        or [folder for folder, of_folder in past.items() if of_folder],
    )


class _Known:
    """Scaled wall times of earlier trials, by what they may stand for."""

    def __init__(self, past: Sequence[PastTrial], calibration_ms: float | None) -> None:
        self._times: dict[Hashable, list[float]] = defaultdict(list)
        self._rates: dict[Hashable, list[float]] = defaultdict(list)
        for trial in past:
            if trial.policy not in BENCH_POLICIES:
                continue
            scale = calibration_ms / trial.calibration_ms if calibration_ms and trial.calibration_ms else 1.0
            for key in _KEYS:
                self._times[key(trial)].append(scale * trial.wall_s)
            if trial.level_s > 0:
                for rate_key in _RATE_KEYS:
                    self._rates[rate_key(trial)].append(scale * trial.wall_s / trial.level_s)

    def wall_s(self, trial: Trial) -> tuple[float, Source] | None:
        """Return the wall time [s] of a trial and its source; None if there are no earlier trials."""
        for index, key in enumerate(_KEYS):
            if times := self._times.get(key(trial)):
                return statistics.median(times), "similar" if index else "same"
        for rate_key in _RATE_KEYS:
            if rates := self._rates.get(rate_key(trial)):
                scene = trial.planned_scene()
                seconds = statistics.median(rates) * scene.levels * (scene.done_s + scene.watch_s)
                return max(LEAST_S, seconds), "guessed"
        return None

    def uses(self, past: Sequence[PastTrial], wanted: Sequence[Trial]) -> bool:
        """Return True if one of ``past`` stands for one of ``wanted``, by engine and scene or closer."""
        engines_and_scenes = {(trial.engine, trial.scene) for trial in wanted}
        return any((trial.engine, trial.scene) in engines_and_scenes for trial in past)


def _is_steered(trial: Setting) -> bool:
    """Return True if an extension works in a trial."""
    return BENCH_POLICIES[trial.policy].core is not None


def _id(trial: Setting) -> Hashable:
    return trial.trial if isinstance(trial, PastTrial) else trial.id


_KEYS: tuple[Callable[[Setting], Hashable], ...] = (
    _id,
    lambda trial: (trial.engine, trial.profile, trial.scene, trial.policy),
    lambda trial: (trial.engine, trial.scene, _is_steered(trial)),
    lambda trial: (trial.engine, trial.scene),
)
"""What trials have in common that stand for each other, the closest first."""
_RATE_KEYS: tuple[Callable[[Setting], Hashable], ...] = (
    lambda trial: (trial.engine, trial.profile, _is_steered(trial)),
    lambda trial: (trial.engine, _is_steered(trial)),
    lambda trial: _is_steered(trial),
    lambda _: "all",
)


def _listed(folders: Sequence[Path]) -> str:
    """Return folders in words; those of one parent are counted if there are many."""
    by_parent = Counter(folder.parent for folder in folders)
    few = [str(folder) for folder in folders if by_parent[folder.parent] <= MOST_LISTED]
    many = [
        f"{count} folders of {os.path.relpath(parent)}" for parent, count in by_parent.items() if count > MOST_LISTED
    ]
    return ", ".join([*few, *many])


def _duration(seconds: float) -> str:
    for unit, length in (("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}" if seconds >= 10 * length else f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"
