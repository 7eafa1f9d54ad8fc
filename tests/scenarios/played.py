"""A scene played by an engine, without the command line and without times."""

from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial
from reports.records.trial import TrialRecord

_LIMITS = Limits(ratio=False)


def played(engine: str, profile: str, scenario: str, parameters: dict, policy: str) -> TrialRecord:
    """Return the record of a trial of the exact scene (seed 0)."""
    trial = Trial(engine, profile, scenario, "", parameters, policy, 0, 0)
    return run_trial(trial, _LIMITS, "", lambda _: None).record
