"""Ctrl-C in a terminal: the whole process group gets it, finished trials are kept, and nothing is left behind."""

import fcntl
import os
import pty
import signal
import termios
import time

import psutil
import pytest

from bench.execution.signals import Interruption
from reports.records.trial import read_records


class Terminal:
    """A terminal in which a program is the foreground process group, as a shell would start it."""

    def __init__(self, suite, *options: str) -> None:
        self._master, slave = pty.openpty()
        self.process = suite.start(
            *options, stdin=slave, stdout=slave, stderr=slave, preexec_fn=self._take_terminal, start_new_session=True
        )
        os.close(slave)
        os.set_blocking(self._master, False)
        self.shown = ""

    @staticmethod
    def _take_terminal() -> None:
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    def press_ctrl_c(self) -> None:
        os.write(self._master, b"\x03")

    def wait_until(self, reached, timeout_s: float = 600) -> None:
        """Read what is shown until something is reached."""
        deadline = time.monotonic() + timeout_s
        while not reached():
            assert time.monotonic() < deadline, self.shown
            try:
                self.shown += os.read(self._master, 2**16).decode(errors="replace")
            except BlockingIOError:
                time.sleep(0.02)
            except OSError:  # the last program has closed its side
                time.sleep(0.02)

    def left_behind(self) -> list[psutil.Process]:
        """Processes of the session that outlive the program."""
        return [one for one in psutil.process_iter() if self._is_ours(one.pid)]

    def _is_ours(self, pid: int) -> bool:
        try:
            return os.getsid(pid) == self.process.pid
        except ProcessLookupError:
            return False


@pytest.mark.parametrize("presses", [1, 2])
def test_ctrl_c_in_a_terminal_keeps_finished_trials_and_leaves_no_process(rogue_suite, presses) -> None:
    rogue_suite.write_study(["slow"], seeds=50)
    terminal = Terminal(rogue_suite)
    path = rogue_suite.out / "trials.jsonl"
    terminal.wait_until(lambda: path.exists() and path.read_bytes().count(b"\n") >= 1)
    for _ in range(presses):
        terminal.press_ctrl_c()
        time.sleep(0.05)
    terminal.wait_until(lambda: terminal.process.poll() is not None)
    terminal.wait_until(lambda: not terminal.left_behind(), timeout_s=600)
    kept = len(read_records(path))
    assert terminal.process.returncode == 130
    assert f"interrupted: {kept} of 50 trials are kept" in " ".join(terminal.shown.split())
    assert "Traceback" not in terminal.shown
    assert not list(rogue_suite.out.glob("**/*.part"))


def test_a_wish_to_stop_is_noted_once_and_breaks_off_only_what_cannot_look() -> None:
    with Interruption() as interruption:
        assert not interruption.is_set()
        with pytest.raises(KeyboardInterrupt), interruption.at_once():
            os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGINT)
        assert interruption.is_set()
        assert interruption.exit_status == 128 + signal.SIGTERM
        with pytest.raises(KeyboardInterrupt), interruption.at_once():
            pytest.fail("it was asked to stop before")
