"""What is shown while a study runs."""

import io

from rich.console import Console

from bench.execution.progress import show_progress
from bench.studies.plan import plan_trials
from bench.studies.schema import check_study
from bench.trial.run_trial import bare_record

TRIALS = plan_trials(
    check_study(
        {
            "name": "shown",
            "engines": ["bullet", "pymunk"],
            "policies": ["none"],
            "seeds": 6,
            "scenario": [{"name": "card_house"}],
        },
        "",
    )
)
ENDS = ("completed", "completed", "collapsed", "crashed", "timeout", "completed")


def shown(*, terminal: bool) -> str:
    page = io.StringIO()
    with show_progress(TRIALS, Console(file=page, force_terminal=terminal, width=120)) as progress:
        for trial, end in zip(TRIALS, ENDS, strict=False):
            progress.started(trial)
            progress.finished(trial, bare_record(trial, trial.build_scene(), "abc", end, "why"))
    return page.getvalue()


def test_a_bar_an_engine_counts_how_its_trials_ended() -> None:
    last = [line for line in shown(terminal=True).splitlines() if "bullet" in line and "6/6" in line][-1]
    assert "3 completed, 1 collapsed, 1 failed, 1 timed out" in last


def test_in_a_log_each_trial_has_its_line_and_a_failure_its_reason() -> None:
    lines = shown(terminal=False).splitlines()
    assert len(lines) == len(ENDS)
    assert lines[3].startswith(f"[4/{len(TRIALS)}] {TRIALS[3].id}: crashed")
    assert lines[3].endswith(": why")
