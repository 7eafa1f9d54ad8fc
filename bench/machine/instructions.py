"""A counter of the processor's instructions, for Linux systems that permit it (perf_event_open(2)).

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
    """An event that the Linux kernel counts, given by ``type`` and ``config`` of ``perf_event_attr``."""

    type: int
    config: int


INSTRUCTIONS = Event(0, 1)
"""Retired instructions: PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS."""
COUNTED = "counted"
"""Result of ``availability`` on a machine that counts instructions."""
_SYSCALLS = {"x86_64": 298, "aarch64": 241}
"""Number of the system call ``perf_event_open``, by the name of the architecture."""
_SIZE = 64
"""Size [bytes] of the first version of ``perf_event_attr``, which every kernel accepts."""
_USER_CODE_ONLY = 1 << 5 | 1 << 6
"""Flags of ``perf_event_attr``: exclude_kernel, exclude_hv."""
_THIS_THREAD, _ANY_CPU, _NO_GROUP, _NO_FLAGS = 0, -1, -1, 0
"""Arguments of ``perf_event_open``."""
_COUNT_BYTES = 8
"""Size of a count [bytes]."""
_REASONS = {
    errno.ENOENT: "the processor shows no counter, as in many virtual machines",
    errno.EOPNOTSUPP: "the processor shows no counter, as in many virtual machines",
    errno.EACCES: "not allowed here: set kernel.perf_event_paranoid to 2 or less",
    errno.EPERM: "not allowed here: set kernel.perf_event_paranoid to 2 or less, or permit perf_event_open",
    errno.ENOSYS: "the kernel has no perf events",
}
"""Reasons why a process cannot count instructions, by the error number of ``perf_event_open``."""


class InstructionCounter:
    """Counter of an event in the user code of the thread that creates the counter."""

    def __init__(self, event: Event = INSTRUCTIONS) -> None:
        """Start the counter.

        Raises:
            OSError: if the system does not permit the counter, or has no such counter.
        """
        number = _SYSCALLS.get(platform.machine())
        if sys.platform != "linux" or number is None:
            raise OSError(
                errno.ENOSYS,
                f"the counter of instructions needs Linux on x86-64 or 64-bit ARM, got {sys.platform} on "
                f"{platform.machine()}: compare times on this system",
            )
        fields = struct.pack("=IIQQQQQ", event.type, _SIZE, event.config, 0, 0, 0, _USER_CODE_ONLY)
        attributes = ctypes.create_string_buffer(fields, _SIZE)
        libc = ctypes.CDLL(None, use_errno=True)
        self._file: int = libc.syscall(number, attributes, _THIS_THREAD, _ANY_CPU, _NO_GROUP, _NO_FLAGS)
        if self._file < 0:
            code = ctypes.get_errno()
            raise OSError(
                code,
                f"no counter of instructions on this system ({_REASONS.get(code, os.strerror(code))}): remove the "
                "cause, or compare times",
            )

    def __call__(self) -> int:
        """Return the number of events since the start."""
        return int.from_bytes(os.read(self._file, _COUNT_BYTES), sys.byteorder)

    def close(self) -> None:
        """Close the counter."""
        os.close(self._file)


@cache
def process_counter() -> InstructionCounter | None:
    """Return the instruction counter of this process, which the first call opens; None if there is no counter."""
    try:
        return InstructionCounter()
    except OSError:
        return None


def availability() -> str:
    """Return ``COUNTED``, or the reason why this process cannot count instructions."""
    try:
        InstructionCounter().close()
    except OSError as error:
        return _REASONS.get(error.errno or 0, str(error))
    return COUNTED
