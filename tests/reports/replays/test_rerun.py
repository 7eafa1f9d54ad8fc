"""Rerun's own reader finds every row of a recording, and a viewer receives the bricks of a running trial."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reports.records.recording import LENGTH_STEP
from reports.replays.errors import ExportError
from reports.replays.live_view import live_view
from reports.replays.replay import Replayed
from reports.replays.rerun_export import write_rerun
from scenarios.model import Brick
from tests.reports.replays.test_stills import PLANK, recording
from tests.reports.studies import fallen, record

TABLE = Brick((0.1, 0.1, 0.1), 1.0, (0.15, 0.0, 0.05))
UPRIGHT = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))


def values(path: Path) -> dict[str, dict[str, list]]:
    """The columns of each entity of a file, as Rerun reads them; empty values of removed bricks included."""
    chunk = pytest.importorskip("rerun.chunk", reason="needs uv sync --group rerun")
    found: dict[str, dict[str, list]] = {}
    for part in chunk.RrdReader(str(path)).stream():
        for name, column in part.to_record_batch().to_pydict().items():
            found.setdefault(part.entity_path, {}).setdefault(name, []).extend(column)
    return found


def test_a_file_holds_every_row_of_both_trials(tmp_path) -> None:
    pytest.importorskip("rerun", reason="needs uv sync --group rerun")
    trials = [
        Replayed(fallen(2), recording(apart=0.05)),
        Replayed(record(policy="paper"), replace(recording(frozen=(0,), gone=(1,)), fixed=(TABLE,))),
    ]
    write_rerun(tmp_path / "two.rrd", trials)
    found = values(tmp_path / "two.rrd")
    assert {"/none/bricks/0", "/none/bricks/1", "/paper/bricks/0", "/paper/bricks/1", "/paper/fixed"} <= set(found)
    upper = found["/none/bricks/1"]
    rows = trials[0].recording.body == 1
    assert np.allclose(
        np.array(upper["Boxes3D:centers"])[:, 0], trials[0].recording.position[rows] * LENGTH_STEP, atol=1e-7
    )
    assert np.allclose(np.array(upper["Boxes3D:half_sizes"])[0, 0], np.array(PLANK.size) / 2)
    assert upper["Boxes3D:colors"][0] != upper["Boxes3D:colors"][1], "live, then fallen"
    assert any("Clear" in name for name in found["/paper/bricks/1"]), "removed from the world"


def test_another_suffix_or_no_rerun_is_refused_with_the_fix(tmp_path, monkeypatch) -> None:
    trials = [Replayed(record(), recording())]
    with pytest.raises(ExportError, match=r"the suffix of a file of Rerun must be \.rrd: give --rrd FILE\.rrd"):
        write_rerun(tmp_path / "two.rr", trials)
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ExportError, match="uv sync --group rerun"):
        write_rerun(tmp_path / "two.rrd", trials)
    assert not list(tmp_path.iterdir())


@pytest.mark.filterwarnings("ignore:RRD file has no footer")  # the viewer writes the file while it receives
def test_a_viewer_receives_the_bricks_that_change(tmp_path) -> None:
    pytest.importorskip("rerun", reason="needs uv sync --group rerun")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    out = tmp_path / "live.rrd"
    viewer = subprocess.Popen(
        [sys.executable, "-m", "rerun", "--save", str(out), "--port", str(port)],
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # the viewer is a child of this process, and gets its signals through the group
        preexec_fn=_heed_interrupts,
    )
    try:
        _await_port(port)
        with live_view("trial", "paper", (TABLE,), f"rerun+http://127.0.0.1:{port}/proxy") as view:
            bricks = {0: PLANK, 1: PLANK}
            first = np.array([[0, 0, 0.0039], [0, 0, 0.0117]])
            view.see(1 / 60, np.array([0, 1]), first, UPRIGHT, (), bricks)
            view.see(2 / 60, np.array([0, 1]), first, UPRIGHT, (0,), bricks)
            view.see(3 / 60, np.array([0]), first[:1], UPRIGHT[:1], (0,), bricks)
        time.sleep(1.0)
    finally:
        _end(viewer)
    found = values(out)
    assert len(found["/paper/bricks/0"]["Boxes3D:centers"]) == 2, "live, then frozen, then unchanged"
    assert any("Clear" in name for name in found["/paper/bricks/1"])
    assert "/paper/fixed" in found


def _await_port(port: int) -> None:
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        with socket.socket() as attempt:
            if attempt.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    pytest.fail("the viewer did not open its port")


def _heed_interrupts() -> None:
    """Undo an ignored SIGINT, which processes inherit from a shell that runs them in the background."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _end(viewer: subprocess.Popen[bytes]) -> None:
    """Let the viewer write its file and exit; then end what is left of its process group."""
    os.killpg(viewer.pid, signal.SIGINT)
    try:
        viewer.wait(60)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(viewer.pid, signal.SIGKILL)
        viewer.wait()
