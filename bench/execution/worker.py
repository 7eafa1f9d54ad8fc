"""Run one trial in a new process, so that an engine's crash ends this trial only.

The fork server (``forkserver``) forks the process, so that the process need not load the modules again. No trial sees
changes that another trial makes in memory.
"""

from __future__ import annotations

import faulthandler
import math
import multiprocessing
import os
import resource
import signal
import sys
import threading
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from multiprocessing import connection
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic

import psutil
from pebble import ProcessExpired, ProcessFuture

from bench.execution.forkserver import CONTEXT, in_process
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.playback import Progress
from bench.trial.run_trial import Outcome, bare_record, run_trial
from reports.records.plain_text import plain_text
from reports.records.trial import Status
from reports.replays.live_view import live_view

GRACE_S = 60.0
"""Time after the limit on wall time [s] at which the harness ends the process of a trial whose engine hangs."""
_ATTEND_S = 0.1
"""Interval between checks of a process's memory while no message arrives [s]."""
_REPORT_S = 0.25
"""Least interval between progress messages [s], so that the messages do not disturb the timing."""
_MOST_OUTPUT = 2**24
"""Greatest size of a file that a trial's process writes [bytes], so that an engine cannot fill the disk."""
_TAIL = 2**16
"""Length of the end of the output in which the harness searches for an error message [bytes]."""
_MEBI = 2**20
_HUNG = (
    "the engine hung, and the harness stopped the trial; if a step only needs longer, raise 'trial_wall_s' in the "
    "study's [limits]"
)


class IsolatedTrial:
    """A trial that runs in its own process."""

    def __init__(
        self,
        trial: Trial,
        limits: Limits,
        environment: str,
        core: int | None,
        folder: Path,
        viewer: str | None = None,
    ) -> None:
        """Start the process.

        Args:
            trial: the trial to run.
            limits: limits of the trial.
            environment: digest of the environment, for the record.
            core: the processor core to run on; None lets the system choose.
            folder: folder for the temporary log file of the process.
            viewer: address of the viewer of Rerun that shows the trial; None without a viewer.
        """
        self.trial = trial
        self.core = core
        self._limits = limits
        self._environment = environment
        self._log = folder / f"{trial.id}.log"
        self._reader, writer = CONTEXT.Pipe(duplex=False)
        self._news: deque[Progress] = deque()
        self._pid: int | None = None
        self._excess_mib: float | None = None
        self._begun = monotonic()
        launch = in_process(_run_in_child, limits.trial_wall_s + GRACE_S)
        self.future: ProcessFuture[Outcome] = launch(trial, limits, environment, core, writer, self._log, viewer)
        writer.close()
        threading.Thread(target=self._attend, daemon=True).start()

    def news(self) -> Iterator[Progress]:
        """Yield the progress messages that have arrived since the last call."""
        while self._news:
            yield self._news.popleft()

    def _attend(self) -> None:
        """Receive the messages of the process, and limit its memory; the body of a thread."""
        with self._reader:
            while not self.future.done():
                try:
                    if self._reader.poll(_ATTEND_S):
                        message = self._reader.recv()
                        if isinstance(message, Progress):
                            self._news.append(message)
                        else:
                            self._pid = message
                except (EOFError, OSError):  # the process has ended
                    return
                self._limit_memory()

    def _limit_memory(self) -> None:
        """End the process if it uses more memory than the limit of the trial."""
        if self._pid is None:
            return
        try:
            taken = psutil.Process(self._pid).memory_info().rss / _MEBI
            if taken > self._limits.memory_mib:
                self._excess_mib = taken
                os.kill(self._pid, signal.SIGKILL)
        except (psutil.Error, ProcessLookupError):
            return

    def outcome(self) -> Outcome:
        """Wait for the end of the process; return the outcome of the trial."""
        try:
            return self.future.result()
        except ProcessExpired as error:
            if self._excess_mib is not None:
                return self._lost("out_of_memory", self._excess())
            if self._stopped_itself(error.exitcode):
                return self._lost("timeout", _HUNG)
            return self._lost("crashed", f"{_ending(error.exitcode)}: {_last_words(self._log)}")
        except TimeoutError:
            return self._lost("timeout", _HUNG)
        except MemoryError:
            return self._lost("out_of_memory", "the process ran out of memory; run fewer jobs at a time")
        except Exception as error:  # an error of the harness ends this trial, not the run
            return self._lost("error", f"harness: {type(error).__name__}: {error}")
        finally:
            self._log.unlink(missing_ok=True)

    def stop(self) -> None:
        """End the process without an outcome.

        This method kills the process, and does not cancel its future. A result that arrives during the cancellation
        would break the thread that waits for the result. The method cancels the future only if the process has not yet
        reported its process id, because no result can arrive earlier.
        """
        if self._pid is None:
            self.future.cancel()  # type: ignore[no-untyped-call]
            return
        with suppress(ProcessLookupError):
            os.kill(self._pid, signal.SIGKILL)

    def _lost(self, status: Status, message: str) -> Outcome:
        """Return the outcome of a trial whose process ended without an outcome."""
        return Outcome(bare_record(self.trial, self.trial.planned_scene(), self._environment, status, message), [])

    def _stopped_itself(self, exitcode: int | None) -> bool:
        """Return whether the alarm of ``_run_in_child`` ended the process, not an earlier alarm set by the engine.

        The alarm and the timeout of the library pebble both end an engine's step that does not return. For a limit of
        minutes, pebble's timeout comes some seconds late, because pebble counts polls of 0.1 s, and each poll takes
        slightly longer.
        """
        return exitcode == -signal.SIGALRM and monotonic() - self._begun > self._limits.trial_wall_s

    def _excess(self) -> str:
        return (
            f"stopped at {self._excess_mib:.0f} MiB, above its limit of {self._limits.memory_mib} MiB of memory; if "
            "the trial needs more, raise 'memory_mib' in the study's [limits]"
        )


def _run_in_child(
    trial: Trial,
    limits: Limits,
    environment: str,
    core: int | None,
    writer: Connection,
    log: Path,
    viewer: str | None,
) -> Outcome:
    threading.Thread(target=_end_with_parent, daemon=True).start()
    signal.alarm(math.ceil(limits.trial_wall_s + GRACE_S) + 1)  # a hung engine may block the thread above
    _send_output_to(log)
    if core is not None:
        os.sched_setaffinity(0, {core})
    writer.send(os.getpid())
    last = -_REPORT_S

    def report(progress: Progress) -> None:
        nonlocal last
        now = monotonic()
        if now - last >= _REPORT_S:
            last = now
            writer.send(progress)

    if viewer is None:
        return run_trial(trial, limits, environment, report)
    with live_view(trial.id, trial.policy, trial.planned_scene().world.fixed, viewer) as view:
        return run_trial(trial, limits, environment, report, on_frame=view.see)


def _end_with_parent() -> None:
    """End this process when its parent ends, so that trials of a killed harness do not disturb the next run."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


def _send_output_to(log: Path) -> None:
    """Redirect the output of this process to a file, so that the output stays off the terminal and survives a crash.

    The function also limits the size of files, and turns off core dumps.
    """
    with log.open("w", encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    resource.setrlimit(resource.RLIMIT_FSIZE, (_MOST_OUTPUT, _MOST_OUTPUT))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # crashing engines would leave gigabytes of core dumps
    faulthandler.enable(sys.stderr)


def _ending(exitcode: int | None) -> str:
    if exitcode == -signal.SIGKILL:
        return "the process died of SIGKILL (if no user sent it, the system ran out of memory; run fewer jobs)"
    if exitcode is not None and exitcode < 0:
        return f"the process died of {signal.Signals(-exitcode).name}"
    return f"the process ended with status {exitcode}"


def _last_words(log: Path) -> str:
    """Return the last line of the output that starts with "Fatal Python error"; else the last line that is not blank.

    The function reads the last ``_TAIL`` bytes of the output, and returns at most 300 characters.
    """
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - _TAIL))
            said = plain_text(file.read().decode(errors="replace"))
    except FileNotFoundError:
        return "no output"
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    fatal = [line for line in lines if line.startswith("Fatal Python error")]
    return (fatal or lines or ["no output"])[-1][:300]
