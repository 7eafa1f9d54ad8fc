"""A process a trial: whatever an engine does to its process is that trial's outcome, and no other trial's."""

import pytest

from bench.execution import worker
from reports.records.trial import read_records

OUTCOMES = {
    "segfault": ("crashed", "the process died of SIGSEGV: Fatal Python error: Segmentation fault"),
    "abort": ("crashed", "the process died of SIGABRT: Fatal Python error: Aborted"),
    "exit": ("crashed", "the process ended with status 3: no output"),
    "alarm": ("crashed", "the process died of SIGALRM: no output"),
    "leak": ("out_of_memory", "MiB, above its limit of 450 MiB"),
    "raise": ("error", "RuntimeError: the solver gave up"),
    "nan": ("diverged", "poses were not finite"),
    "red_exit": ("crashed", "the process ended with status 3: out of contacts"),
    "garbage": ("completed", ""),
    "game": ("completed", ""),
}
"""By the engine's behaviour: how its trial ends, and the message."""


HANG = {"hang": ("timeout", "the engine hung, and the harness stopped"), "game": ("completed", "")}
HANG_LIMIT_S = 5.0
"""Limit of a trial beside trials that hang [s]: 50 times what a sound one takes."""


@pytest.mark.parametrize(
    ("outcomes", "trial_wall_s"),
    [(OUTCOMES, 600.0), (HANG, HANG_LIMIT_S)],  # only a hang runs into its limit, however slow the machine
    ids=["misdeeds", "hang"],
)
def test_each_misdeed_is_reported_by_its_name_and_costs_one_trial(rogue_suite, outcomes, trial_wall_s) -> None:
    """Misdeeds and sound trials take turns; every sound one is recorded, and the harness ends with status 0."""
    rogue_suite.environment |= {"REPORT": "of every status"}
    rogue_suite.write_study(outcomes, seeds=2, limits={"trial_wall_s": trial_wall_s, "memory_mib": 450})
    output = rogue_suite.run("--jobs", "2")
    assert f"{2 * len(outcomes)} trials are kept in" in output
    records = read_records(rogue_suite.out / "trials.jsonl")
    assert len(records) == 2 * len(outcomes)
    for record in records:
        status, message = outcomes[record.profile]
        assert (record.profile, record.status) == (record.profile, status), record.message
        assert message in record.message
        assert "\x1b" not in record.message
    assert not list(rogue_suite.folder.glob("**/core*"))


def test_a_step_longer_than_the_limit_is_a_timeout_also_if_the_trial_stops_itself(rogue_suite) -> None:
    """The alarm of the process rings first: it dies of SIGALRM, which is no crash of the engine."""
    rogue_suite.environment |= {"GRACE_S": "60", "GRACE_IN_TRIALS_S": "0"}
    rogue_suite.write_study(["hang"], limits={"trial_wall_s": 3.0})
    rogue_suite.run()
    (record,) = read_records(rogue_suite.out / "trials.jsonl")
    assert (record.status, record.verdict) == ("timeout", "undecided")
    assert "the engine hung, and the harness stopped" in record.message


def test_a_step_that_ends_after_the_limit_is_a_timeout(rogue_suite) -> None:
    rogue_suite.environment |= {"GRACE_S": "60"}
    rogue_suite.write_study(["stall"], limits={"trial_wall_s": 3.0})
    rogue_suite.run()
    (record,) = read_records(rogue_suite.out / "trials.jsonl")
    assert record.status == "timeout"
    assert record.message.startswith("stopped after 3 s of wall time at 1.2 simulated seconds; ")


def test_garbled_last_words_are_made_fit_to_print(tmp_path) -> None:
    log = tmp_path / "log"
    log.write_bytes(b"x\n" * 100_000 + b"\xff\x1b[31m out of contacts \n\x1b[0m\n")
    assert worker._last_words(log) == "\N{REPLACEMENT CHARACTER} out of contacts"
    assert worker._last_words(tmp_path / "none") == "no output"
