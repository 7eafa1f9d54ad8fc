"""Names of scenes for readers: a scene from a user's own file has the name of the file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import PurePath

from reports.records.trial import TrialRecord

OWN_SCENE = "own_scene"
"""Scenario of scenes from files."""
_UNCHANGED = {"size": 1.0, "mass": 1.0, "yaw": 0.0}
"""Parameters of such a scene that leave it as it is in its file."""


def scene_name(trial: TrialRecord) -> str:
    """Return the name of a trial's scene: its id, or for an own scene the file's name and what is varied."""
    file = trial.parameters.get("file")
    if trial.scenario != OWN_SCENE or file is None:
        return trial.scene
    varied = [
        f"{name} {float(trial.parameters[name]):g}"
        for name, unchanged in _UNCHANGED.items()
        if trial.parameters.get(name, unchanged) != unchanged
    ]
    return ", ".join([PurePath(str(file)).stem, *varied])


def scene_names(trials: Sequence[TrialRecord]) -> dict[str, str]:
    """Return the name of each scene by its id, in order of appearance; the id itself where two scenes share a name."""
    names = {trial.scene: scene_name(trial) for trial in trials}
    shared = Counter(names.values())
    return {scene: name if shared[name] == 1 else scene for scene, name in names.items()}


def own_names(trials: Iterable[TrialRecord]) -> list[str]:
    """Return the names of the users' own scenes if a study has no others; else an empty list."""
    names = {scene_name(trial): trial.scenario for trial in trials}
    return list(names) if set(names.values()) == {OWN_SCENE} else []
