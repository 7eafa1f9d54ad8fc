"""The figure of what height costs repeats byte for byte."""

from reports.figures.height_cost import write_cost_figure
from tests.reports.studies import cost_point as point


def test_the_same_points_make_the_same_picture_with_words_as_text(tmp_path) -> None:
    points = [point(5, 1.0), point(9, 4.0), point(30, 0.5, policy="paper"), point(7, 2.0, engine="mujoco")]
    pictures = []
    for name in ("one.svg", "two.svg"):
        write_cost_figure(tmp_path / name, points)
        pictures.append((tmp_path / name).read_text(encoding="utf-8"))
    assert pictures[0] == pictures[1]
    assert all(f">{word}<" in pictures[0] for word in ("bullet", "mujoco", "paper", "levels that stood"))
