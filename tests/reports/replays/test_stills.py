"""Stills show where the bricks ended, and in which state; a machine that cannot draw says what to install."""

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from reports.page.gallery import shelves
from reports.records.folder import still_of
from reports.records.recording import Recorder, Recording, write_recording
from reports.records.trial import TrialRecord
from reports.replays.drawing import COLOURS
from reports.replays.gallery_figure import gallery_figure
from reports.replays.replay import Replayed
from reports.replays.stacks import MOST_STILLS, draw_stills
from reports.replays.stills import StillsError, write_stills
from reports.statistics.groups import groups_of
from scenarios.model import Brick
from tests.reports.studies import fallen, record, write_study

PLANK = Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.0, 0.0))


def recording(*, apart: float = 0.0, frozen: tuple[int, ...] = (), gone: tuple[int, ...] = ()) -> Recording:
    """Two planks on each other, of which the upper one ends so far [m] beside the other."""
    recorder = Recorder(1 / 60)
    for frame in range(2):
        bodies = np.array([body for body in (0, 1) if frame == 0 or body not in gone], int)
        position = np.array([[0, 0, 0.0039], [0, apart * frame, 0.0117]])[bodies]
        held = frozen if frame else ()
        recorder.see(bodies, position, np.tile([1.0, 0, 0, 0], (len(bodies), 1)), held, dict.fromkeys((0, 1), PLANK))
    return recorder.finish()


def draw(folder: Path, *recordings: Recording) -> list[set[str]]:
    """The states that are seen in the stills of one stack under several policies."""
    stack = [Replayed(record(policy=f"p{number}"), one) for number, one in enumerate(recordings)]
    try:
        write_stills(folder, [stack], pixels=120)
    except StillsError as error:
        if "no renderer" not in str(error):
            raise
        pytest.skip(str(error))
    return [seen(still_of(folder, one.record)) for one in stack]


def seen(path: Path) -> set[str]:
    """The states of which a still has at least fifty pixels of the hue."""
    pixels = np.asarray(Image.open(path)).reshape(-1, 4)
    shown = pixels[pixels[:, 3] == 255][:, :3].astype(float)
    hues = np.array([np.array(colour) / np.linalg.norm(colour) for colour in COLOURS.values()])
    likeness = shown @ hues.T / (np.linalg.norm(shown, axis=1)[:, None] + 1e-9)
    count = np.bincount(likeness.argmax(axis=1)[likeness.max(axis=1) > 0.99], minlength=len(COLOURS))
    return {state for state, pixels in zip(COLOURS, count.tolist(), strict=True) if pixels >= 50}


def test_live_frozen_and_fallen_bricks_are_distinguished_and_what_is_gone_is_not_shown(tmp_path) -> None:
    both_live = recording()
    one_frozen_one_fallen = recording(apart=0.05, frozen=(0,))
    one_left = recording(frozen=(0,), gone=(1,))
    all_gone = recording(gone=(0, 1))
    found = draw(tmp_path, both_live, one_frozen_one_fallen, one_left, all_gone)
    assert found == [{"live"}, {"frozen", "fallen"}, {"frozen"}, set()]


def test_policies_are_seen_from_the_same_place(tmp_path) -> None:
    draw(tmp_path, recording(), recording(gone=(1,)))
    boxes = [Image.open(path).getbbox() for path in sorted(tmp_path.glob("*.png"))]
    assert all(boxes)
    [(left, _, _, bottom), (other_left, _, _, other_bottom)] = [box for box in boxes if box]
    assert abs(left - other_left) <= 1
    assert abs(bottom - other_bottom) <= 8, "the shadow of one plank is shorter than that of two"


@pytest.mark.parametrize(
    ("last_words", "output"),
    [
        (
            "kill -SEGV $$",
            "no stills: the renderer ended by signal 11, mostly because the machine has no renderer: run 'apt-get "
            "install libegl1', or 'apt-get install libosmesa6'",
        ),
        (
            "echo \"No module named 'pyvista'\" >&2; exit 1",
            "no stills: the renderer ended with status 1 (No module named 'pyvista'): install the package with 'uv "
            "sync'",
        ),
        (
            "echo 'OSError: no space' >&2; exit 1",
            "no stills: the renderer ended with status 1 (OSError: no space): remove the cause, or run 'apt-get "
            "install libegl1' on a machine without a renderer",
        ),
    ],
)
def test_why_nothing_could_be_drawn_is_reported(last_words: str, output: str, tmp_path, monkeypatch) -> None:
    python = tmp_path / "python"
    python.write_text(f"#!/bin/sh\n{last_words}\n")
    python.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(python))
    with pytest.raises(StillsError, match=f"^{re.escape(output)}$"):
        write_stills(tmp_path, [[Replayed(record(), recording())]])


def study(folder: Path, count: int) -> tuple[Path, list[TrialRecord]]:
    records = [record(scene=f"scene-{number}", timed_frames=None) for number in range(count)]
    return write_study(folder, records), records


def test_too_many_stills_are_drawn_only_when_asked_for(tmp_path) -> None:
    folder, records = study(tmp_path / "many", MOST_STILLS + 1)
    output = draw_stills(folder, [[one] for one in records], however_many=False)
    assert output.startswith(f"{MOST_STILLS + 1} stills were not drawn, because they take minutes")
    assert output.endswith(f"bench report {folder} --stills")
    assert not (folder / "report").exists()


def test_stills_that_are_there_are_not_drawn_again(tmp_path, monkeypatch) -> None:
    folder, records = study(tmp_path / "few", 2)
    (folder / "recordings").mkdir()
    for one in records:
        write_recording(folder / "recordings" / f"{one.trial}.parquet", recording())
    stills = folder / "report" / "stills"
    stills.mkdir(parents=True)
    for one in records:
        still_of(stills, one).write_bytes(b"a picture")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: pytest.fail("it was drawn again"))
    assert draw_stills(folder, [[one] for one in records], however_many=False) == ""
    os.utime(folder / "trials.jsonl", (2e9, 2e9))  # the records are newer
    with pytest.raises(pytest.fail.Exception):
        draw_stills(folder, [[one] for one in records], however_many=False)


def test_a_page_shows_each_end_beside_the_others_and_leads_to_the_replay(tmp_path) -> None:
    records = [fallen(9), record(policy="paper"), record(engine="mujoco")]
    stills, replays = tmp_path / "stills", tmp_path / "replays"
    stills.mkdir()
    replays.mkdir()
    Image.new("RGBA", (4, 4)).save(still_of(stills, records[1]))
    (replays / "four_stack.bullet.game.s0.html").touch()
    cells = groups_of(records)
    [shelf] = shelves(tmp_path, cells)["four_stack"]
    assert (shelf.engine, shelf.replay) == ("bullet", "replays/four_stack.bullet.game.s0.html")
    assert [(one.policy, one.href, one.outcome) for one in shelf.pictures] == [
        ("none", None, "falls at 9 ✗"),
        ("paper", f"stills/{records[1].trial}.png", "30/30 ✓"),
    ]
    with pytest.raises(FileNotFoundError):
        gallery_figure(stills, cells, "bullet", "game", ["four_stack"])
    Image.new("RGBA", (4, 4)).save(still_of(stills, records[0]))
    titles = [panel.get_title() for panel in gallery_figure(stills, cells, "bullet", "game", ["four_stack"]).axes]
    assert titles == ["none: falls at 9 ✗", "paper: 30/30 ✓"]


def test_fixed_boxes_are_drawn_grey(tmp_path) -> None:
    table = Brick((0.1, 0.1, 0.1), 1.0, (0.15, 0.0, 0.05))
    shares = []
    for name, fixed in (("without", ()), ("with", (table,))):
        draw(tmp_path / name, replace(recording(), fixed=fixed))
        pixels = np.asarray(Image.open(still_of(tmp_path / name, record(policy="p0")))).reshape(-1, 4)
        shown = pixels[pixels[:, 3] == 255][:, :3].astype(int)
        shares.append(float((np.ptp(shown, axis=1) < 20).mean()))
    assert shares[0] < 0.3
    assert shares[1] > 0.6
