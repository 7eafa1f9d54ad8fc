"""An extension on a Rapier world that a user owns."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import check_port
from stability_core.ports import attach
from tests.stability_core.ports.rapier_world import (
    HEIGHT,
    STEP_S,
    add,
    arm,
    height,
    id_of,
    ids,
    open_world,
    position,
    rapier3d,
    run,
    view,
)

KINDS = ["box", "cylinder", "hull", "offset", "two colliders", "compound"]


@pytest.fixture
def world():
    return open_world()


def tower(world, count: int, kind: str = "box") -> list:
    return [add(world, (0.0, 0.0, (level + 0.5) * HEIGHT), kind) for level in range(count)]


def places(world, handles) -> list:
    return [view(world, handle).position.to_matrix().tolist() for handle in handles]


def test_the_port_keeps_the_promises_of_a_port(world) -> None:
    tower(world, 2)
    from stability_core.ports.rapier import open_port

    port = open_port(world, None)

    def step() -> None:
        world.step()
        port.begin_update(STEP_S)

    assert "stayed frozen for 10 frames without moving" in check_port(port, step)[-1]


@pytest.mark.parametrize("kind", KINDS)
def test_a_prebuilt_tower_freezes_before_its_first_step_and_does_not_move(world, kind: str) -> None:
    handles = tower(world, 4, kind)
    with attach(world) as extension:
        assert list(extension.adopt().frozen) == ids(handles)
        before = places(world, handles)
        run(world, extension, 0.5)
        assert places(world, handles) == before


@pytest.mark.parametrize("kind", KINDS)
def test_bodies_that_come_one_by_one_freeze_where_they_land(world, kind: str) -> None:
    with attach(world) as extension:
        top = 0.0
        for _ in range(3):
            handle = add(world, (0.0, 0.0, top + HEIGHT / 2 + 0.0005), kind)
            run(world, extension, 1.2)
            assert id_of(handle) in extension.frozen, extension.why(id_of(handle))
            top += HEIGHT


def test_an_overhang_beyond_the_edge_stays_live_and_falls(world) -> None:
    """The centre of the upper box lies 1 cm outside its support."""
    add(world, (0.0, 0.0, HEIGHT / 2))
    upper = add(world, (0.06, 0.0, 1.5 * HEIGHT))
    with attach(world) as extension:
        extension.adopt()
        run(world, extension, 1.0)
        assert height(world, upper) < HEIGHT


@pytest.mark.parametrize("is_announced", [True, False])
def test_removing_a_support_wakes_what_rests_on_it(world, is_announced: bool) -> None:
    lower, upper = tower(world, 2)
    with attach(world) as extension:
        extension.adopt()
        if is_announced:
            extension.remove([id_of(lower)])
        world.remove_body(lower)
        run(world, extension, 1.0)
        assert height(world, upper) == pytest.approx(HEIGHT / 2, abs=1e-3)


def test_an_index_that_rapier_uses_again_is_another_body(world) -> None:
    (first,) = tower(world, 1)
    with attach(world) as extension:
        extension.adopt()
        world.remove_body(first)
        second = add(world, (0.0, 0.0, 1.0))
        assert (second.index, second.generation) == (first.index, first.generation + 1)
        run(world, extension, 0.2)
        assert not len(extension.frozen)
        run(world, extension, 1.3)
        assert list(extension.frozen) == [id_of(second)]


def test_a_platform_that_the_user_lowers_takes_its_tower_along(world) -> None:
    platform = add(world, (0.0, 0.0, 0.5), motion="kinematic_velocity_based")
    body = add(world, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(world) as extension:
        extension.adopt()
        assert list(extension.frozen) == [id_of(body)]
        view(world, platform).linvel = (0.0, 0.0, -0.05)
        run(world, extension, 1.2)
        assert height(world, platform) == pytest.approx(0.44, abs=1e-4)
        assert height(world, body) == pytest.approx(0.44 + HEIGHT, abs=2e-3)


@pytest.mark.parametrize("calm_s", [0.0, 3.0])
@pytest.mark.parametrize("has_body", [True, False])
def test_a_platform_that_turns_in_place_wakes_its_load(world, has_body: bool, calm_s: float) -> None:
    place = (0.0, 0.0, 0.5)
    if has_body:
        platform = view(world, add(world, place, motion="fixed"))
    else:
        collider = rapier3d.Collider.cuboid(0.05, 0.05, 0.03).translation(place)
        platform = world.colliders[world.add_collider(collider)]
    body = add(world, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(world) as extension:
        assert list(extension.adopt().frozen) == [id_of(body)]
        run(world, extension, calm_s)
        platform.rotation = (0.0, np.sin(0.35), 0.0, np.cos(0.35))  # steeper than the friction of 0.5 holds
        run(world, extension, 1.0)
        assert height(world, body) < 0.3


def test_a_kinematic_pusher_moves_a_frozen_body(world) -> None:
    """Rapier lists no contact of a kinematic and a fixed body, so that the pusher would go through the body."""
    body = add(world, (0.0, 0.0, HEIGHT / 2))
    pusher = add(world, (-0.2, 0.0, HEIGHT / 2), motion="kinematic_velocity_based")
    with attach(world) as extension:
        extension.adopt()
        view(world, pusher).linvel = (0.2, 0.0, 0.0)
        run(world, extension, 1.0)
        assert position(world, body)[0] == pytest.approx(0.1, abs=5e-3)


def test_an_arm_pushes_a_frozen_body_aside(world) -> None:
    """The tip of the arm swings down from the right, to 1 cm above the ground, through the place of the box."""
    _, link, joint = arm(world, (0.0, 0.0, 0.36), is_multibody=True)
    body = add(world, (0.1, 0.0, HEIGHT / 2))
    with attach(world) as extension:
        extension.adopt()
        assert list(extension.frozen) == [id_of(body)]
        multibody, part = world.multibody_joints.get(joint)
        multibody.set_link_motor(part, rapier3d.JointAxis.ANG_X, 3.0, 0.0, 100.0, 5.0)
        view(world, link).wake_up()
        run(world, extension, 2.0)
        assert position(world, body)[0] < 0.05


def test_gravity_along_y_is_followed() -> None:
    """The box stands on a wall: down is where the world says."""
    world = open_world((0.0, -9.81, 0.0))
    add(world, (0.0, 1.0, 5.0), motion="fixed")
    body = add(world, (0.0, 1.1, 5.0))
    with attach(world) as extension:
        assert extension.gravity == pytest.approx((0.0, -9.81, 0.0))
        assert extension.adopt().frozen == (id_of(body),)


def test_gravity_that_turns_wakes_the_stack(world) -> None:
    lower, upper = tower(world, 2)
    with attach(world) as extension:
        extension.adopt()
        world.gravity = (9.81, 0.0, 0.0)
        run(world, extension, 0.5)
        assert position(world, upper)[0] > 0.5
        assert position(world, lower)[0] > 0.5


def test_close_returns_every_body(world) -> None:
    (handle,) = tower(world, 1)
    body = view(world, handle)

    def state() -> tuple:
        return body.mass, body.mass_properties.principal_inertia.to_tuple(), body.is_dynamic

    before = state()
    extension = attach(world)
    extension.adopt()
    assert body.is_fixed
    extension.close()
    assert state() == before


def test_bodies_that_are_not_listed_are_left_alone(world) -> None:
    handles = [add(world, (x, 0.0, HEIGHT / 2)) for x in (0.0, 1.0)]
    first, second = ids(handles)
    with attach(world, bodies=[first]) as extension:
        extension.adopt()
        run(world, extension, 1.0)
        assert list(extension.frozen) == [first]
        extension.add([second])
        run(world, extension, 1.0)
        assert list(extension.frozen) == [first, second]
        extension.remove([first])
        assert [view(world, handle).is_fixed for handle in handles] == [False, True]


def test_a_body_that_rapier_has_put_to_sleep_freezes(world) -> None:
    (handle,) = tower(world, 1)
    with attach(world) as extension:
        extension.update(STEP_S)
        extension.disturb(ids([handle]))
        run(world, extension, 4.0)
        assert view(world, handle).is_sleeping
        extension.release(ids([handle]))
        run(world, extension, 1.0)
        assert list(extension.frozen) == ids([handle]), extension.why(id_of(handle))


@pytest.mark.parametrize(
    ("rule", "coefficient"),
    [
        ("AVERAGE", 0.5),
        ("MIN", 0.2),
        ("MULTIPLY", 0.16),
        ("MAX", 0.8),
        ("CLAMPED_SUM", 1.0),
        ("GEOMETRIC_MEAN", 0.4),
    ],
)
def test_friction_is_combined_by_rapiers_rule(rule: str, coefficient: float) -> None:
    from stability_core.ports.rapier_calls import friction_of

    rules = rapier3d.CoefficientCombineRule
    first = rapier3d.Collider.ball(0.1).friction(0.2).friction_combine_rule(getattr(rules, rule)).build()
    second = rapier3d.Collider.ball(0.1).friction(0.8).friction_combine_rule(rules.AVERAGE).build()
    assert friction_of(first, second) == friction_of(second, first) == pytest.approx(coefficient)


def trajectory(*, is_attached: bool, is_multibody: bool) -> np.ndarray:
    """Poses and velocities of a driven arm, of a pendulum on a joint, and of two falling boxes."""
    world = open_world()
    _, link, _ = arm(world, is_multibody=is_multibody)
    view(world, link).angvel = (0.0, 1.0, 0.0)
    swing, *boxes = (add(world, (x, 0.0, 3.0)) for x in (0.0, 1.0, 2.0))
    pivot = world.add_body(rapier3d.RigidBody.fixed().translation((0.0, 0.0, 3.2)))
    joint = rapier3d.SphericalJoint.builder().local_anchor1((0.0, 0.0, 0.0)).local_anchor2((0.0, 0.0, 0.2))
    world.impulse_joints.insert(pivot, swing, joint.build())
    view(world, swing).linvel = (1.0, 0.0, 0.0)
    extension = attach(world) if is_attached else None
    rows = []
    for _ in range(60):
        world.step()
        if extension:
            extension.update(STEP_S)
            assert not len(extension.frozen)
        bodies = [view(world, handle) for handle in (link, swing, *boxes)]
        rows.append(
            [
                number
                for body in bodies
                for part in (body.translation, body.rotation, body.linvel, body.angvel)
                for number in part.to_tuple()
            ]
        )
    if extension:
        extension.close()
    return np.array(rows)


@pytest.mark.parametrize("is_multibody", [False, True])
def test_arm_and_joint_keep_their_trajectories_to_the_bit_while_nothing_is_frozen(is_multibody: bool) -> None:
    np.testing.assert_array_equal(
        trajectory(is_attached=True, is_multibody=is_multibody),
        trajectory(is_attached=False, is_multibody=is_multibody),
    )


def test_rapier_skips_frozen_bodies_once_nothing_is_live_and_they_keep_their_places_to_the_bit(world) -> None:
    handles = [*tower(world, 4), add(world, (1.0, 0.0, HEIGHT / 2), turn=(0.0, 0.0, 0.6, 0.8))]
    with attach(world) as extension:
        extension.adopt()
        before = places(world, handles)
        for _ in range(100):
            run(world, extension, STEP_S)
            assert places(world, handles) == before
        assert not world.active_bodies()
        assert all(view(world, handle).is_fixed for handle in handles)
        world.remove_body(handles[0])
        run(world, extension, 1.0)
        assert height(world, handles[1]) == pytest.approx(HEIGHT / 2, abs=1e-3)
