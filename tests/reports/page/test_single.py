"""The page as one file: it opens without its folder, and plays its replays."""

import shutil

import pytest
from PIL import Image

from reports.page.single import SINGLE, write_single
from reports.page.study_page import write_page
from reports.records.folder import still_of
from reports.replays.replay import Replayed
from reports.replays.stacks import write_stack_replay
from tests.reports.replays.test_replay import recording
from tests.reports.studies import record, write_study


@pytest.fixture
def page(tmp_path):
    """The page of one trial with a still and a replay."""
    trial = record()
    folder = write_study(tmp_path / "study", [trial])
    write_stack_replay(folder, [Replayed(trial, recording(falls=False))])
    still = still_of(folder / "report" / "stills", trial)
    still.parent.mkdir(parents=True)
    Image.new("RGB", (1600, 1200), "tan").save(still)
    return write_page(folder, [trial])


def test_one_file_opens_anywhere_with_its_stills_and_replays(page, tmp_path, open_page) -> None:
    alone = tmp_path / "alone" / "mail.html"
    alone.parent.mkdir()
    shutil.copy(write_single(page), alone)
    assert alone.stat().st_size < 2e6
    opened = open_page(alone)
    still = opened.locator("#ends img")
    assert still.get_attribute("src").startswith("data:image/webp;base64,")
    still.scroll_into_view_if_needed()
    opened.wait_for_function("document.querySelector('#ends img').naturalWidth === 320")
    opened.locator("#ends figcaption a").click()
    opened.locator("#player").wait_for()
    replay = opened.frame_locator("#player iframe")
    replay.locator("canvas").first.wait_for()
    opened.get_by_role("button", name="Close").click()
    assert not opened.locator("#player").is_visible()


def test_a_page_without_pictures_is_only_copied(tmp_path) -> None:
    folder = write_study(tmp_path / "study", [record()])
    page = write_page(folder, [record()])
    assert write_single(page).name == SINGLE
    assert (page.parent / SINGLE).read_bytes() == page.read_bytes()
