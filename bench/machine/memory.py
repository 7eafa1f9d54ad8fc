"""The peak of the resident memory of this process during an interval, on Linux."""

from __future__ import annotations

from pathlib import Path

_STATUS = Path("/proc/self/status")
_RESET = Path("/proc/self/clear_refs")
_RESET_PEAK = "5"
"""Text to write to ``clear_refs``, which resets the peak to the present size (proc_pid_clear_refs(5))."""
_KIB_PER_MIB = 1024


class PeakMemory:
    """Measurement of the growth of this process's resident memory above the size at the start.

    The constructor resets the peak, so that an earlier peak of the same process does not count.
    """

    def __init__(self) -> None:
        self._begin_kib = _reset_peak()

    def growth_mib(self) -> float | None:
        """Return the greatest growth since the start [MiB]; None if the system does not report the peak."""
        peak_kib = _read("VmHWM")
        if self._begin_kib is None or peak_kib is None:
            return None
        return (peak_kib - self._begin_kib) / _KIB_PER_MIB


def _reset_peak() -> int | None:
    """Reset the peak to the present size and return the peak [KiB]; return None if the system forbids the reset."""
    try:
        _RESET.write_text(_RESET_PEAK, encoding="ascii")
    except OSError:
        return None
    return _read("VmHWM")


def _read(field: str) -> int | None:
    """Return a field of the status file of this process [KiB]; None if the file or the field is missing."""
    try:
        lines = _STATUS.read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) for line in lines if line.startswith(f"{field}:")), None)
