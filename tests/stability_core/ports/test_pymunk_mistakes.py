"""Mistakes of a pymunk user: each ends in a message that names the fix, or is put right without one."""

from __future__ import annotations

import math

import numpy as np
import pytest

pymunk = pytest.importorskip("pymunk")

from stability_core.ports import attach  # noqa: E402
from stability_core.ports.pymunk import open_port  # noqa: E402
from stability_core.ports.shared.free_flight import FRAMES  # noqa: E402

STEP_S = 1 / 60
SLOP = 0.1
"""Overlap [px] that Chipmunk leaves between bodies at rest, as shipped."""


def open_space() -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = 0.0, -900.0
    floor = pymunk.Segment(space.static_body, (-5000, -5), (5000, -5), 5)
    floor.friction = 0.8
    space.add(floor)
    return space


def add(space: pymunk.Space, x: float = 0.0, y: float = 10.0, body_type: int = pymunk.Body.DYNAMIC) -> pymunk.Body:
    body = pymunk.Body(2.0, pymunk.moment_for_box(2.0, (40, 20)), body_type)
    body.position = x, y
    box = pymunk.Poly.create_box(body, (40, 20))
    box.friction = 0.8
    space.add(body, box)
    return body


def pendulum(space: pymunk.Space, x: float = 500.0) -> pymunk.Body:
    """Add a motor-driven arm that hangs from the static body."""
    body = add(space, x, 200.0)
    space.add(
        pymunk.PivotJoint(space.static_body, body, (x, 240.0)), pymunk.SimpleMotor(space.static_body, body, rate=2.0)
    )
    return body


@pytest.mark.parametrize(("steps", "times"), [(4, "times its velocity times dt"), (0, "moved 0 times its velocity")])
def test_more_steps_or_none_between_two_updates(steps: int, times: str) -> None:
    space = open_space()
    body = add(space, 0.0, 4000.0)
    body.velocity = 0.0, -300.0
    space.step(STEP_S)

    def run() -> None:
        for _ in range(FRAMES + 3):
            for _ in range(steps):
                space.step(STEP_S)
            extension.update(STEP_S)

    with attach(space) as extension, pytest.raises(ValueError, match=f"{times}.*pass the time of all steps"):
        run()


def test_several_steps_a_frame_are_no_mistake() -> None:
    space = open_space()
    add(space, 0.0, 4000.0)
    with attach(space) as extension:
        for _ in range(30):
            for _ in range(4):
                space.step(STEP_S / 4)
            extension.update(STEP_S)


def test_a_time_that_is_no_number_of_steps() -> None:
    space = open_space()
    with attach(space) as extension:
        space.step(1 / 50)
        with pytest.raises(ValueError, match=r"not a whole number of this space's steps of 0.02 s"):
            extension.update(1 / 60)


def test_no_gravity() -> None:
    with pytest.raises(ValueError, match=r"no gravity.*before attach"):
        attach(pymunk.Space())


def test_a_body_instead_of_a_space() -> None:
    space = open_space()
    with pytest.raises(TypeError, match=r"needs pymunk's Space, got Body: pass space = pymunk.Space"):
        attach(add(space))


def test_numbers_instead_of_bodies() -> None:
    with pytest.raises(TypeError, match=r"controls pymunk\.Body, got int: pass bodies"):
        attach(open_space(), bodies=[3])


def test_a_body_that_is_not_in_the_space() -> None:
    with pytest.raises(ValueError, match=r"not in this space: call space.add\(body, shape\) first"):
        attach(open_space(), bodies=[add(open_space())])


@pytest.mark.parametrize("body_type", [pymunk.Body.STATIC, pymunk.Body.KINEMATIC])
def test_a_body_that_is_not_dynamic(body_type: int) -> None:
    space = open_space()
    with pytest.raises(ValueError, match="is kinematic or static: list dynamic bodies only"):
        attach(space, bodies=[add(space, body_type=body_type)])


def test_a_body_with_joints() -> None:
    space = open_space()
    with pytest.raises(ValueError, match="has joints: list free bodies only"):
        attach(space, bodies=[pendulum(space)])


def test_a_body_listed_twice() -> None:
    space = open_space()
    body = add(space)
    with pytest.raises(ValueError, match=r"controls .* already: list each body once"):
        attach(space, bodies=[body, body])


def test_two_attachments() -> None:
    space = open_space()
    with attach(space), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(space)
    attach(space).close()


def test_the_engines_own_sleeping() -> None:
    space = open_space()
    with attach(space) as extension:
        space.sleep_time_threshold = 0.5
        space.step(STEP_S)
        with pytest.raises(ValueError, match=r"set space.sleep_time_threshold = float\('inf'\)"):
            extension.update(STEP_S)


def test_an_update_inside_a_step() -> None:
    """pymunk would abort the process if the extension made a body static there."""
    space = open_space()
    add(space, 0.0, 15.0)
    errors: list[str] = []
    with attach(space) as extension:

        def touches(*_: object) -> None:
            try:
                extension.update(STEP_S)
            except RuntimeError as error:
                errors.append(str(error))

        space.on_collision(None, None, post_solve=touches)
        for _ in range(30):
            space.step(STEP_S)
        assert errors
        assert "inside space.step(), in a callback: call it after space.step()" in errors[0]


def test_a_pose_that_is_not_finite() -> None:
    space = open_space()
    body = add(space, 0.0, 500.0)
    with attach(space) as extension:
        space.step(STEP_S)
        body.velocity_func = lambda body, *_: setattr(body, "angular_velocity", math.inf)
        space.step(STEP_S)
        with pytest.raises(
            ValueError, match=r"not finite, because the simulation has diverged or .*: use a smaller step"
        ):
            extension.update(STEP_S)


def test_use_after_close() -> None:
    space = open_space()
    body = add(space)
    extension = attach(space)
    extension.close()
    for use in (lambda: extension.update(STEP_S), extension.adopt, lambda: extension.add([body])):
        with pytest.raises(RuntimeError, match="closed: create a new"):
            use()


def test_an_unknown_body() -> None:
    with attach(open_space()) as extension:
        with pytest.raises(KeyError, match=r"no id in this pymunk space: pass a pymunk.Body that space.add"):
            extension.why(add(open_space()))
        with pytest.raises(KeyError, match=r"no body of this pymunk space has the id 7"):
            extension.body_of(7)


def test_a_frozen_body_that_gets_a_joint_is_live_until_the_joint_is_removed() -> None:
    """A kinematic hand lifts the box by a joint. pymunk refuses a joint between two bodies that are not dynamic."""
    space = open_space()
    body = add(space)
    with attach(space) as extension:
        extension.adopt()
        extension.wake([body])
        hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        hand.position, hand.velocity = body.position, (0.0, 60.0)
        grip = pymunk.PivotJoint(hand, body, body.position)
        space.add(hand, grip)
        for _ in range(120):
            space.step(STEP_S)
            extension.update(STEP_S)
        assert body.position.y > 100.0
        space.remove(grip, hand)
        for _ in range(180):
            space.step(STEP_S)
            extension.update(STEP_S)
        assert body.position.y == pytest.approx(10.0, abs=2 * SLOP)
        assert extension.id_of(body) in extension.frozen


def test_a_live_body_that_the_user_makes_kinematic_is_left_alone() -> None:
    space = open_space()
    body = add(space, 0.0, 200.0)
    with attach(space) as extension:
        space.step(STEP_S)
        extension.update(STEP_S)
        body.body_type = pymunk.Body.KINEMATIC
        body.velocity = 0.0, 0.0
        for _ in range(120):
            space.step(STEP_S)
            extension.update(STEP_S)
        assert not len(extension.frozen)
    assert body.body_type == pymunk.Body.KINEMATIC


def test_a_brick_on_a_ragdoll_that_moves_away_falls() -> None:
    """A jointed body is an obstacle: what lies on it freezes while it keeps its place, and no longer."""
    space = open_space()
    table = add(space, 0.0, 200.0)
    joints = [pymunk.PivotJoint(space.static_body, table, (x, 200.0)) for x in (-20.0, 20.0)]
    space.add(*joints)
    body = add(space, 0.0, 220.0)
    with attach(space) as extension:
        for _ in range(120):
            space.step(STEP_S)
            extension.update(STEP_S)
        assert extension.id_of(body) in extension.frozen, extension.why(body)
        space.remove(joints[0])
        for _ in range(120):
            space.step(STEP_S)
            extension.update(STEP_S)
        assert body.position.y < 100.0


def trajectory(*, attached: bool) -> np.ndarray:
    """Poses and velocities of a driven arm that strikes a box, beside a pile of falling boxes."""
    space = open_space()
    bodies = [
        pendulum(space, 100.0),
        add(space, 120.0, 150.0),
        *(add(space, -15.0 * k, 60.0 + 40 * k) for k in range(5)),
    ]
    platform = add(space, -60.0, 5.0, pymunk.Body.KINEMATIC)
    platform.velocity = 20.0, 0.0
    extension = attach(space) if attached else None
    rows = []
    for _ in range(40):
        space.step(STEP_S)
        if extension:
            extension.update(STEP_S)
            assert not len(extension.frozen)
        rows.append([[*body.position, body.angle, *body.velocity, body.angular_velocity] for body in bodies])
    if extension:
        extension.close()
    return np.array(rows)


def test_joints_and_motors_keep_their_trajectories_to_the_bit_while_nothing_is_frozen() -> None:
    np.testing.assert_array_equal(trajectory(attached=True), trajectory(attached=False))


def test_finding_contacts_changes_no_trajectory_by_a_bit() -> None:
    def last(*, finds: bool) -> list[float]:
        space = open_space()
        bodies = [add(space, 5.0 * k, 10.0 + 20 * k) for k in range(4)]
        port = open_port(space, None) if finds else None
        for _ in range(60):
            if port:
                port.find_contacts()
                assert len(port.contacts())
            space.step(STEP_S)
        return [value for body in bodies for value in (*body.position, body.angle, *body.velocity)]

    assert last(finds=True) == last(finds=False)
