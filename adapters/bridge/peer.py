"""The process of an engine: its start, the exchange of one message and one answer at a time, and its end."""

from __future__ import annotations

import fcntl
import os
import select
import shutil
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import IO

from adapters.bridge.errors import PeerError, PeerExitError, PeerTimeoutError, ProtocolError
from adapters.bridge.messages import HEADER, MAX_BODY, Kind, json_content

SILENCE_S = 60.0
"""Default time limit [s] for an answer, after which the suite kills the engine. The limit is long, so that the suite
kills no working engine."""
_END_S = 1.0
"""Time limit [s] for an engine to end after ``Peer`` has closed its stdin."""
_PIPE_BYTES = 2**20
"""Capacity of the pipes and of the first buffer [bytes], so that one read receives a frame. The system's default of
64 KiB would hold only the states of 100 bodies over five substeps, without contacts."""
_SPIN_S = 2.5e-4
"""Time [s] before and after the expected arrival of an answer in which ``Peer`` polls without sleep. The system needs
about 25 us to wake a sleeping process, a quarter of the bridge's cost at 100 bodies. For the rest of the wait ``Peer``
sleeps, so that the processor is free for other trials."""
_FD_SETSIZE = 1024
"""First file descriptor that ``select`` cannot wait for."""
_LAST_LINES = 2**12
"""Number of bytes at the end of the engine's stderr in which ``Peer`` looks for the last line."""
_LAUNCH = (
    "import ctypes, os, signal, sys; ctypes.CDLL(None).prctl(1, signal.SIGKILL); os.execvp(sys.argv[1], sys.argv[1:])"
)
"""Python script that starts a program. The Linux kernel kills the program when its parent ends (PR_SET_PDEATHSIG).
Otherwise an engine in an endless computation would run on, because it does not notice a closed stdin."""


class Peer:
    """An engine's process: stdout carries the protocol, and the class stores stderr for error messages."""

    def __init__(self, command: Sequence[str], folder: Path, timeout_s: float = SILENCE_S) -> None:
        """Start the process.

        Args:
            command: program and arguments.
            folder: working directory of the process.
            timeout_s: time limit for the answer to each message.

        Raises:
            PeerError: if ``folder`` and PATH have no executable program of this name.
        """
        program = shutil.which(command[0], path=f"{folder}{os.pathsep}{os.environ.get('PATH', os.defpath)}")
        if program is None:
            raise PeerError(
                f"cannot start the engine: '{command[0]}' must be an executable program in {folder} or on PATH, but is "
                "not; give the full path of the program"
            )
        self._name = " ".join(command)
        self._timeout_s = timeout_s
        self._printed: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed when the process ends
        launch = [sys.executable, "-ISc", _LAUNCH] if sys.platform == "linux" else []
        process = subprocess.Popen(
            [*launch, str(Path(program).absolute()), *command[1:]],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._printed,
            cwd=folder,
            bufsize=0,
        )
        self._process = process
        assert process.stdin is not None
        assert process.stdout is not None
        self._in, self._out = process.stdin.fileno(), process.stdout.fileno()
        for pipe in (self._in, self._out):
            os.set_blocking(pipe, False)
            _widen(pipe)
        self._readable, self._writable = select.poll(), select.poll()
        self._readable.register(self._out, select.POLLIN)
        self._writable.register(self._in, select.POLLOUT)
        self._buffer = memoryview(bytearray(_PIPE_BYTES))
        self._expected_s = 0.0  # wait for the latest answer
        self._end = weakref.finalize(self, _end, process, self._printed)

    def ask(self, kind: Kind, body: bytes) -> memoryview:
        """Send a message and return the body of the answer, a view that is valid until the next call.

        Raises:
            PeerError: if the engine answers with an error.
            ProtocolError: if the answer has another kind or breaks the protocol, or the process closes a pipe and runs
                on.
            PeerExitError: if the process ends.
            PeerTimeoutError: if the answer does not arrive in time; the method has killed the process.
        """
        deadline = monotonic() + self._timeout_s
        self._send(HEADER.pack(len(body), kind) + body, deadline)
        self._await_beginning()
        answered, answer = self._receive(deadline)
        if answered == Kind.ERROR:
            raise PeerError(
                f"the engine reports an error: {json_content(answer).get('message', 'no message')}; correct the cause "
                "in the engine's program"
            )
        if answered != kind:
            raise ProtocolError(
                f"the engine's answer must have the kind {kind.value}, or 4 for an error, got {answered}: give the "
                "answer the kind of the message"
            )
        return answer

    def close(self) -> None:
        """Close the pipes to the engine, so that its process ends; kill the process if it runs on for ``_END_S``."""
        self._end()

    def _send(self, message: bytes, deadline: float) -> None:
        rest = memoryview(message)
        while rest:
            try:
                rest = rest[os.write(self._in, rest) :]
            except BlockingIOError:
                self._await(self._writable, deadline)
            except BrokenPipeError:
                raise self._exited() from None

    def _await_beginning(self) -> None:
        """Wait until an answer begins, at most ``_SPIN_S`` longer than the wait for the latest answer.

        ``poll`` sleeps for whole milliseconds only. Therefore ``select`` sleeps here, if it can wait for the pipe.
        """
        if self._out >= _FD_SETSIZE:
            return
        begun = monotonic()
        quiet_s = self._expected_s - _SPIN_S
        if quiet_s > 0.0:
            select.select((self._out,), (), (), quiet_s)
        while not self._readable.poll(0) and monotonic() - begun < self._expected_s + _SPIN_S:
            pass
        self._expected_s = monotonic() - begun

    def _receive(self, deadline: float) -> tuple[int, memoryview]:
        """Return the kind and the body of the next message; one read receives a message that fits the pipe."""
        have, need = 0, HEADER.size
        while have < need:
            self._await(self._readable, deadline)
            try:
                count = os.readv(self._out, [self._buffer[have:]])
            except BlockingIOError:
                continue
            if not count:
                raise self._exited()
            have += count
            if have >= HEADER.size:
                length, _ = HEADER.unpack_from(self._buffer)
                need = HEADER.size + length
                self._check_announced(length)
                if need >= len(self._buffer):  # one byte more, to detect output after the message
                    self._enlarge(need + 1, have)
        if have > need:
            raise ProtocolError(
                "the engine must write only its answer to stdout, but wrote other output after the answer: print "
                "other text to stderr"
            )
        return HEADER.unpack_from(self._buffer)[1], self._buffer[HEADER.size : need]

    def _enlarge(self, size: int, have: int) -> None:
        """Replace the buffer by a buffer of ``size`` bytes, and copy the ``have`` bytes received so far."""
        larger = memoryview(bytearray(size))
        larger[:have] = self._buffer[:have]
        self._buffer = larger

    def _check_announced(self, length: int) -> None:
        if length > MAX_BODY:
            begin = bytes(self._buffer[: HEADER.size])
            raise ProtocolError(
                f"a message of the engine must have at most {MAX_BODY} bytes, got a header {begin!r}, which announces "
                f"{length} bytes: if this header is text, print the text to stderr"
            )

    def _await(self, poll: select.poll, deadline: float) -> None:
        """Wait until a pipe is ready for the next read or write.

        Raises:
            PeerTimeoutError: if the deadline passes; the method has killed the process.
        """
        if not poll.poll(max(0.0, (deadline - monotonic()) * 1e3)):
            self._process.kill()
            raise PeerTimeoutError(
                f"the engine must answer within {self._timeout_s:g} s, but did not ({self._name}): raise the engine's "
                "timeout_s if the engine needs more time"
            )

    def _exited(self) -> PeerError:
        """Return the error for a process that closed its stdin or stdout."""
        try:
            code = self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            return ProtocolError(
                "the engine must keep stdin and stdout open until its process ends, but closed stdin or stdout "
                "earlier: close both only at the end of the process"
            )
        ending = f"with status {code}" if code >= 0 else f"by signal {-code}"
        return PeerExitError(
            f"the engine's process ended {ending}: {self._last_line()}; find the cause in the engine's program"
        )

    def _last_line(self) -> str:
        """Return the last line with text that the engine printed to stderr, or "it printed nothing"."""
        size = self._printed.seek(0, os.SEEK_END)
        self._printed.seek(max(0, size - _LAST_LINES))
        lines = [line.strip() for line in self._printed.read().decode(errors="replace").splitlines() if line.strip()]
        return lines[-1][:300] if lines else "it printed nothing"


def _widen(pipe: int) -> None:
    """Raise the capacity of a pipe to ``_PIPE_BYTES``, if the system allows this capacity."""
    if hasattr(fcntl, "F_SETPIPE_SZ"):
        with suppress(OSError):  # the capacity exceeds the user's limit
            fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)


def _end(process: subprocess.Popen[bytes], printed: IO[bytes]) -> None:
    """Close the pipes of a process, wait for its end, and kill the process if it does not end."""
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with suppress(OSError):
                pipe.close()
    try:
        process.wait(_END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    printed.close()
