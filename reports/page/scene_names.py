"""Names of scenes for readers; a user's own scene has the name of its file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import PurePath

from reports.records.trial import TrialRecord

OWN_SCENE = "own_scene"
"""Name of the scenario of users' own scenes, which come from files."""
_MOST_IN_TITLE = 3
"""Greatest number of scenes whose names form the title of a study."""
_UNCHANGED = {"size": 1.0, "mass": 1.0, "yaw": 0.0}
"""Values of the parameters with which a user's own scene is the same as in its file."""


def scene_name(trial: TrialRecord) -> str:
    """Return the name of a trial's scene: the scene's id or, for a user's own scene, a readable name.

    The readable name contains the file name without suffix, and the parameters that differ from ``_UNCHANGED``.
    """
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
    """Return the name of each scene, by id, in order of appearance; scenes of equal names have their ids as names."""
    names = {trial.scene: scene_name(trial) for trial in trials}
    shared = Counter(names.values())
    return {scene: name if shared[name] == 1 else scene for scene, name in names.items()}


def title_of(trials: Iterable[TrialRecord], study: str) -> str:
    """Return the title of a study: the names of its scenes, or ``study``, the name of the study.

    The names form the title if all scenes are users' own scenes, and there are at most ``_MOST_IN_TITLE`` names.
    """
    names = {scene_name(trial): trial.scenario for trial in trials}
    is_own = set(names.values()) == {OWN_SCENE}
    return ", ".join(names) if is_own and len(names) <= _MOST_IN_TITLE else study
