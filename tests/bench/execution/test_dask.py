"""The same study by local processes and on a Dask cluster of which a worker is lost: the same outcomes, bit for bit."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bench.execution import dask
from bench.execution.dask import Order, connected
from bench.execution.errors import ClusterError
from bench.machine.environment import describe
from bench.studies.plan import plan_trials
from bench.studies.schema import Limits, check_study
from reports.records.frames import read_frames
from reports.records.trial import read_records

ROOT = Path(__file__).parents[3]
STUDY = """
name = 'spread'
engines = ['bullet', 'pymunk']
policies = ['none', 'at_rest']
seeds = 2
[limits]
ratio = false
[[scenario]]
name = 'card_house'
"""
TRIALS = 8
BENCH = "from bench.cli import app, run; run.make_report = run.show = lambda _: None; app.app()"
"""The command line without the report of a run, which takes longer than its trials: ``test_cli`` asks for one."""


class Cluster:
    """A scheduler and workers on this machine, started with Dask's own commands."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._processes: list[subprocess.Popen[bytes]] = []
        contact = folder / "scheduler.json"
        self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(contact))
        self._contact = ["--scheduler-file", str(contact), "--nthreads", "1", "--local-directory", str(folder)]
        deadline = time.monotonic() + 300
        while "Scheduler at:" not in (output := (folder / "0.log").read_text()):
            assert time.monotonic() < deadline, output
            time.sleep(0.1)
        self.address = next(word for word in output.split() if word.startswith("tcp://"))

    def add_worker(self, *options: str) -> subprocess.Popen[bytes]:
        return self._start("worker", *self._contact, *options)

    def _start(self, *command: str) -> subprocess.Popen[bytes]:
        with (self._folder / f"{len(self._processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *command, "--no-dashboard"], cwd=ROOT, stdout=log, stderr=log
            )
        self._processes.append(process)
        return process

    def end(self) -> None:
        for process in reversed(self._processes):
            process.terminate()
        for process in self._processes:
            process.wait(30)


@pytest.fixture
def dask_cluster(tmp_path):
    one = Cluster(tmp_path)
    yield one
    one.end()


def run(folder: Path, out: str, *options: str) -> subprocess.Popen[str]:
    (folder / "spread.toml").write_text(STUDY)
    return subprocess.Popen(
        [sys.executable, "-c", BENCH, "run", "spread.toml", "--out", out, *options],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def test_a_cluster_that_loses_a_worker_leaves_what_this_machine_does(dask_cluster, tmp_path, untimed) -> None:
    dask_cluster.add_worker()
    doomed = dask_cluster.add_worker("--no-nanny")
    kept = tmp_path / "spread" / "trials.jsonl"
    with run(tmp_path, "spread", "--dask", dask_cluster.address) as spread:
        deadline = time.monotonic() + 600
        while not kept.exists() or kept.read_bytes().count(b"\n") < TRIALS // 4:
            assert time.monotonic() < deadline
            assert spread.poll() is None, spread.stdout.read()
            time.sleep(0.05)
        doomed.send_signal(signal.SIGKILL)
        output = spread.communicate(timeout=600)[0]
    assert spread.returncode == 0, output
    with run(tmp_path, "here", "--jobs", "2") as here:
        output = here.communicate(timeout=600)[0]
    assert here.returncode == 0, output
    from_cluster = read_records(kept)
    assert len(from_cluster) == TRIALS
    assert {record.status for record in from_cluster} <= {"completed", "collapsed"}
    assert untimed(from_cluster) == untimed(read_records(tmp_path / "here" / "trials.jsonl"))
    for record in from_cluster:
        assert read_frames(tmp_path / "spread" / "frames" / f"{record.trial}.parquet")


def test_a_worker_of_another_checkout_is_refused() -> None:
    study = check_study(
        {"name": "a", "engines": ["bullet"], "policies": ["none"], "scenario": [{"name": "card_house"}]}, ""
    )
    decisive = {name: describe(["bullet"])[name] for name in dask._DECISIVE} | {"sources": "other"}
    order = Order("run", ("bullet",), (), Limits(), decisive)
    with pytest.raises(
        ClusterError, match=r"of the client, but differs in: sources; run 'uv sync' there and start the worker again"
    ):
        dask._run_trial(plan_trials(study)[0], order)


def test_no_scheduler_is_reported_with_the_commands_that_start_one(monkeypatch) -> None:
    monkeypatch.setattr(dask, "CONNECT_S", 0.2)
    with (
        pytest.raises(
            ClusterError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9: correct the address, or start"
        ),
        connected("tcp://127.0.0.1:9"),
    ):
        pytest.fail("nobody listens there")
