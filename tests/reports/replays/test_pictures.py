"""Pictures and videos: what FFmpeg reads from them, what a viewer sees, and what is refused with its fix."""

from __future__ import annotations

import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from reports.replays.camera import CAMERAS, parse_camera
from reports.replays.drawing import visible_space
from reports.replays.encoding import encoded
from reports.replays.errors import ExportError
from reports.replays.pictures import Film, parse_size, write_still, write_video
from reports.replays.replay import Replayed
from reports.replays.timeline import Timeline
from scenarios.lookup import UnknownNameError
from tests.reports.replays.test_stills import recording
from tests.reports.studies import fallen, record

ORANGE, BLUE, RED = (224, 160, 48), (91, 159, 201), (168, 66, 90)


@pytest.fixture
def pair() -> list[Replayed]:
    """The same two planks without and with the extension: the upper one falls, or is frozen."""
    return [
        Replayed(fallen(2), replace(recording(apart=0.05), frames=60)),
        Replayed(record(policy="paper", wakes=0), replace(recording(frozen=(0, 1)), frames=60)),
    ]


def share(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """The share of pixels of a hue."""
    pixels = picture.reshape(-1, 3).astype(float)
    likeness = pixels @ (np.array(colour) / np.linalg.norm(colour)) / (np.linalg.norm(pixels, axis=1) + 1e-9)
    return float((likeness > 0.99).mean())


def drawn(work) -> None:
    """Do the work, or skip the test where nothing can be drawn."""
    try:
        work()
    except ExportError as error:
        if "no renderer" not in str(error):
            raise
        pytest.skip(str(error))


def test_a_video_has_its_size_and_duration_and_shows_both_stacks_side_by_side(pair, tmp_path) -> None:
    av = pytest.importorskip("av", reason="needs uv sync --group video")
    path = tmp_path / "pair.mp4"
    drawn(lambda: write_video(path, pair, Film((320, 180), fps=5)))
    with av.open(path) as container:
        stream = container.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert (stream.width, stream.height, stream.average_rate) == (320, 180, 5)
        assert len(frames) == 5, "one second at 5 frames a second"
        assert float(container.duration) / av.time_base == pytest.approx(1.0, abs=0.01)
    without, with_extension = frames[-1][30:160, :160], frames[-1][30:160, 160:]
    assert share(without, RED) > 0.005
    assert share(without, BLUE) < 0.001
    assert share(with_extension, BLUE) > 0.005
    assert share(with_extension, RED) < 0.001


def test_a_gif_has_its_size_its_pace_and_the_colours_of_its_bricks(tmp_path) -> None:
    av = pytest.importorskip("av", reason="needs uv sync --group video")
    pictures = [Image.new("RGB", (64, 48), colour) for colour in (ORANGE, BLUE, RED)]
    path = tmp_path / "three.gif"
    path.write_bytes(encoded(path, iter(pictures), (64, 48), 20, (ORANGE, BLUE, RED)))
    with av.open(path) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
        assert container.streams.video[0].average_rate == 20
    assert [frame.shape for frame in frames] == [(48, 64, 3)] * 3
    means = np.array([frame.reshape(-1, 3).mean(axis=0) for frame in frames])
    assert np.abs(means - [ORANGE, BLUE, RED]).max() < 8, "twenty shades lie 5 % apart"


def test_a_still_shows_the_chosen_time_from_the_chosen_side(pair, tmp_path) -> None:
    path = tmp_path / "still.png"
    drawn(lambda: write_still(path, pair[1:], (200, 150), at=0.0, camera=CAMERAS["top"]))
    picture = np.asarray(Image.open(path))
    assert picture.shape == (150, 200, 3)
    assert share(picture[30:130], ORANGE) > 0.01, "live at the start, frozen at the end"
    orange = np.argwhere(picture[30:130, :, 0] > picture[30:130, :, 2].astype(int) + 80)
    height, width = np.ptp(orange, axis=0)
    assert height / width == pytest.approx(0.0234 / 0.117, rel=0.15), "seen from above: a plank's width over its length"


def test_the_picture_has_room_for_bricks_that_fell_but_not_for_one_that_rolled_away() -> None:
    low, high = visible_space([recording(apart=0.05)], 0.5)
    assert (low[1], high[1]) == pytest.approx((-0.0117, 0.05 + 0.0117))
    low, high = visible_space([recording(apart=5.0)], 0.5)
    assert (low[1], high[1]) == pytest.approx((-0.0117, 0.0117 + 0.117 / 2))


def test_poses_are_interpolated_between_frames_and_held_between_rows() -> None:
    timeline = Timeline(replace(recording(apart=0.06), frames=10))
    half = timeline.at(0.5 / 60)
    assert half.position[1] == pytest.approx([0.0, 0.03, 0.0117])
    assert timeline.at(99.0).position[1] == pytest.approx([0.0, 0.06, 0.0117])
    assert timeline.at(99.0).states == ["live", "fallen"]
    assert not Timeline(replace(recording(gone=(1,)), frames=10)).at(1.0).present[1]


def test_cameras_have_names_and_numbers() -> None:
    camera = parse_camera("front,elevation=20,distance=0.5")
    assert (camera.azimuth, camera.elevation, camera.distance) == (-90.0, 20.0, 0.5)
    assert parse_camera("azimuth=30").elevation == CAMERAS["corner"].elevation


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("frnt", "unknown camera 'frnt'; did you mean 'front'?"),
        ("azimut=3", "unknown part of a camera 'azimut'; did you mean 'azimuth'?"),
        ("azimuth=east", "azimuth of the camera must be a number, got 'east': write azimuth=NUMBER in --camera"),
        ("elevation=91", "elevation of the camera must be from -90 to 90 degrees, got 91"),
        ("distance=0", "distance of the camera must be above 0 m, got 0 m: give distance=0.5"),
        ("azimuth=nan", "azimuth of the camera must be a finite number, got nan"),
        ("front,top", "each part of --camera 'front,top' after the first must be azimuth=NUMBER"),
    ],
)
def test_a_camera_that_cannot_be_is_refused_with_the_fix(text, complaint) -> None:
    with pytest.raises((ExportError, UnknownNameError), match=re.escape(complaint)):
        parse_camera(text)


def test_what_cannot_be_drawn_is_refused_with_the_fix(pair, tmp_path, monkeypatch) -> None:
    def complaint(work) -> str:
        with pytest.raises(ExportError) as caught:
            work()
        return str(caught.value)

    def still(trials, **options) -> None:
        write_still(tmp_path / "a.png", trials, (300, 200), **options)

    def video(name: str, width: int, **options) -> None:
        write_video(tmp_path / name, pair, Film((width, 180), **options))

    assert "must have the form WIDTHxHEIGHT" in complaint(lambda: parse_size("1920", "--still"))
    assert "give --size 8192x10" in complaint(lambda: parse_size("9000x10", "--size"))
    assert "--at must be from 0 to 1 s" in complaint(lambda: write_still(tmp_path / "a.png", pair, (300, 200), at=2))
    assert "the size of a picture with 6 panels must be at least" in complaint(lambda: still([*pair, *pair, *pair]))
    assert "must be .mp4 or .gif: give --video FILE.mp4" in complaint(lambda: video("a.avi", 320))
    assert "--speed must be a finite number above 0, got 0" in complaint(lambda: video("a.gif", 320, speed=0.0))
    pytest.importorskip("av", reason="needs uv sync --group video")
    assert "an even width and height, got 321x180 pixels: give --size 322x180" in complaint(lambda: video("a.mp4", 321))
    assert "--fps 10, 20, 25 or 50" in complaint(lambda: video("a.gif", 320, fps=30))
    monkeypatch.setitem(sys.modules, "av", None)
    assert "uv sync --group video" in complaint(lambda: video("a.mp4", 320))
    assert not list(tmp_path.iterdir())


def test_a_failed_renderer_is_reported_in_the_midst_of_a_video(pair, tmp_path, monkeypatch) -> None:
    pytest.importorskip("av", reason="needs uv sync --group video")
    python = tmp_path / "python"
    python.write_text("#!/bin/sh\nkill -SEGV $$\n")
    python.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(python))
    with pytest.raises(ExportError, match="mostly because the machine has no renderer: run 'apt-get install libegl1'"):
        write_video(tmp_path / "a.mp4", pair, Film((320, 180)))
