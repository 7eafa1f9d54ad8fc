"""A replay plays in a real browser, offline: bricks move, colours change, the view turns."""

import numpy as np
import pytest

from reports.records.recording import Recorder
from reports.replays.margins import margins_of
from reports.replays.replay import Replayed, write_replay
from scenarios.model import Brick, World
from tests.reports.studies import fallen, record

FRAMES = 120


TABLE = Brick((0.2, 0.1, 0.05), 1.0, (0.0, 0.2, 0.025))


def recording(falls: bool, fixed: tuple[Brick, ...] = ()):
    """Two bricks on each other; the upper one is frozen, or slides off and comes to lie beside."""
    recorder = Recorder(1 / 60, World(fixed=fixed))
    bricks = dict.fromkeys((0, 1), Brick((0.117, 0.0234, 0.0078), 0.0119, (0.0, 0.0, 0.0)))
    for frame in range(FRAMES):
        slid = 0.1 * frame / FRAMES if falls else 0.0
        position = np.array([[0, 0, 0.0039], [0, slid, 0.0117]])
        frozen = () if falls or frame < 30 else (0, 1)
        recorder.see(np.arange(2), position, np.tile([1.0, 0, 0, 0], (2, 1)), frozen, bricks)
    return recorder.finish()


@pytest.fixture
def page(tmp_path):
    trials = [Replayed(fallen(2), recording(True)), Replayed(record(policy="paper"), recording(False))]
    return write_replay(tmp_path / "replays", "two", trials)


def colours(opened, number: int) -> set[str]:
    """Hues in a panel, as a reader sees them."""
    return set(
        opened.evaluate(
            """async number => {
                const canvas = document.querySelectorAll("canvas")[number], copy = document.createElement("canvas");
                [copy.width, copy.height] = [canvas.width, canvas.height];
                const context = copy.getContext("2d");
                document.getElementById("time").dispatchEvent(new Event("input")); // drawn in this frame only
                await new Promise(requestAnimationFrame);
                context.drawImage(canvas, 0, 0);
                const { data } = context.getImageData(0, 0, copy.width, copy.height), found = new Set();
                for (let i = 0; i < data.length; i += 4) {
                    if (data[i + 3] < 250) continue;
                    const [r, g, b] = data.slice(i, i + 3);
                    if (b > r + 30) found.add("frozen");
                    else if (r > 1.2 * g && g > b + 20) found.add("live");
                    else if (r > 1.5 * g && b > .9 * g) found.add("fallen");
                    else if (Math.max(r, g, b) - Math.min(r, g, b) < 12) found.add("fixed");
                }
                return [...found];
            }""",
            number,
        )
    )


def seek(opened, seconds: float) -> None:
    opened.evaluate("to => { document.getElementById('time').value = to }", seconds)
    opened.evaluate("document.getElementById('time').dispatchEvent(new Event('input'))")
    opened.wait_for_function(f"Math.abs(document.body.dataset.time - {seconds}) < 0.01")


def test_it_plays_and_marks_live_frozen_and_fallen_apart(page, open_page) -> None:
    opened = open_page(page)
    opened.wait_for_function("document.body.dataset.time !== undefined")
    assert opened.locator(".panel b").all_inner_texts() == ["none", "paper"]
    assert colours(opened, 0) == {"live", "fallen"}
    assert colours(opened, 1) == {"frozen"}
    seek(opened, 0.1)
    assert colours(opened, 1) == {"live"}
    opened.click("#play")
    opened.wait_for_function(f"document.body.dataset.time >= {FRAMES / 60}")
    assert opened.locator("#play").inner_text() == "Play", "it stops at its end"


def test_fixed_boxes_are_grey(tmp_path, open_page) -> None:
    trials = [Replayed(record(policy=f"p{n}"), recording(False, fixed)) for n, fixed in enumerate(((), (TABLE,)))]
    opened = open_page(write_replay(tmp_path / "replays", "two", trials))
    opened.wait_for_function("document.body.dataset.time !== undefined")
    assert colours(opened, 0) == {"frozen"}
    assert colours(opened, 1) == {"frozen", "fixed"}


def test_it_is_small_and_its_script_lies_beside_it_once(page) -> None:
    assert page.stat().st_size < 50_000
    assert {path.name for path in page.parent.iterdir()} == {"two.html", "three.min.js"}


def test_bricks_are_coloured_by_their_margin_when_the_reader_wants_it(tmp_path, open_page) -> None:
    """The upper brick lies across the lower one at first, and in the air beside it at the end."""
    trials = [Replayed(fallen(2), recording(True))]
    margins = [margins_of(trials[0].recording, [0.1, FRAMES / 60])]
    assert margins[0].classes("load").tolist() == [[5, 5], [5, 0]]
    opened = open_page(write_replay(tmp_path / "replays", "one", trials, margins))
    opened.wait_for_function("document.body.dataset.time !== undefined")
    key = opened.locator("[data-key=load]")
    assert not key.is_visible()
    opened.select_option("#colour", "load")
    assert key.is_visible()
    assert key.inner_text().split() == ["load", "margin", "/", "weight", "none", "<1", "<3", "<10", "<30", "30+"]
    assert "frozen" in colours(opened, 0), "the blue of a brick that bears any load"
    assert "live" not in colours(opened, 0)
    opened.select_option("#colour", "state")
    assert colours(opened, 0) == {"live", "fallen"}
