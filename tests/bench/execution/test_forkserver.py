"""Every thread that asks reads how a trial's process ended."""

import os
import threading
import time
from multiprocessing import forkserver

from bench.execution.forkserver import CONTEXT, in_process, start_server


def test_two_threads_that_ask_at_once_hear_the_same_status(monkeypatch) -> None:
    """The first one is held up between reading the status and noting it: the second must wait for it."""
    read = forkserver.read_signed

    def read_slowly(pipe: int) -> int:
        status = read(pipe)
        time.sleep(0.2)
        return status

    process = CONTEXT.Process(target=os._exit, args=(3,))
    process.start()
    monkeypatch.setattr(forkserver, "read_signed", read_slowly)
    output: list[int | None] = []
    threads = [threading.Thread(target=lambda: output.append(process._popen.poll(0))) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert output == [3, 3]


def test_a_trial_is_no_fork_of_this_process() -> None:
    """Forks would share the engines that this process has imported."""
    start_server([], [])
    assert in_process(os.getppid, 600)().result() != os.getpid()
