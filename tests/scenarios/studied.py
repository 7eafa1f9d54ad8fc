"""The scenes of a study of the suite, for tests that state something about each."""

from collections.abc import Mapping
from functools import cache

from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from scenarios.model import Scene


@cache
def studied_scenes(study: str) -> Mapping[str, Scene]:
    """Return the scenes of a study by the id of their variant, each built once for all of its trials."""
    trials = {trial.scene: trial for trial in plan_trials(load_study(study))}
    return {name: trial.planned_scene() for name, trial in trials.items()}
