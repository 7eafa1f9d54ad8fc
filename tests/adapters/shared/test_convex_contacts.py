"""Missing corners of contact areas of which one body is no box: faces, lines and points."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters.shared.contact_completion import fixed_id
from adapters.shared.convex_contacts import RIM, ConvexContacts
from scenarios.model import Brick, World
from scenarios.solids import capsule, cylinder, polyhedron, sphere
from stability_core.port import GROUND, Contacts

ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
ALONG_X = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
UP = (0.0, 0.0, 1.0)


def one_contact(a: int, b: int, point, normal=UP, gap=-1e-5) -> Contacts:
    row = np.array([normal])
    return Contacts(np.array([a]), np.array([b]), np.array([point]), row, np.array([gap]), 0 * row, np.array([0.45]))


def completed(bricks: list[Brick], contacts: Contacts, world: World | None = None) -> Contacts:
    table = ConvexContacts(world or World())
    for body, brick in enumerate(bricks):
        table.add(body, brick)
    return table.completed(
        contacts,
        lambda ids: (
            np.array([bricks[body].position for body in ids.tolist()]),
            np.array([bricks[body].quaternion for body in ids.tolist()]),
        ),
    )


def test_a_standing_cylinder_gets_its_whole_rim() -> None:
    brick = cylinder(0.02, 0.05, position=(0.1, 0.0, 0.025), mass=1.0)
    whole = completed([brick], one_contact(GROUND, 0, (0.12, 0.0, 0.0)))
    assert len(whole) == RIM  # the listed point is one of them
    assert np.hypot(*(whole.point - (0.1, 0.0, 0.0))[:, :2].T) == pytest.approx(0.02)
    assert (whole.normal == UP).all()
    assert whole.separation == pytest.approx(-1e-5)


def test_a_lying_cylinder_and_a_capsule_get_both_ends_of_their_line() -> None:
    lying = cylinder(0.02, 0.05, position=(0.0, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0)
    pill = capsule(0.02, 0.05, position=(0.0, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0)
    for brick in (lying, pill):
        whole = completed([brick], one_contact(GROUND, 0, (0.0, 0.001, 0.0)))
        assert sorted(whole.point[1:, 1]) == pytest.approx([-0.025, 0.025], abs=1e-6)
        assert whole.point[1:, 0] == pytest.approx([0.0, 0.0], abs=1e-6)


def test_a_log_that_has_rolled_still_touches_below_its_axis() -> None:
    """However it is turned about its own axis."""
    for turn in np.linspace(0.0, math.pi, 7):
        spin = np.array([math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2)])
        w, x, _, _ = ALONG_Y
        quaternion = (w * spin[0], x * spin[0], -x * spin[3], w * spin[3])
        brick = cylinder(0.02, 0.05, position=(0.0, 0.0, 0.02), quaternion=quaternion, mass=1.0)
        whole = completed([brick], one_contact(GROUND, 0, (0.0, 0.001, 0.0)))
        assert whole.point[1:, 0] == pytest.approx([0.0, 0.0], abs=1e-6)


def test_two_logs_share_a_line_and_crossed_logs_a_point() -> None:
    lower = cylinder(0.02, 0.10, position=(0.0, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0)
    upper = cylinder(0.02, 0.06, position=(0.0, 0.03, 0.06), quaternion=ALONG_Y, mass=1.0)
    whole = completed([lower, upper], one_contact(0, 1, (0.0, 0.02, 0.04)))
    assert sorted(whole.point[1:, 1]) == pytest.approx([0.0, 0.05], abs=1e-6)
    crossed = cylinder(0.02, 0.06, position=(0.0, 0.0, 0.06), quaternion=ALONG_X, mass=1.0)
    assert len(completed([lower, crossed], one_contact(0, 1, (0.0, 0.0, 0.04)))) == 1


def test_a_prism_on_a_box_touches_where_their_faces_overlap() -> None:
    wedge = polyhedron(
        [(0, -0.02, 0), (0.1, -0.02, 0), (0, -0.02, 0.05), (0, 0.02, 0), (0.1, 0.02, 0), (0, 0.02, 0.05)],
        position=(0.0, 0.0, 0.04),
        mass=1.0,
    )
    table = Brick((0.1, 0.1, 0.04), 1.0, (0.0, 0.0, 0.02))
    whole = completed([table, wedge], one_contact(0, 1, (0.01, 0.0, 0.04)))
    corners = {tuple(corner) for corner in np.round(whole.point[1:, :2], 6).tolist()}
    assert corners == {(0.0, -0.02), (0.0, 0.02), (0.05, -0.02), (0.05, 0.02)}


def test_spheres_boxes_and_fixed_bodies_are_left_as_they_are_or_completed() -> None:
    ball = sphere(0.02, position=(0.0, 0.0, 0.02), mass=1.0)
    assert len(completed([ball], one_contact(GROUND, 0, (0.0, 0.0, 0.0)))) == 1
    box = Brick((0.04, 0.04, 0.04), 1.0, (0.0, 0.0, 0.02))
    boxes = one_contact(GROUND, 0, (0.0, 0.0, 0.0))
    assert completed([box], boxes) is boxes
    post = World(fixed=(cylinder(0.03, 0.1, position=(0.0, 0.0, 0.05), mass=1.0),))
    on_post = Brick((0.04, 0.04, 0.04), 1.0, (0.0, 0.0, 0.12))
    whole = completed([on_post], one_contact(fixed_id(0), 0, (0.0, 0.0, 0.1)), post)
    assert np.abs(whole.point[1:, :2]).max() == pytest.approx(0.02, abs=1e-6)
    assert len(whole) == 5
