"""Whatever a peer does, the trial that meets it ends with a status and a message that says what happened."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from adapters import ENGINES, PeerError, open_engine
from adapters.bridge.external import ExternalEntry
from adapters.bridge.simulation import BridgeSimulation
from adapters.conformance.rig import plank
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial

PEER = Path(__file__).with_name("rogue_peer.py")
ENDINGS = {
    "none": ("completed", ""),
    "exit": ("crashed", "the engine's process ended with status 3: out of contacts"),
    "silence": ("timeout", "the engine must answer within 2 s, but did not"),
    "garbage": ("error", "which announces 1852989783 bytes"),
    "huge": ("error", "must have at most 67108864 bytes"),
    "error": ("error", "the engine reports an error: the solver gave up"),
    "kind": ("error", "the engine's answer must have the kind 3, or 4 for an error, got 7"),
    "closed": ("error", "but closed stdin or stdout earlier"),
    "chatter": ("error", "the engine must write only its answer to stdout, but wrote other output after the answer"),
    "nan": ("diverged", "poses were not finite"),
    "clock": ("error", "got 1e+06 s: report the duration in seconds"),
    "count": ("error", "the counts in the answer to a step must be whole numbers"),
    "bodies": ("error", "ids [0] (count 1), with 1 as the count of states of each body; got ids [77] (count 1)"),
    "short": ("error", "must have 33 numbers, got 19"),
    "other_protocol": ("error", "hello: 'protocol' must be 1, got 2"),
    "no_json": ("error", "which is not JSON"),
}


@pytest.fixture
def entry(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ExternalEntry:
    command = (sys.executable, "-IS", str(PEER), request.param)
    timeout_s = 2.0 if request.param == "silence" else 60.0  # long enough for a program to start on a busy machine
    entry = ExternalEntry("rogue_peer", command, Path.cwd(), timeout_s=timeout_s)
    monkeypatch.setitem(ENGINES, "rogue_peer", entry)
    return entry


@pytest.mark.parametrize(
    "entry", [name for name in ENDINGS if name not in ("other_protocol", "no_json")], indirect=True
)
def test_a_trial_ends_with_a_status_that_says_what_happened(entry: ExternalEntry) -> None:
    status, message = ENDINGS[entry.command[-1]]
    trial = Trial("rogue_peer", "default", "plank_tower", "plank_tower-1", {"levels": 1}, "none", 0, 0)
    record = run_trial(trial, Limits(trial_wall_s=60), "abc", lambda _: None).record
    assert (record.status, message in record.message) == (status, True), record.message


@pytest.mark.parametrize("entry", ["other_protocol", "no_json"], indirect=True)
def test_an_engine_that_says_no_valid_hello_is_not_opened(entry: ExternalEntry) -> None:
    _, message = ENDINGS[entry.command[-1]]
    with pytest.raises(ImportError, match=message):
        open_engine("rogue_peer")


@pytest.mark.parametrize("entry", ["none"], indirect=True)
def test_a_process_that_is_killed_is_distinguished_from_one_that_ends(entry: ExternalEntry) -> None:
    simulation = open_engine("rogue_peer")
    assert isinstance(simulation, BridgeSimulation)
    simulation.spawn(plank())
    simulation.step(simulation.info.frame_s)
    simulation._peer._process.kill()
    with pytest.raises(PeerError, match="the engine's process ended by signal 9: it printed nothing"):
        simulation.step(simulation.info.frame_s)
    simulation.close()


HOLD = """
import sys, time
from pathlib import Path
from adapters.bridge.messages import HEADER, Kind, json_body, step_body
from adapters.bridge.peer import Peer
step = step_body(1.0, 1, False, [])
peers = [Peer([sys.executable, "-IS", sys.argv[1], misdeed], Path.cwd()) for misdeed in ("none", "busy")]
for peer in peers:
    peer.ask(Kind.HELLO, json_body({"protocol": 1}))
    peer.ask(Kind.OPEN, b"{}")
    peer._send(3 * (HEADER.pack(len(step), Kind.STEP) + step), time.monotonic() + 9)
    print(peer._process.pid, flush=True)
time.sleep(60)
"""


def test_no_process_stays_when_the_harness_is_killed() -> None:
    """The stdin of the first ends; the second computes without end, never reads on, and is killed by the kernel."""
    command = [sys.executable, "-c", HOLD, str(PEER)]
    harness = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3])
    assert harness.stdout is not None
    peers = [psutil.Process(int(harness.stdout.readline())) for _ in range(2)]
    time.sleep(0.3)
    assert all(peer.is_running() for peer in peers)
    os.kill(harness.pid, signal.SIGKILL)
    harness.wait()
    harness.stdout.close()
    for peer in peers:
        peer.wait(5)


@pytest.mark.parametrize("entry", ["nan"], indirect=True)
def test_a_state_that_is_not_finite_ends_a_trial_with_the_extension_too(entry: ExternalEntry) -> None:
    trial = Trial("rogue_peer", "default", "plank_tower", "plank_tower-1", {"levels": 1}, "at_rest", 0, 0)
    record = run_trial(trial, Limits(trial_wall_s=600), "abc", lambda _: None).record
    assert record.status == "diverged", record.message
