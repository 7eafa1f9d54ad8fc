"""A core that costs 3 % more instructions is found, and equal cores are equal, on a machine that others share."""

import json
import statistics

import pytest

from bench.machine import callgrind
from tests.benchmarks import core_instructions
from tests.benchmarks.core_instructions import LARGER, growths, measured, under_callgrind

CONDITIONS = {"unit": "instructions", "conditions": {"counter": "Callgrind"}}
PLANTED = 0.03


@pytest.mark.slow
@pytest.mark.skipif(callgrind.obstacle() is not None, reason=f"no counts here: {callgrind.obstacle()}")
def test_three_percent_are_found_nineteen_times_in_twenty_and_equal_cores_never(monkeypatch) -> None:
    """Each of 20 blocks of one process against a block of another; two processes without a plant, one with."""
    monkeypatch.setenv("PYTHONPATH", "tests/bench/plants:.")
    base, same = under_callgrind(), under_callgrind()
    middle = {frame: statistics.median(counts) for frame, counts in base.items()}

    def with_extra(instructions: dict[str, float]) -> dict[str, list[float]]:
        monkeypatch.setenv("EXTRA_INSTRUCTIONS", json.dumps(instructions))
        return under_callgrind("core_three_percent")

    empty = with_extra(dict.fromkeys(base, 0.0))  # the loop costs something even without steps
    planted = with_extra({frame: (1 + PLANTED) * middle[frame] - statistics.median(empty[frame]) for frame in base})
    for frame, counts in base.items():
        growth = statistics.median(planted[frame]) / middle[frame] - 1
        assert growth == pytest.approx(PLANTED, abs=0.004), f"the plant in the {frame} is what it says"
        found = [now / was - 1 > LARGER["instructions"] for was, now in zip(counts, planted[frame], strict=True)]
        false = [now / was - 1 > LARGER["instructions"] for was, now in zip(counts, same[frame], strict=True)]
        assert sum(found) >= 0.95 * len(found), frame
        assert not any(false), frame


def test_growth_is_a_share_of_the_base_and_other_conditions_are_refused() -> None:
    base = CONDITIONS | {"figures": {"quiet frame": 1000.0}}
    head = CONDITIONS | {"figures": {"quiet frame": 1030.0}}
    assert growths(base, head) == {"quiet frame": pytest.approx(0.03)}
    other = head | {"conditions": {"counter": "time: here"}}
    with pytest.raises(ValueError, match=r"counter: time: here, was Callgrind.*measure the base again"):
        growths(base, other)


def test_without_counts_the_reason_is_said_and_the_time_measured(monkeypatch, capsys) -> None:
    monkeypatch.setattr(core_instructions, "availability", lambda: "the processor shows no counter")
    monkeypatch.setattr(callgrind, "obstacle", lambda: "Valgrind is not installed")
    monkeypatch.setattr(core_instructions, "costs", lambda count: {"quiet frame": [count(lambda: sum(range(10_000)))]})
    found = measured()
    assert found["unit"] == "microseconds"
    assert found["figures"]["quiet frame"] > 0
    assert "no instructions are counted: the processor shows no counter; Valgrind is not" in capsys.readouterr().out


def test_a_program_outside_callgrind_is_refused() -> None:
    with pytest.raises(OSError, match="does not run under Callgrind"):
        callgrind.CallgrindCounter()
