"""The sheet of all scenes: what is in front covers what is behind."""

import numpy as np

from bench.cli.contact_sheet import draw_contact_sheet, faces, from_back_to_front
from scenarios.geometry import Boxes
from scenarios.planks import THICKNESS, lay
from scenarios.registry import build


def test_what_lies_on_top_and_what_stands_in_front_is_painted_later():
    lower, upper = lay(0.0, level=1), lay(0.0, level=2)
    near = lay(0.0, -0.03, level=1)
    boxes = Boxes.of([upper, near, lower])
    seen_from = np.array([0.3, -0.9, 0.3])
    order = from_back_to_front(boxes, seen_from / np.linalg.norm(seen_from))
    assert order.index(2) < order.index(0)
    assert order.index(2) < order.index(1)


def test_a_box_shows_three_faces_each_of_its_own_shade():
    polygons, colors = faces([lay(0.0, level=1)], "#d9a760")
    assert polygons.shape == (3, 4, 2)
    assert len(np.unique(colors.round(6), axis=0)) == 3
    assert np.ptp(polygons[..., 1]) > THICKNESS


def test_fixed_boxes_are_grey():
    plank, table = lay(0.0, level=2), lay(0.0, level=1)
    _, colors = faces([plank], "#d9a760", [table])
    assert len(colors) == 6
    grey = np.ptp(colors, axis=1) < 0.05
    assert grey.tolist() == [True] * 3 + [False] * 3, "the table is painted first"


def test_a_sheet_is_written_in_the_format_of_its_name(tmp_path):
    file = tmp_path / "scenes.svg"
    draw_contact_sheet(file, [build("card_house", storeys=2), build("jenga")])
    text = file.read_text()
    assert "<svg" in text
