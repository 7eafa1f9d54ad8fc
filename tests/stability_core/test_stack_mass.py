"""Eqs 1-5 of the paper on stacks worked by hand: masses in kg, lengths in m."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.port import GROUND
from stability_core.stack import FROZEN, LEAN, NONE, SUPPORT, empty_graph, grown, link, unlink, with_all_above
from stability_core.stack_mass import carry_down, equivalent_mass, nearest_vertex, support_polygon


class Drawing:
    """A graph drawn by hand."""

    def __init__(self, bodies: dict[int, tuple[float, tuple[float, float, float]]]) -> None:
        self.graph = grown(empty_graph(), max(bodies) + 1, 64)
        for body, (mass, center) in bodies.items():
            row = self.graph.bodies[body]
            row["state"], row["mass"], row["center"] = FROZEN, mass, center

    def rest(self, upper: int, lower: int, x: tuple[float, float], z: float = 0.0, kind: int = SUPPORT) -> None:
        link(self.graph, upper, lower, kind)
        patch = self.graph.patches[self.graph.bodies["first_support"][upper]]
        corners = [(x[0], -1, z), (x[1], -1, z), (x[1], 1, z), (x[0], 1, z)]
        patch["vertex"][:4], patch["vertices"] = corners, 4
        patch["center"], patch["normal"], patch["friction"] = np.mean(corners, axis=0), (0, 0, 1), 0.45

    def carried(self) -> np.ndarray:
        carry_down(self.graph, np.flatnonzero(self.graph.bodies["state"] == FROZEN))
        return self.graph.bodies


def test_single_branch_is_the_weighted_mean_of_all_above():
    drawing = Drawing({0: (2.0, (0, 0, 0)), 1: (1.0, (0.3, 0, 1)), 2: (1.0, (0.5, 0.2, 2))})
    drawing.rest(0, GROUND, (-1, 1))
    drawing.rest(1, 0, (-1, 1))
    drawing.rest(2, 1, (-1, 1))
    bodies = drawing.carried()
    assert bodies["stack_mass"][:3] == pytest.approx([4, 2, 1])
    assert bodies["stack_center"][1] == pytest.approx([0.4, 0.1, 1.5])
    assert bodies["stack_center"][0] == pytest.approx([(2 * 0 + 2 * 0.4) / 4, 0.2 / 4, 3 / 4])


def test_split_branch_sums_over_every_body_above():
    drawing = Drawing({0: (1.0, (0, 0, 0)), 1: (2.0, (-1, 0, 1)), 2: (3.0, (1, 0, 1))})
    drawing.rest(0, GROUND, (-2, 2))
    drawing.rest(1, 0, (-1.5, -0.5))
    drawing.rest(2, 0, (0.5, 1.5))
    bodies = drawing.carried()
    assert bodies["stack_mass"][0] == pytest.approx(6)
    assert bodies["stack_center"][0] == pytest.approx([(-2 + 3) / 6, 0, 5 / 6])


def bridge(center_x: float) -> np.ndarray:
    """A plank of 1 kg over two pillars with contact areas [-3, -2] and [2, 3]."""
    drawing = Drawing({0: (1.0, (-2.5, 0, 0)), 1: (1.0, (2.5, 0, 0)), 2: (1.0, (center_x, 0, 1))})
    drawing.rest(0, GROUND, (-3, -2))
    drawing.rest(1, GROUND, (2, 3))
    drawing.rest(2, 0, (-3, -2), 0.5)
    drawing.rest(2, 1, (2, 3), 0.5)
    return drawing.carried()


def test_merge_first_case_one_support_carries_all():
    bodies = bridge(2.2)  # inside the right area
    assert bodies["stack_mass"][:2] == pytest.approx([1, 2])
    assert bodies["stack_center"][1] == pytest.approx([(2.5 + 2.2) / 2, 0, 0.5])


def test_merge_two_supports_shares_by_equivalent_mass_at_the_contact_centre():
    """C = (0.5, 0). Pivot for the left share: the right area's corner (2, +-1); for the right one (-2, +-1)."""
    bodies = bridge(0.5)
    left = np.hypot(1.5, 1) / np.hypot(4.5, 1)
    right = np.hypot(2.5, 1) / np.hypot(4.5, 1)
    assert bodies["stack_mass"][:2] == pytest.approx([1 + left, 1 + right])
    assert bodies["stack_center"][1] == pytest.approx([2.5, 0, right * 0.5 / (1 + right)])
    assert left + right == pytest.approx(0.975, abs=1e-3)  # the paper's shares do not conserve mass


def test_merge_of_more_than_two_supports_gives_equal_shares():
    pillars = {i: (1.0, (float(x), 0.0, 0.0)) for i, x in enumerate((-4, 0, 4))}
    drawing = Drawing(pillars | {3: (6.0, (2.0, 0, 1))})
    for i, x in enumerate((-4, 0, 4)):
        drawing.rest(i, GROUND, (x - 0.5, x + 0.5))
        drawing.rest(3, i, (x - 0.5, x + 0.5), 0.5)
    bodies = drawing.carried()
    assert bodies["stack_mass"][:3] == pytest.approx([3, 3, 3])
    assert bodies["stack_center"][0] == pytest.approx([-4, 0, 2 * 0.5 / 3])


def test_own_area_rule_wins_over_equal_shares():
    pillars = {i: (1.0, (float(x), 0.0, 0.0)) for i, x in enumerate((-4, 0, 4))}
    drawing = Drawing(pillars | {3: (6.0, (0.2, 0, 1))})
    for i, x in enumerate((-4, 0, 4)):
        drawing.rest(i, GROUND, (x - 0.5, x + 0.5))
        drawing.rest(3, i, (x - 0.5, x + 0.5), 0.5)
    assert drawing.carried()["stack_mass"][:3] == pytest.approx([1, 7, 1])


def test_a_leaning_body_stands_on_its_pivot_with_all_its_weight():
    drawing = Drawing({0: (1.0, (0, 0, 0)), 1: (1.0, (5, 0, 1)), 2: (2.0, (2, 0, 3))})
    drawing.rest(0, GROUND, (-1, 1))
    drawing.rest(1, GROUND, (4, 6))
    drawing.rest(2, 0, (0.9, 1.0), z=0.5)  # the foot
    drawing.rest(2, 1, (4, 4.1), z=4.0, kind=LEAN)
    drawing.graph.bodies["leans"][2] = True
    bodies = drawing.carried()
    assert bodies["stack_mass"][:2] == pytest.approx([3, 1])
    assert bodies["stack_center"][0, 0] == pytest.approx((0 + 2 * 1.0) / 3)  # at the foot's point closest to C


def test_equivalent_mass_is_the_lever_rule_along_a_line():
    pivot, contact = np.zeros(3), np.array([4.0, 0, 0])
    assert equivalent_mass(2.0, np.array([1.0, 0, 7]), pivot, contact) == pytest.approx(0.5)
    assert equivalent_mass(2.0, np.array([1.0, 0, 7]), pivot, pivot) == pytest.approx(1.0)  # no lever: halves


def test_nearest_vertex_is_measured_in_plan():
    hull = np.array([(0, 0, 9), (3, 0, 0)], float)
    assert nearest_vertex(hull, np.array([1.0, 0, 0])) == pytest.approx([0, 0, 9])


def test_support_polygon_joins_all_supports():
    drawing = Drawing({0: (1.0, (-2.5, 0, 0)), 1: (1.0, (2.5, 0, 0)), 2: (1.0, (0, 0, 1))})
    drawing.rest(2, 0, (-3, -2))
    drawing.rest(2, 1, (2, 3))
    assert np.ptp(support_polygon(drawing.graph, 2)[:, 0]) == pytest.approx(6)


def test_only_what_lies_below_a_change_is_worked_again():
    drawing = Drawing({i: (1.0, (0.0, 0.0, float(i))) for i in range(4)} | {9: (1.0, (50, 0, 0))})
    for i in range(4):
        drawing.rest(i, i - 1 if i else GROUND, (-1, 1))
    drawing.rest(9, GROUND, (49, 51))
    drawing.carried()
    drawing.graph.bodies["mass"][2] = 3.0
    assert carry_down(drawing.graph, np.array([2])).tolist() == [2, 1, 0]
    assert drawing.graph.bodies["stack_mass"][0] == pytest.approx(6)
    assert carry_down(drawing.graph, np.array([2])).tolist() == [2], "nothing changed: it ends at once"


def test_what_rests_on_a_body_is_found_through_all_branches():
    drawing = Drawing({i: (1.0, (0.0, 0.0, float(i))) for i in range(5)})
    for upper, lower in ((1, 0), (2, 1), (3, 1), (4, GROUND)):
        drawing.rest(upper, lower, (-1, 1))
    assert sorted(with_all_above(drawing.graph, np.array([1]))) == [1, 2, 3]
    assert sorted(with_all_above(drawing.graph, np.array([0, 4, 0]))) == [0, 1, 2, 3, 4]


def test_unlinked_patches_leave_both_lists_and_are_used_again():
    drawing = Drawing({i: (1.0, (0.0, 0.0, float(i))) for i in range(3)})
    spare = drawing.graph.spare[0]
    drawing.rest(1, 0, (-1, 1))
    drawing.rest(2, 0, (-1, 1))
    drawing.rest(2, 1, (-1, 1))
    first = int(drawing.graph.bodies["first_load"][0])
    for at in (first, int(drawing.graph.patches["next_load"][first])):
        unlink(drawing.graph, at)
    assert drawing.graph.bodies["first_load"][0] == NONE
    assert drawing.graph.bodies["first_support"][1] == NONE
    unlink(drawing.graph, int(drawing.graph.bodies["first_support"][2]))
    assert drawing.graph.spare[0] == spare
    assert len(set(drawing.graph.spare[1:].tolist())) == spare
