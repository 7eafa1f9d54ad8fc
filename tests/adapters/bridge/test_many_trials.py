"""A study of 1,000 trials over the bridge loses none, leaves no process behind when it is killed, and keeps its memory.

Half an hour on two cores: ``uv run --group wasm pytest -m slow tests/adapters/bridge/test_many_trials.py``.
"""

import os
import signal
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import psutil
import pytest

from adapters import EngineNotInstalledError, check_installed
from reports.records.trial import TrialRecord, read_records

ROOT = Path(__file__).parents[3]
ENGINES = ("jolt", "havok")
TRIALS = 1000
GROUPS = 8
"""Two engines, two scenes, without and with the extension; the trials of a group are repeats."""
STUDY = f"""
name = "bridge"
description = "Small stacks on engines in processes of their own, many times."
engines = {list(ENGINES)}
policies = ["none", "paper"]
repeats = {TRIALS // GROUPS}
watch_s = 0.25
[limits]
ratio = false
[[scenario]]
name = "plank_tower"
parameters = {{ levels = 2 }}
[[scenario]]
name = "four_stack"
parameters = {{ levels = 2 }}
"""
KILL_AT = TRIALS // 3
"""Count of records at which the harness is killed."""
END_S = 10.0
"""Time [s] in which all processes of a killed harness must end."""
MOST_GROWTH = 16 * 2**20
"""Greatest growth of the resident memory [bytes] of the harness's processes from the first quarter of the second run to
its end, over some 500 trials. The harness keeps the records, 3 KiB each; a leak of a world or a pipe would be more than
100 KiB a trial."""
DEADLINE_S = 3 * 3600.0
"""Time limit [s] of each run."""


def start(folder: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "bench", "run", str(folder / "bridge.toml"), "--jobs", "2"]
    with (folder / "log").open("ab") as log:
        return subprocess.Popen([*command, "--out", str(folder / "out")], cwd=ROOT, stdout=log, stderr=log)


def records_in(folder: Path) -> int:
    path = folder / "out" / "trials.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


def await_records(folder: Path, count: int, harness: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while records_in(folder) < count and harness.poll() is None:
        assert time.monotonic() < deadline
        time.sleep(0.05)


def is_peer(process: psutil.Process) -> bool:
    try:
        return any(word.endswith("peer.mjs") for word in process.cmdline())
    except psutil.Error:
        return False


def await_peers(harness: psutil.Process) -> list[psutil.Process]:
    """Return all descendants of the harness at a moment at which an engine's process is among them."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        descendants = harness.children(recursive=True)
        if any(map(is_peer, descendants)):
            return descendants
    raise AssertionError("no engine's process was seen for a minute")


def resident(harness: psutil.Process) -> int:
    """Return the resident memory [bytes] of the harness and its lasting processes, without those of trials."""
    total = harness.memory_info().rss
    for process in harness.children():
        try:
            total += process.memory_info().rss
        except psutil.Error:
            continue
    return total


def check_kill(folder: Path) -> list[TrialRecord]:
    """Kill the harness while engines run; return the records so far."""
    harness = start(folder)
    await_records(folder, KILL_AT, harness)
    processes = await_peers(psutil.Process(harness.pid))
    os.kill(harness.pid, signal.SIGKILL)
    harness.wait()
    _, alive = psutil.wait_procs(processes, END_S)
    assert alive == []
    return read_records(folder / "out" / "trials.jsonl")


def check_resumption(folder: Path, before: list[TrialRecord]) -> None:
    """Run the rest of the study, and compare the memory at the first quarter with the memory at the end."""
    harness = start(folder)
    process, rest = psutil.Process(harness.pid), TRIALS - len(before)
    memory = []
    for share in (1 / 4, 1 / 2, 3 / 4, 0.97):
        await_records(folder, len(before) + round(share * rest), harness)
        memory.append(resident(process))
    assert harness.wait(DEADLINE_S) == 0, (folder / "log").read_text()[-2000:]
    print("resident memory [MiB]:", [round(size / 2**20, 1) for size in memory])  # noqa: T201 - a figure of the docs
    assert max(memory) - memory[0] < MOST_GROWTH


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::reports.records.trial.RecordWarning")  # the kill may tear a line
def test_a_thousand_trials_over_the_bridge(tmp_path: Path) -> None:
    for engine in ENGINES:
        try:
            check_installed(engine)
        except EngineNotInstalledError as error:
            pytest.skip(str(error))
    (tmp_path / "bridge.toml").write_text(STUDY)
    before = check_kill(tmp_path)
    check_resumption(tmp_path, before)
    records = read_records(tmp_path / "out" / "trials.jsonl")
    assert records[: len(before)] == before
    assert len(records) == len({record.trial for record in records}) == TRIALS
    assert {(record.status, record.message) for record in records} == {("completed", "")}
    hashes = defaultdict(set)
    for record in records:
        hashes[record.engine, record.scene, record.policy].add(record.pose_hash)
    assert len(hashes) == GROUPS
    assert all(len(found) == 1 for found in hashes.values())  # both engines repeat themselves across processes
