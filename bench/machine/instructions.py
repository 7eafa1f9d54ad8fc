"""A count of the processor's instructions, on Linux where the system allows it (perf_event_open(2)).

Virtual machines and containers often hide the counter.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
import sys
from functools import cache
from typing import NamedTuple


class Event(NamedTuple):
    """An event that the kernel counts: ``type`` and ``config`` of ``perf_event_attr``."""

    type: int
    config: int


INSTRUCTIONS = Event(0, 1)
"""Retired instructions: PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS."""
COUNTED = "counted"
_SYSCALLS = {"x86_64": 298, "aarch64": 241}
"""Number of ``perf_event_open`` by the name of the architecture."""
_SIZE = 64
"""Size [bytes] of the first version of ``perf_event_attr``, which every kernel accepts."""
_USER_CODE_ONLY = 1 << 5 | 1 << 6
"""Flags of ``perf_event_attr``: exclude_kernel, exclude_hv."""
_THIS_THREAD, _ANY_CPU, _NO_GROUP, _NO_FLAGS = 0, -1, -1, 0
_COUNT_BYTES = 8
_REASONS = {
    errno.ENOENT: "the processor shows no counter, as in many virtual machines",
    errno.EOPNOTSUPP: "the processor shows no counter, as in many virtual machines",
    errno.EACCES: "not allowed here: set kernel.perf_event_paranoid to 2 or less",
    errno.EPERM: "not allowed here: set kernel.perf_event_paranoid to 2 or less, or permit perf_event_open",
    errno.ENOSYS: "the kernel has no perf events",
}


class InstructionCounter:
    """Counts an event in user code of the thread that opened it, until the process ends."""

    def __init__(self, event: Event = INSTRUCTIONS) -> None:
        """Start to count.

        Raises:
            OSError: if the system does not allow it, or has no such counter.
        """
        number = _SYSCALLS.get(platform.machine())
        if sys.platform != "linux" or number is None:
            raise OSError(errno.ENOSYS, "perf events are read on Linux, on x86-64 and on 64-bit ARM")
        fields = struct.pack("=IIQQQQQ", event.type, _SIZE, event.config, 0, 0, 0, _USER_CODE_ONLY)
        attributes = ctypes.create_string_buffer(fields, _SIZE)
        libc = ctypes.CDLL(None, use_errno=True)
        self._file: int = libc.syscall(number, attributes, _THIS_THREAD, _ANY_CPU, _NO_GROUP, _NO_FLAGS)
        if self._file < 0:
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))

    def __call__(self) -> int:
        """Return the count since the start."""
        return int.from_bytes(os.read(self._file, _COUNT_BYTES), sys.byteorder)

    def close(self) -> None:
        """End the count."""
        os.close(self._file)


@cache
def process_counter() -> InstructionCounter | None:
    """Return the instruction counter of this process, opened at the first call; None where there is none."""
    try:
        return InstructionCounter()
    except OSError:
        return None


def availability() -> str:
    """Return ``COUNTED``, or the reason why instructions cannot be counted here."""
    try:
        InstructionCounter().close()
    except OSError as error:
        return _REASONS.get(error.errno or 0, str(error))
    return COUNTED
