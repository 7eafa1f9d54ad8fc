"""An extension on a pymunk space that a user owns. Lengths are pixels, as in a game."""

from __future__ import annotations

import math

import numpy as np
import pytest

pymunk = pytest.importorskip("pymunk")

from stability_core import check_port  # noqa: E402
from stability_core.ports import ObjectAttachment, attach  # noqa: E402
from stability_core.ports.pymunk import open_port  # noqa: E402

STEP_S = 1 / 60
WIDTH, HEIGHT = 60.0, 20.0
SLOP = 0.1
"""Overlap [px] that Chipmunk leaves between bodies at rest, as shipped."""
KINDS = ("box", "hexagon", "sandwich")


def open_space(gravity: tuple[float, float] = (0.0, -900.0)) -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = gravity
    floor = pymunk.Segment(space.static_body, (-500, -5), (500, -5), 5)
    floor.friction = 0.8
    space.add(floor)
    return space


def outlines(kind: str, body: pymunk.Body) -> list[pymunk.Shape]:
    if kind == "box":
        return [pymunk.Poly.create_box(body, (WIDTH, HEIGHT))]
    if kind == "sandwich":  # of two shapes, side by side
        left, right = [[(x + sign * 15, y) for x in (-15, 15) for y in (-10, 10)] for sign in (-1, 1)]
        return [pymunk.Poly(body, left), pymunk.Poly(body, right)]
    width = HEIGHT / math.sqrt(3)
    return [pymunk.Poly(body, [(x, y) for y in (-10, 10) for x in (-width / 2, width / 2)] + [(-width, 0), (width, 0)])]


def add(
    space: pymunk.Space, x: float, y: float, kind: str = "box", body_type: int = pymunk.Body.DYNAMIC, mass: float = 2.0
) -> pymunk.Body:
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, (WIDTH, HEIGHT)), body_type)
    body.position = x, y
    shapes = outlines(kind, body)
    for shape in shapes:
        shape.friction = 0.8
    space.add(body, *shapes)
    return body


def tower(space: pymunk.Space, count: int, kind: str = "box") -> list[pymunk.Body]:
    return [add(space, 0.0, (level + 0.5) * HEIGHT, kind) for level in range(count)]


def run(space: pymunk.Space, extension: ObjectAttachment, seconds: float) -> None:
    for _ in range(round(seconds / STEP_S)):
        space.step(STEP_S)
        extension.update(STEP_S)


def frozen(extension: ObjectAttachment) -> list[pymunk.Body]:
    return [extension.body_of(body) for body in extension.frozen]


def pose(body: pymunk.Body) -> tuple[float, float, float]:
    return (*body.position, body.angle)


def test_the_port_keeps_its_promises() -> None:
    space = open_space()
    tower(space, 1)
    checks = check_port(open_port(space, None), lambda: space.step(STEP_S))
    assert "touches the ground in 4 contact points" in "\n".join(checks)


@pytest.mark.parametrize("kind", KINDS)
def test_a_prebuilt_tower_freezes_before_its_first_step_and_does_not_move(kind: str) -> None:
    space = open_space()
    bodies = tower(space, 4, kind)
    with attach(space) as extension:
        extension.adopt()
        assert frozen(extension) == bodies
        before = [pose(body) for body in bodies]
        run(space, extension, 0.5)
        assert before == [pose(body) for body in bodies]


@pytest.mark.parametrize("kind", KINDS)
def test_bodies_that_come_one_by_one_freeze_where_they_land(kind: str) -> None:
    space = open_space()
    with attach(space) as extension:
        for level in range(3):
            body = add(space, 0.0, (level + 0.5) * HEIGHT + 0.1, kind)
            run(space, extension, 1.5)
            assert body in frozen(extension), extension.why(body)


def test_gravity_that_points_down_the_screen_is_followed() -> None:
    """In pygame's coordinates y grows downward: the tower hangs from a floor above it, in pymunk's words."""
    space = open_space((0.0, 900.0))
    bodies = [add(space, 0.0, -10.0 - (level + 0.5) * HEIGHT) for level in range(3)]
    with attach(space) as extension:
        assert extension.gravity == (0.0, 0.0, 900.0)
        extension.adopt()
        assert frozen(extension) == bodies


@pytest.mark.parametrize("scale", [1e-3, 1.0, 50.0])
def test_the_unit_of_length_does_not_matter(scale: float) -> None:
    """A tower in metres, pixels, or a fiftieth of a pixel, under the same gravity in sizes of a body."""
    space = open_space((0.0, -900.0 * scale))
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (40 * scale, 20 * scale)))
    body.position = 0.0, 10 * scale
    box = pymunk.Poly.create_box(body, (40 * scale, 20 * scale))
    box.friction = 0.8
    space.collision_slop = 0.1 * scale
    space.add(body, box)
    with attach(space) as extension:
        assert len(extension.adopt().frozen) == 1
        extension.wake([body])
        run(space, extension, 3.0)
        assert frozen(extension) == [body], extension.why(body)


def test_an_overhang_beyond_the_edge_stays_live_and_tips() -> None:
    """The centre of the upper box lies 5 px outside its support. The box ends leaning on the lower box's edge."""
    space = open_space()
    add(space, 0.0, HEIGHT / 2)
    upper = add(space, WIDTH / 2 + 5, 1.5 * HEIGHT)
    with attach(space) as extension:
        extension.adopt()
        run(space, extension, 1.0)
        assert upper.angle < -math.radians(15)


def test_bricks_that_meet_in_a_corner_do_not_bear_each_other() -> None:
    """The corner of the upper box touches the corner of the lower box at a gap of zero."""
    space = open_space()
    lower = add(space, 0.0, HEIGHT / 2)
    add(space, WIDTH, 1.5 * HEIGHT)
    with attach(space) as extension:
        extension.adopt()
        assert frozen(extension) == [lower]


@pytest.mark.parametrize("is_announced", [True, False])
def test_removing_a_support_wakes_what_rests_on_it(is_announced: bool) -> None:
    space = open_space()
    lower, upper = tower(space, 2)
    with attach(space) as extension:
        extension.adopt()
        if is_announced:
            extension.remove([lower])
        space.remove(lower, *lower.shapes)
        run(space, extension, 1.0)
        assert upper.position.y == pytest.approx(HEIGHT / 2, abs=2 * SLOP)
        assert lower.body_type == pymunk.Body.DYNAMIC  # the user gets the body back as it was
        assert (lower.mass, lower.moment) == (upper.mass, upper.moment) or upper in frozen(extension)


def test_a_removed_body_may_come_back() -> None:
    space = open_space()
    (body,) = tower(space, 1)
    with attach(space) as extension:
        extension.adopt()
        space.remove(body, *body.shapes)
        run(space, extension, STEP_S)
        body.position = 100.0, 50.0
        space.add(body, *body.shapes)
        run(space, extension, 2.0)
        assert body.position.y == pytest.approx(HEIGHT / 2, abs=2 * SLOP)
        assert frozen(extension) == [body]


def test_a_kinematic_platform_that_sinks_takes_its_load_along() -> None:
    space = open_space()
    platform = add(space, 0.0, 200.0, body_type=pymunk.Body.KINEMATIC)
    body = add(space, 0.0, 200.0 + HEIGHT)
    with attach(space) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        platform.velocity = 0.0, -30.0
        run(space, extension, 2.0)
        assert body.position.y == pytest.approx(platform.position.y + HEIGHT, abs=2 * SLOP)


def test_a_platform_that_turns_in_place_wakes_its_load() -> None:
    """The platform turns by 60 degrees, which is steeper than friction 0.8 * 0.8 holds."""
    space = open_space()
    platform = add(space, 0.0, 200.0, body_type=pymunk.Body.KINEMATIC)
    body = add(space, 0.0, 200.0 + HEIGHT)
    with attach(space) as extension:
        extension.adopt()
        platform.angle = math.radians(60.0)
        run(space, extension, 1.0)
        assert body.position.y < 150.0


def test_a_kinematic_pusher_moves_a_frozen_box() -> None:
    """Chipmunk lists no contact between a kinematic and a static body: the port finds it."""
    space = open_space()
    (body,) = tower(space, 1)
    pusher = add(space, -WIDTH - 20.0, HEIGHT / 2 + 1.0, body_type=pymunk.Body.KINEMATIC)
    with attach(space) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        pusher.velocity = 40.0, 0.0
        run(space, extension, 2.0)
        assert body.position.x > 50.0


def test_a_ball_unfreezes_what_it_strikes() -> None:
    space = open_space()
    bodies = tower(space, 3)
    with attach(space) as extension:
        extension.adopt()
        ball = pymunk.Body(5.0, 5000.0)
        ball.position, ball.velocity = (-200.0, 2.5 * HEIGHT), (800.0, 0.0)
        space.add(ball, pymunk.Circle(ball, 10.0))
        run(space, extension, 1.0)
        assert bodies[2].position.x > 5.0


def test_a_disc_rolls_down_a_slope_of_two_degrees() -> None:
    """It rests on a point. In 2 s it rolls by g sin(2 deg) t2 / 3 = 42 px; 20 px at least."""
    space = open_space((900 * math.sin(math.radians(2)), -900.0))
    disc = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0, 20.0))
    disc.position = 0.0, 20.0
    circle = pymunk.Circle(disc, 20.0)
    circle.friction = 0.8
    space.add(disc, circle)
    with attach(space) as extension:
        assert not extension.adopt().frozen
        run(space, extension, 2.0)
        assert disc.position.x > 20.0


def test_a_frozen_body_that_the_user_moves_or_throws_is_live_again() -> None:
    space = open_space()
    moved, thrown = add(space, -100.0, HEIGHT / 2), add(space, 100.0, HEIGHT / 2)
    with attach(space) as extension:
        extension.adopt()
        moved.position = -100.0, 80.0
        thrown.velocity = 0.0, 300.0
        run(space, extension, 0.1)
        assert moved.position.y < 79.0
        assert thrown.position.y > 20.0


def test_close_returns_every_body_with_its_mass_moment_and_centre() -> None:
    space = open_space()
    (body,) = tower(space, 1)
    body.moment, body.center_of_gravity = 777.0, (1.0, -2.0)
    body.position = 0.0, HEIGHT / 2
    extension = attach(space)
    extension.adopt()
    assert body.body_type == pymunk.Body.STATIC
    extension.close()
    assert (body.mass, body.moment, tuple(body.center_of_gravity)) == (2.0, 777.0, (1.0, -2.0))
    assert np.allclose(body.position, (0.0, HEIGHT / 2), rtol=0, atol=1e-12)  # rounding of the centre's place


def test_the_centre_of_gravity_decides_and_not_the_origin() -> None:
    """Both boxes overhang by 20 of 60 px. The centre of the second lies above the edge's far side."""
    space = open_space()
    for x in (-200.0, 200.0):
        add(space, x, HEIGHT / 2)
    stands, falls = add(space, -180.0, 1.5 * HEIGHT), add(space, 220.0, 1.5 * HEIGHT)
    falls.center_of_gravity = 15.0, 0.0
    falls.position = 220.0, 1.5 * HEIGHT
    with attach(space) as extension:
        extension.adopt()
        assert stands in frozen(extension)
        assert falls not in frozen(extension)


def test_bodies_that_are_not_listed_are_left_alone() -> None:
    space = open_space()
    first, second = add(space, 0.0, HEIGHT / 2), add(space, 200.0, HEIGHT / 2)
    with attach(space, bodies=[first]) as extension:
        extension.adopt()
        run(space, extension, 1.0)
        assert frozen(extension) == [first]
        extension.add([second])
        run(space, extension, 1.0)
        assert frozen(extension) == [first, second]
        extension.remove([first])
        assert first.body_type == pymunk.Body.DYNAMIC
        run(space, extension, 1.0)
        assert frozen(extension) == [second]


def test_shapes_that_do_not_collide_bear_nothing() -> None:
    """The upper box stands in a sensor and on a box of its own group."""
    space = open_space()
    (lower,) = tower(space, 1)
    upper = add(space, 0.0, 1.5 * HEIGHT)
    for body in (lower, upper):
        for shape in body.shapes:
            shape.filter = pymunk.ShapeFilter(group=1)
    sensor = pymunk.Poly.create_box(space.static_body, (400, 400))
    sensor.sensor = True
    space.add(sensor)
    with attach(space) as extension:
        extension.adopt()
        assert frozen(extension) == [lower]
