"""Exact counts of instructions under Valgrind's tool Callgrind, where the processor shows no counter.

Valgrind translates all code, also compiled kernels, and counts the instructions that it executes. A program runs about
fifty times slower in Valgrind, but counts repeat within 0.1 %, also on a machine that runs other work. A program
controls the counter by client requests: Valgrind recognises a sequence of instructions that has no other effect. The
requests in ``valgrind.h`` are stable.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import platform
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

_REQUEST = bytes.fromhex(
    "4889f8"  # mov rax, rdi: address of the request
    "31d2"  # xor edx, edx: the result without Valgrind
    "48c1c703 48c1c70d 48c1c73d 48c1c733"  # rol rdi, 3; 13; 61; 51: no effect together
    "4887db"  # xchg rbx, rbx: the request
    "4889d0"  # mov rax, rdx: the result
    "c3"  # ret
)
"""Machine code (x86-64) of a function that makes the client request at an address and returns its result."""
_REQUEST_WORDS = 6
"""Length of a client request [64-bit words]: its number and five arguments."""
_RUNNING_ON_VALGRIND = 0x1001
_CALLGRIND = ord("C") << 24 | ord("T") << 16
_DUMP, _ZERO, _START = _CALLGRIND, _CALLGRIND + 1, _CALLGRIND + 4
"""Client requests: write the counts into a file, set them to zero, start counting."""
_FILE = "STILLSTACK_CALLGRIND"
"""Environment variable with the path of the files of counts."""
CPU = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
"""Environment variables for Numba: the processor for which to compile kernels. Valgrind 3.19 does not know AVX-512."""


def obstacle() -> str | None:
    """Return the reason why Callgrind cannot count on this machine; None without a reason."""
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return f"Callgrind is controlled on x86-64 only, and this is {platform.machine()}"
    return None if shutil.which("valgrind") else "Valgrind is not installed (apt-get install valgrind)"


def command_under_callgrind(command: Sequence[str], file: Path) -> tuple[list[str], dict[str, str]]:
    """Return the command that runs ``command`` under Callgrind, and its environment.

    Args:
        command: the program and its arguments.
        file: path of the files of counts. Callgrind appends a number to the path of each file.
    """
    tool = ["valgrind", "--quiet", "--tool=callgrind", "--instr-atstart=no", f"--callgrind-out-file={file}"]
    steady = {"PYTHONHASHSEED": "0", "OPENBLAS_NUM_THREADS": "1", _FILE: str(file)}
    return [*tool, *command], {**os.environ, **CPU, **steady}


class CallgrindCounter:
    """Counter of the instructions of a function call, in a program that runs under Callgrind."""

    def __init__(self) -> None:
        """Start the counter.

        Raises:
            OSError: if ``obstacle`` returns a reason, ``command_under_callgrind`` did not start the program, or
                Valgrind does not answer.
        """
        if obstacle() is not None or _FILE not in os.environ:
            raise OSError(
                f"this program does not run under Callgrind ({obstacle() or f'{_FILE} is not set'}): on x86-64 with "
                "Valgrind, start the program with command_under_callgrind"
            )
        self._code = mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
        self._code.write(_REQUEST)
        address = ctypes.addressof(ctypes.c_char.from_buffer(self._code))
        self._ask = ctypes.CFUNCTYPE(ctypes.c_uint64, ctypes.c_void_p)(address)
        self._dumps = 0
        if not self._request(_RUNNING_ON_VALGRIND):
            raise OSError(
                "this program does not run under Callgrind (Valgrind does not answer): start the program with "
                "command_under_callgrind"
            )
        self._request(_START)
        self._overhead = 0
        self._overhead = self.count(lambda: None)

    def count(self, act: Callable[[], object]) -> int:
        """Return the number of instructions of a call of ``act``, without the instructions for the count itself."""
        self._request(_ZERO)
        act()
        self._request(_DUMP)
        self._dumps += 1
        file = Path(f"{os.environ[_FILE]}.{self._dumps}")
        lines = file.read_text(encoding="ascii", errors="replace").splitlines()
        file.unlink()
        (total,) = (int(line.split()[1]) for line in lines if line.startswith("totals:"))
        return total - self._overhead

    def _request(self, number: int) -> int:
        words = (ctypes.c_uint64 * _REQUEST_WORDS)(number)
        result: int = self._ask(ctypes.addressof(words))
        return result
