"""Estimate the duration of a plan on this machine, from earlier trials in results folders and published folders.

The estimate scales each earlier wall time by the ratio of two times of a fixed calculation
(``bench.machine.calibration``): the time on this machine now, over the time before and after the earlier trial. If
either time is unknown, the ratio is 1. The estimate for a trial is the median of the scaled wall times of the first of
these sets that is not empty:

1. records of the same trial, of any version of the engine;
2. trials with the same engine, profile, scene and policy: other seeds or repeats;
3. trials with the same engine, scene and use of an extension (the stability core or joints, against none);
4. trials with the same engine and scene;
5. trials with the same engine, profile and use of an extension;
6. trials with the same engine and use of an extension;
7. trials with the same use of an extension;
8. all trials.

For sets 5 to 8, the estimate uses the wall time per level and simulated second, and is at least ``LEAST_S``.
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
"""Overhead of each trial [s] for its process, its files and the harness: the lower end of 0.3 to 0.5 s, measured on a
machine whose fixed calculation takes ``START_MS``."""
START_MS = 0.125
"""Time of the fixed calculation [ms] on the machine where ``START_S`` was measured."""
RUN_S = 4.0
"""Time to start a run [s], which loads engines and harness once."""
LEAST_S = 0.2
"""Least estimate of a wall time from other scenes or engines [s], because an engine takes that long to open."""

MOST_LISTED = 3
"""Greatest number of folders of one parent that a summary lists by name."""

Source: TypeAlias = Literal["same", "similar", "guessed"]
"""Origin of an estimated time: the same trial, trials of the same engine and scene, or other scenes or engines."""
Setting: TypeAlias = PastTrial | Trial
"""An earlier trial, or a trial to estimate."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimated duration of trials, and its sources."""

    known_s: float
    """Sum of the estimated times of the trials with an estimate [s]."""
    same: int
    """Number of trials estimated from records of the same trial."""
    similar: int
    """Number of trials estimated from other trials of the same engine and scene."""
    guessed: int
    """Number of trials estimated from other scenes or engines."""
    unknown: int
    """Number of trials without an estimate."""
    limit_s: float
    """Longest possible time of a trial without an estimate [s]."""
    folders: Sequence[Path]
    """Folders with an earlier trial of a wanted engine and scene; without such a folder, all folders with trials."""

    def summary(self, jobs: int) -> str:
        """Return the estimate as text, for ``jobs`` concurrent trials."""
        count = self.same + self.similar + self.guessed + self.unknown
        longest = f"at most {_duration(self.unknown * self.limit_s / jobs)}"
        if not self.folders:
            return f"{count} trials: {longest}; there are no earlier trials to estimate from"
        counts = {
            "from the same trials": self.same,
            "from other trials of their engine and scene": self.similar,
            "from other scenes or engines": self.guessed,
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
    """Estimate the duration of ``trials``.

    Args:
        trials: the trials to run.
        limit_s: wall time [s] after which the harness stops a trial.
        folders: folders of earlier results; the function skips folders without results.
        calibration_ms: time [ms] of the fixed calculation on this machine now; None disables the scaling.
        busy: factor by which the load of other processes lengthens wall times, 1 on an idle machine.
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
    """Scaled wall times by the keys in ``_KEYS``, and wall times per level and second by the keys in ``_RATE_KEYS``."""

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
        """Return the estimated wall time [s] of a trial and its source; None without a suitable earlier trial."""
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
        """Return whether a trial in ``past`` has the engine and the scene of a trial in ``wanted``."""
        engines_and_scenes = {(trial.engine, trial.scene) for trial in wanted}
        return any((trial.engine, trial.scene) in engines_and_scenes for trial in past)


def _is_steered(trial: Setting) -> bool:
    """Return whether a trial uses the stability core, or joins bodies."""
    return BENCH_POLICIES[trial.policy].is_steered


def _id(trial: Setting) -> Hashable:
    return trial.trial if isinstance(trial, PastTrial) else trial.id


_KEYS: tuple[Callable[[Setting], Hashable], ...] = (
    _id,
    lambda trial: (trial.engine, trial.profile, trial.scene, trial.policy),
    lambda trial: (trial.engine, trial.scene, _is_steered(trial)),
    lambda trial: (trial.engine, trial.scene),
)
"""Keys of wall times, the most specific key first; an estimate uses earlier trials with an equal key."""
_RATE_KEYS: tuple[Callable[[Setting], Hashable], ...] = (
    lambda trial: (trial.engine, trial.profile, _is_steered(trial)),
    lambda trial: (trial.engine, _is_steered(trial)),
    lambda trial: _is_steered(trial),
    lambda _: "all",
)
"""Keys of wall times per level and simulated second, the most specific key first."""


def _listed(folders: Sequence[Path]) -> str:
    """Return the folders as text; for more than ``MOST_LISTED`` folders of one parent, only their number and parent."""
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
