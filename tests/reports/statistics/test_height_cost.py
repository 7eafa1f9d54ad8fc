"""Which set-ups no other one beats."""

from reports.statistics.height_cost import frontier
from tests.reports.studies import cost_point as point


def test_the_frontier_rises_with_the_cost() -> None:
    cheap, beaten, equal, dear = point(5, 1.0), point(4, 2.0), point(5, 3.0), point(9, 4.0)
    assert frontier([dear, equal, beaten, cheap]) == [cheap, dear]
    assert frontier([point(4, 1.0), cheap]) == [cheap]
