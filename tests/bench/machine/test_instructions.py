"""Instructions are counted where the system allows it; else the reason is given."""

import errno

import pytest

from bench.machine import instructions
from bench.machine.instructions import COUNTED, Event, InstructionCounter, availability

TASK_CLOCK = Event(1, 1)
"""Processor time of the thread [ns], PERF_COUNT_SW_TASK_CLOCK: the kernel counts it also where no processor does."""
UNKNOWN = Event(0, 999)


def work(steps: int) -> None:
    sum(range(steps))


def opened(event: Event) -> InstructionCounter:
    try:
        return InstructionCounter(event)
    except OSError as error:
        pytest.skip(f"the system has no such counter: {error}")


def counts(event: Event) -> list[int]:
    """What a counter shows at the start, after some work, and after ten times as much."""
    counter = opened(event)
    shown = [counter()]
    for steps in (100_000, 1_000_000):
        work(steps)
        shown.append(counter())
    counter.close()
    return shown


@pytest.mark.parametrize("event", [TASK_CLOCK, instructions.INSTRUCTIONS])
def test_a_counter_rises_with_the_work_of_its_thread(event: Event) -> None:
    begin, middle, end = counts(event)
    assert 0 <= begin < middle < end
    assert 3 < (end - middle) / (middle - begin) < 30, "ten times the work"


def test_an_event_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(OSError, match=r"\S"):
        InstructionCounter(UNKNOWN)


def test_what_cannot_be_counted_has_a_reason(monkeypatch) -> None:
    assert availability() == COUNTED or availability().split()[0] in {"the", "not", "[Errno"}

    def refuse(*_) -> InstructionCounter:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(instructions, "InstructionCounter", refuse)
    assert availability() == "not allowed here: set kernel.perf_event_paranoid to 2 or less"
