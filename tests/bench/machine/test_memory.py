"""The peak of memory is that since the start: an earlier one of the same process does not count."""

import mmap

import pytest

from bench.machine import memory
from bench.machine.memory import PeakMemory

MIB = 2**20
SLACK_MIB = 8.0
"""What Python and the C library may take, keep or use again at the same time."""


def use(mib: int) -> None:
    """Write to so much memory, and give it back to the system."""
    with mmap.mmap(-1, mib * MIB) as pages:
        pages.write(b"x" * MIB * mib)


def test_only_the_peak_since_the_start_counts() -> None:
    use(96)
    peak = PeakMemory()
    growth = peak.growth_mib()
    if growth is None:
        pytest.skip("the system cannot reset the peak: /proc/self/clear_refs")
    assert growth < SLACK_MIB
    use(32)
    growth = peak.growth_mib()
    assert growth is not None
    assert 32 - SLACK_MIB <= growth < 2 * 32 + SLACK_MIB, "the pages, and the bytes that were written to them"


def test_a_system_that_cannot_reset_the_peak_has_none(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(memory, "_RESET", tmp_path / "nowhere" / "clear_refs")
    assert PeakMemory().growth_mib() is None
