"""The cut of two convex polygons, of which safe regions are made, against half planes."""

import numpy as np
import pytest

from stability_core.equilibrium.region import cut
from stability_core.polygon import convex_hull

HEIGHT = 0.3
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def polygon(corners):
    return np.array([(x, y, HEIGHT) for x, y in corners], float)


def random_polygon(generator):
    return convex_hull(np.column_stack([generator.normal(size=(8, 2)), np.full(8, HEIGHT)]))


def depth(hull, points):
    """How far [m] points (n, 3) lie inside a convex polygon, counter-clockwise; negative outside. Shape (n,)."""
    edge = np.roll(hull, -1, axis=0) - hull
    inward = np.column_stack([-edge[:, 1], edge[:, 0]]) / np.linalg.norm(edge[:, :2], axis=1, keepdims=True)
    return ((points[:, None, :2] - hull[None, :, :2]) * inward).sum(axis=2).min(axis=1)


def area(hull):
    x, y = hull[:, 0], hull[:, 1]
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


@pytest.mark.parametrize(
    ("by", "shared"),
    [
        ([(0.5, 0.5), (2, 0.5), (2, 2), (0.5, 2)], 0.25),
        ([(-1, -1), (2, -1), (2, 2), (-1, 2)], 1.0),
        ([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)], 0.25),
        ([(2, 0), (3, 0), (3, 1), (2, 1)], 0.0),
        ([(0, 0), (1, 0), (1, 1), (0, 1)], 1.0),
        ([(0.5, -1), (2, 0.5), (0.5, 2), (-1, 0.5)], 1.0),
    ],
    ids=["corner", "around", "within", "apart", "same", "diamond"],
)
def test_what_a_square_shares_with_another_polygon(by, shared):
    both = cut(polygon(SQUARE), polygon(by))
    assert area(both) == pytest.approx(shared)
    assert both[:, 2] == pytest.approx(HEIGHT)


@pytest.mark.parametrize("seed", range(20))
def test_a_point_is_in_the_cut_if_it_is_in_both(seed):
    generator = np.random.default_rng(seed)
    one, other = random_polygon(generator), random_polygon(generator)
    both = cut(one, other)
    points = np.column_stack([generator.uniform(-2, 2, size=(2000, 2)), np.full(2000, HEIGHT)])
    least = np.minimum(depth(one, points), depth(other, points))
    clear = abs(least) > 1e-9
    if len(both) < 3:
        assert (least[clear] < 0).all()
    else:
        assert ((depth(both, points) > 0) == (least > 0))[clear].all()
        assert area(both) == pytest.approx(area(cut(other, one)))
