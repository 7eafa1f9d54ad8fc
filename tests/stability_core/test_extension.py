"""The loop on a scripted world: what freezes, what wakes, when, and why."""

from __future__ import annotations

import math

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, Settings, StabilityExtension
from stability_core.lookup import UnknownNameError
from stability_core.policies.paper import Paper
from tests.stability_core.dwell import CALM_FRAMES, LEAN_FRAMES, LOAD_FRAMES, REST_FRAMES

DT = 1 / 60
SETTINGS = Settings()
WIDE = (-0.05, 0.05)
DEEP = (-0.01, 0.01)
THICKNESS = 0.01
SIZE = math.hypot(0.05, 0.01, 0.005)
"""Of the planks, from the centre to a corner of a face [m]."""
FALL = math.sqrt(9.81 * SIZE)
"""Their unit of speed [m/s]."""


def column(port, n: int, offset: float = 0.0, first: int = 0) -> None:
    """Planks of 100 x 20 x 10 mm straight above each other, each ``offset`` further along x."""
    for body in range(first, first + n):
        z = body * THICKNESS
        port.add(body, (body * offset, 0.0, z + THICKNESS / 2))
        low = WIDE[0] + body * offset
        port.lay(body, body - 1 if body else GROUND, (low, low + 0.1 - (offset if body else 0)), DEEP, z)


def run(extension, frames: int) -> list:
    return [extension.update(DT) for _ in range(frames)]


def settle(extension, most: int = 200) -> None:
    """Until nothing has happened for as long as any rule waits."""
    quiet = 0
    for _ in range(most):
        change = extension.update(DT)
        quiet = 0 if change.frozen or change.woken else quiet + 1
        if quiet > CALM_FRAMES + REST_FRAMES:
            return
    pytest.fail(f"still changing after {most} frames")


def test_a_brick_at_rest_is_frozen_after_the_dwell_time_and_not_before(port):
    column(port, 1)
    extension = StabilityExtension(port)
    changes = run(extension, REST_FRAMES + 1)  # the first frame has no speed yet
    assert [change.frozen for change in changes] == [()] * REST_FRAMES + [(0,)]
    assert port.batches == [("sleep", [0])]
    assert changes[-1].reasons == {0: "flat"}


def test_a_brick_that_moves_or_penetrates_waits(port):
    column(port, 1)
    extension = StabilityExtension(port)
    for frame in range(10):
        port.touches[0].separation = -(40 - frame) / 10 * SETTINGS.rest_penetration * SIZE
        extension.update(DT)
    assert not port.frozen
    port.touches[0].separation = 0.0
    for frame in range(10):
        port.center[0] = (0.0, 0.0, 0.005 + 2 * SETTINGS.rest_speed * FALL * DT * (frame % 2))
        extension.update(DT)
    assert not port.frozen
    run(extension, REST_FRAMES + 1)
    assert port.frozen == {0}


def test_a_brick_in_soft_contacts_is_at_rest_however_deep_it_lies(port):
    """Its depth does not change: it does not recover from an impact."""
    column(port, 1)
    port.touches[0].separation = -10 * SETTINGS.rest_penetration * SIZE
    run(StabilityExtension(port), REST_FRAMES + 1)
    assert port.frozen == {0}


def test_a_brick_that_trembles_in_its_place_is_at_rest_after_a_longer_time(port):
    """Each frame it moves by a tenth of a millimetre, faster than the limit, and back again."""
    column(port, 1)
    extension = StabilityExtension(port)
    frozen_at = None
    for frame in range(60):
        port.center[0] = (0.0, 0.0, 0.005 + 1e-4 * (frame % 2))
        if extension.update(DT).frozen:
            frozen_at = frame
    assert frozen_at == round(SETTINGS.still_s / DT)


@pytest.mark.parametrize("hertz", [30, 60, 240, 1000])
def test_the_rule_of_rest_is_the_same_at_every_frame_rate(port, hertz):
    """Ice that slopes by 1 deg: a brick that slides from rest never freezes, not even in the first milliseconds."""
    column(port, 2)
    extension = StabilityExtension(port, policy="at_rest")
    frozen_after = None
    for frame in range(1, hertz):
        time = frame / hertz
        x = 9.81 * math.sin(math.radians(1)) * time**2 / 2
        port.center[1] = (x, 0.0, port.center[1][2])
        change = extension.update(1 / hertz)
        if 0 in change.frozen:
            frozen_after = time
        assert 1 not in change.frozen
    assert frozen_after == pytest.approx(SETTINGS.rest_s + 1 / hertz, abs=1e-9)


def test_a_brick_that_spins_in_place_waits(port):
    """Its centre does not move; its contacts slide."""
    column(port, 1)
    port.touches[0].velocity = (0.0, 7 * SETTINGS.rest_slip * FALL, 0.0)
    run(StabilityExtension(port), 20)
    assert not port.frozen


def test_a_column_freezes_from_the_ground_up_a_level_each_dwell_time(port):
    """Only what touches the stack is a candidate: the next level's dwell begins when the one below is frozen."""
    column(port, 5)
    extension = StabilityExtension(port)
    run(extension, 5 * REST_FRAMES + 1)
    assert port.batches == [("sleep", [body]) for body in range(5)]


def test_what_hangs_over_its_support_is_never_frozen(port):
    port.add(0, (0.06, 0.0, 0.005))
    port.lay(0, GROUND, WIDE, DEEP, 0.0)
    run(StabilityExtension(port), 100)
    assert not port.frozen


@pytest.mark.parametrize(("offset", "levels"), [(0.1 / 8.5, 9), (0.1 / 4.5, 5)])
def test_a_leaning_tower_wakes_at_the_level_of_the_closed_form(port, offset, levels):
    """The first n with n d > L; all that is above the failing plank wakes with it."""
    extension = StabilityExtension(port)
    for body in range(levels):
        column(port, 1, offset, first=body)
        run(extension, REST_FRAMES + 1)
        if body < levels - 1:
            assert port.frozen == set(range(body + 1)), f"{body + 1} levels stand"
    assert port.frozen == {0}
    assert [kind for kind, _ in port.batches] == ["sleep"] * (levels - 1) + ["wake"]


def test_at_rest_keeps_the_impossible_tower(port):
    extension = StabilityExtension(port, "at_rest")
    for body in range(13):
        column(port, 1, 0.1 / 8.5, first=body)
        run(extension, REST_FRAMES + 1)
    assert port.frozen == set(range(13))


def test_a_live_brick_is_a_load_as_soon_as_it_lies_on_the_stack(port):
    """A heavy brick that never comes to rest on a cantilever's end: the cantilever wakes all the same."""
    column(port, 1)
    port.add(1, (0.04, 0.0, 0.015))
    port.lay(1, 0, (-0.01, 0.05), DEEP, 0.01)
    extension = StabilityExtension(port)
    settle(extension)
    assert port.frozen == {0, 1}
    port.add(2, (0.085, 0.0, 0.025), mass=2.0)
    port.lay(2, 1, (0.05, 0.09), DEEP, 0.02, separation=-2 * SETTINGS.rest_penetration * SIZE)
    changes = run(extension, LOAD_FRAMES + 2)
    assert 1 in {body for change in changes for body in change.woken}
    assert "unbalanced" in {reason for change in changes for reason in change.reasons.values()}


def test_a_brick_that_lands_is_no_load_before_it_lies_still(port):
    """It touches the first of its two supports for a frame: alone, that one could not carry it."""
    port.add(0, (-0.04, 0.0, 0.005))
    port.lay(0, GROUND, (-0.05, -0.03), DEEP, 0.0)
    port.add(1, (0.04, 0.0, 0.005))
    port.lay(1, GROUND, (0.03, 0.05), DEEP, 0.0)
    extension = StabilityExtension(port)
    settle(extension)
    port.add(2, (0.0, 0.0, 0.0155))
    port.lay(2, 0, (-0.05, -0.03), DEEP, 0.01)
    changes = run(extension, LOAD_FRAMES - 1)
    port.lay(2, 1, (0.03, 0.05), DEEP, 0.01)
    changes += run(extension, 2 * REST_FRAMES)
    assert not any(change.woken for change in changes)
    assert port.frozen == {0, 1, 2}


def test_points_seen_over_the_dwell_frames_are_united(port):
    """Each frame shows one corner only, as degenerate manifolds do: no single frame would hold the brick."""
    port.add(0, (0.0, 0.0, 0.005))
    extension = StabilityExtension(port)
    corners = [(x, y, 0.0) for x in WIDE for y in DEEP]
    for frame in range(2 * REST_FRAMES + 1):
        port.touches.clear()
        port.touch(0, GROUND, [corners[frame % 4]])
        extension.update(DT)
    assert port.frozen == {0}


def test_points_older_than_the_dwell_time_do_not_count(port):
    """A brick that creeps over an edge slower than the limit leaves no trail of support behind it."""
    port.add(0, (0.0, 0.0, 0.005))
    extension = StabilityExtension(port)
    step = 0.9 * SETTINGS.rest_speed * FALL * DT
    edge = 20 * step
    frozen_at = None
    for frame in range(200):
        x = edge + step * (frame + 1)
        port.center[0] = (x, 0.0, 0.005)
        port.touches.clear()
        port.lay(0, GROUND, (x - 0.05, edge), DEEP, 0.0)
        if extension.update(DT).frozen:
            frozen_at = frame
    assert frozen_at is None


def test_side_faces_are_no_support(port):
    """Two walls left and right of a falling brick: the hull of their contacts contains its centre."""
    port.add(0, (0.0, 0.0, 0.5))
    port.touch(0, GROUND, [(-0.05, y, 0.5) for y in DEEP], normal=(1.0, 0.0, 0.0))
    port.touch(0, GROUND, [(0.05, y, 0.5) for y in DEEP], normal=(-1.0, 0.0, 0.0))
    run(StabilityExtension(port), 100)
    assert not port.frozen


def leaning_pair(port, theta: float = 72.0, friction: float = 0.45) -> None:
    """An inverted V of two thin planks, 0.1 m long, with a horizontal normal at its ridge."""
    half, height = 0.1 * np.cos(np.radians(theta)), 0.1 * np.sin(np.radians(theta))
    for body, side in ((0, -1.0), (1, 1.0)):
        port.add(body, (side * half / 2, 0.0, height / 2))
        port.touch(body, GROUND, [(side * half, y, 0.0) for y in DEEP], friction=friction)
    ridge = [(0.0, y, height) for y in DEEP]
    port.touch(1, 0, ridge, normal=(1.0, 0.0, 0.0), friction=friction)


def test_an_inverted_v_is_tested_and_frozen_as_one(port):
    leaning_pair(port)
    extension = StabilityExtension(port)
    changes = run(extension, LEAN_FRAMES + 1)
    assert port.batches == [("sleep", [0, 1])]
    assert changes[-1].reasons == {0: "leaning", 1: "leaning"}
    assert not any(change.woken for change in run(extension, 30))


def test_half_a_v_is_not_frozen(port):
    """The partner is held by the user: the plank that leans on it must wait."""
    leaning_pair(port)
    extension = StabilityExtension(port)
    extension.update(DT)
    extension.disturb([1])
    run(extension, 60)
    assert not port.frozen
    extension.release([1])
    run(extension, LEAN_FRAMES)
    assert port.frozen == {0, 1}


def test_a_v_without_friction_is_not_frozen(port):
    leaning_pair(port, friction=0.1)
    run(StabilityExtension(port), 60)
    assert not port.frozen


def test_a_v_whose_partner_is_removed_wakes(port):
    leaning_pair(port)
    extension = StabilityExtension(port)
    settle(extension)
    port.remove(1)
    assert extension.update(DT).woken == (0,)


def test_the_leaning_rule_is_not_tried_on_what_lies_flat(port):
    """A flat overhanging brick that touches a wall: the paper's friction rule would hold it."""
    port.add(0, (0.06, 0.0, 0.005))
    port.lay(0, GROUND, WIDE, DEEP, 0.0)
    port.touch(0, GROUND, [(0.11, y, 0.005) for y in DEEP], normal=(-1.0, 0.0, 0.0))
    run(StabilityExtension(port), 100)
    assert not port.frozen


def test_three_leaning_contacts_are_too_many(port):
    leaning_pair(port)
    port.touch(0, GROUND, [(-0.02, y, 0.05) for y in DEEP], normal=(-1.0, 0.0, 0.0))
    run(StabilityExtension(port), 60)
    assert not port.frozen


@pytest.mark.parametrize(("speed", "woken"), [(0.9, ()), (1.1, (0, 1))])
def test_only_a_fast_impact_wakes_a_frozen_brick_and_all_above_it(port, speed, woken):
    column(port, 2)
    extension = StabilityExtension(port)
    settle(extension)
    port.add(9, (0.2, 0.0, 0.02))
    velocity = (0.0, 0.0, -speed * SETTINGS.impact_speed * FALL)
    port.touch(0, 9, [(0.05, y, 0.01) for y in DEEP], velocity=velocity)
    change = extension.update(DT)
    assert change.woken == woken
    assert set(change.reasons.values()) <= {"struck", "rested on what was struck"}


def test_an_impact_is_no_support(port):
    column(port, 1)
    port.touches[0].velocity = (0.0, 0.0, -1.1 * SETTINGS.impact_speed * FALL)
    run(StabilityExtension(port), 50)
    assert not port.frozen


def test_unknown_separation_and_velocity_count_as_touch_and_slow(port):
    column(port, 1)
    port.touches[0].velocity, port.touches[0].separation = (np.nan,) * 3, np.nan
    run(StabilityExtension(port), REST_FRAMES + 1)
    assert port.frozen == {0}


def test_a_contact_across_a_gap_carries_nothing(port):
    column(port, 1)
    port.touches[0].separation = 2 * SETTINGS.contact_gap * SIZE
    run(StabilityExtension(port), 50)
    assert not port.frozen


def test_a_woken_brick_waits_until_it_moved_or_was_calm_for_long(port):
    column(port, 1)
    extension = StabilityExtension(port)
    settle(extension)
    extension.disturb([0])
    assert extension.update(DT).woken == (0,)
    extension.release([0])
    changes = run(extension, CALM_FRAMES - 1)
    assert not any(change.frozen for change in changes), "it may be at the start of a collapse"
    run(extension, REST_FRAMES + 1)
    assert port.frozen == {0}

    extension.disturb([0])
    extension.update(DT)
    extension.release([0])
    port.center[0] = (2 * SETTINGS.moving_speed * FALL * DT, 0.0, 0.005)
    run(extension, REST_FRAMES + 1)
    assert port.frozen == {0}, "seen moving and come to rest again"


def test_removing_a_support_wakes_what_no_longer_balances_and_only_that(port):
    column(port, 3)
    port.add(7, (1.0, 0.0, 0.005))
    port.lay(7, GROUND, (0.95, 1.05), DEEP, 0.0)
    extension = StabilityExtension(port)
    settle(extension)
    port.remove(1)
    change = extension.update(DT)
    assert change.woken == (2,)
    assert port.frozen == {0, 7}


def test_a_removed_load_can_upset_a_counterweighted_cantilever(port):
    column(port, 1)
    port.add(1, (0.055, 0.0, 0.015))  # over the edge of brick 0 at x = 0.05
    port.lay(1, 0, (0.005, 0.05), DEEP, 0.01)
    port.add(2, (0.03, 0.0, 0.025))
    port.lay(2, 1, (0.01, 0.05), DEEP, 0.02)
    port.touches.reverse()
    extension = StabilityExtension(port)
    settle(extension)
    assert port.frozen == {0, 1, 2}
    port.remove(2)
    assert extension.update(DT).woken == (1,)


def test_what_a_user_holds_stays_live_and_its_load_is_looked_at_again(port):
    """Two pillars carry a plank; one is pulled out."""
    for body, x in ((0, -0.04), (1, 0.04)):
        port.add(body, (x, 0.0, 0.005))
        port.lay(body, GROUND, (x - 0.01, x + 0.01), DEEP, 0.0)
        port.lay(2, body, (x - 0.01, x + 0.01), DEEP, 0.01)
    port.add(2, (0.0, 0.0, 0.015))
    extension = StabilityExtension(port)
    settle(extension)
    assert port.frozen == {0, 1, 2}
    extension.disturb([1])
    change = extension.update(DT)
    assert change.woken == (1, 2)
    run(extension, 100)
    assert 1 not in port.frozen


def test_a_brick_in_a_users_hand_is_no_load(port):
    """Held still on a cantilever's end that could not carry it: the user holds it."""
    column(port, 1)
    port.add(1, (0.04, 0.0, 0.015))
    port.lay(1, 0, (-0.01, 0.05), DEEP, 0.01)
    extension = StabilityExtension(port)
    settle(extension)
    port.add(2, (0.085, 0.0, 0.025), mass=2.0)
    port.lay(2, 1, (0.05, 0.09), DEEP, 0.02)
    extension.update(DT)
    extension.disturb([2])
    assert not any(change.woken for change in run(extension, 30))
    extension.release([2])
    assert any(1 in change.woken for change in run(extension, LOAD_FRAMES + 1))


def test_a_quiet_frame_changes_nothing_and_calls_nothing(port):
    column(port, 3)
    extension = StabilityExtension(port)
    settle(extension)
    port.batches.clear()
    assert all(not change.reasons for change in run(extension, 50))
    assert port.batches == []


def test_many_bodies_and_large_gaps_in_ids(port):
    for body in range(0, 3000, 300):
        port.add(body, (float(body), 0.0, 0.005))
        port.lay(body, GROUND, (body - 0.05, body + 0.05), DEEP, 0.0)
    run(StabilityExtension(port), REST_FRAMES + 1)
    assert port.frozen == set(range(0, 3000, 300))


def test_frames_in_which_nothing_is_live_are_frames_without_contacts(port):
    """Removed bodies are skipped, but a body that wakes after them is not judged by its former contacts."""
    seen = []

    class Seeing(Paper):
        def settle(self, graph, watch):
            seen.append(watch.sizes.sum())
            return super().settle(graph, watch)

    column(port, 2)
    extension = StabilityExtension(port, Seeing(9.81, SETTINGS))
    settle(extension)
    assert port.frozen == {0, 1}
    extension.disturb([1])
    extension.update(DT)
    assert seen[-1] == 0
    extension.release([1])
    run(extension, LOAD_FRAMES)
    assert seen[-1] <= LOAD_FRAMES * len(port.contacts()), "those of the frames since it woke"


def test_unknown_policy_names_the_nearest():
    with pytest.raises(
        UnknownNameError, match=r"unknown policy 'papr'; did you mean 'paper'\? Use one of: paper, at_rest"
    ):
        StabilityExtension(None, "papr")  # type: ignore[arg-type]


@pytest.mark.parametrize("dt", [0.0, -1.0, np.nan, np.inf])
def test_time_must_pass(port, dt):
    with pytest.raises(ValueError, match="dt must be positive"):
        StabilityExtension(port).update(dt)


def test_unknown_bodies_cannot_be_held(port):
    with pytest.raises(KeyError, match="unknown body 5"):
        StabilityExtension(port).disturb([5])


def one_contact(**changed) -> Contacts:
    fields = {
        "body_a": np.array([GROUND]),
        "body_b": np.array([0]),
        "point": np.zeros((1, 3)),
        "normal": np.array([[0.0, 0.0, 1.0]]),
        "separation": np.zeros(1),
        "relative_velocity": np.zeros((1, 3)),
        "friction": np.array([0.45]),
    }
    return Contacts(**(fields | changed))


def one_mass(**changed) -> Masses:
    fields = {"body": np.array([0]), "mass": np.array([1.0]), "center_of_mass": np.zeros((1, 3))}
    return Masses(**(fields | changed))


@pytest.mark.parametrize(
    ("contacts", "masses", "message"),
    [
        (one_contact(point=np.full((1, 3), np.nan)), one_mass(), "finite point"),
        (one_contact(normal=np.zeros((1, 3))), one_mass(), "unit normal"),
        (one_contact(friction=np.array([-0.1])), one_mass(), "friction of at least 0"),
        (one_contact(body_a=np.array([0])), one_mass(), "two different ids"),
        (one_contact(body_b=np.array([-2])), one_mass(), "two different ids"),
        (one_contact(body_b=np.array([3])), one_mass(), "never listed"),
        (one_contact(body_b=np.array([2**40])), one_mass(), "never listed"),
        (one_contact(friction=np.zeros(2)), one_mass(), r"shape \(1,\)"),
        (one_contact(point=np.zeros((1, 2))), one_mass(), r"shape \(1, 3\)"),
        (one_contact(point=np.zeros(3)), one_mass(), r"shape \(1, 3\)"),
        (one_contact(friction=np.zeros((1, 1))), one_mass(), r"shape \(1,\)"),
        (one_contact(), one_mass(mass=np.array([0.0])), "positive mass"),
        (one_contact(), one_mass(center_of_mass=np.full((1, 3), np.inf)), "finite centre"),
        (one_contact(), one_mass(body=np.array([-1])), "id of at least 0"),
        (one_contact(), one_mass(mass=np.ones(2)), r"shape \(1,\)"),
    ],
)
def test_malformed_input_is_refused_with_its_row(port, contacts, masses, message):
    port.contacts, port.masses = lambda: contacts, lambda: masses
    with pytest.raises(ValueError, match=message):
        StabilityExtension(port).update(DT)


def test_a_setting_must_make_sense():
    with pytest.raises(ValueError, match=r"rest_speed must be finite and at least 0, got -1\.0"):
        Settings(rest_speed=-1.0)


def test_any_layout_and_number_type_of_the_ports_arrays_will_do(port):
    """Engines hand out slices, columns and single precision; the kernels are compiled for one layout only."""
    column(port, 1)
    given, weights = port.contacts, port.masses

    def contacts() -> Contacts:
        plain = given()
        return Contacts(
            plain.body_a.astype(np.int32),
            np.repeat(plain.body_b, 2)[::2],
            np.asfortranarray(plain.point),
            np.hstack([plain.normal, plain.normal])[:, :3],
            plain.separation.astype(np.float32),
            np.asfortranarray(plain.relative_velocity),
            np.broadcast_to(np.float64(0.45), len(plain)),
        )

    def masses() -> Masses:
        plain = weights()
        return Masses(plain.body.astype(np.uint16), plain.mass, np.asfortranarray(plain.center_of_mass))

    port.contacts, port.masses = contacts, masses
    run(StabilityExtension(port), REST_FRAMES + 1)
    assert port.frozen == {0}


# -- stacks that are in place from the first --------------------------------------------------------------------------


def test_a_stack_in_place_is_adopted_at_once(port):
    column(port, 10)
    extension = StabilityExtension(port, policy="equilibrium")
    change = extension.adopt()
    assert change.frozen == tuple(range(10))
    assert port.frozen == set(range(10))
    assert run(extension, 100) == [change._replace(frozen=(), woken=(), reasons={})] * 100


@pytest.mark.parametrize("policy", ["equilibrium", "paper"])
def test_of_a_stack_that_cannot_stand_what_moves_stays_live(port, policy):
    """Planks each an eighth further: the ninth tips with all but the lowest."""
    column(port, 10, 0.1 / 8.5)
    extension = StabilityExtension(port, policy=policy)
    change = extension.adopt()
    assert set(change.frozen) <= {0}
    if policy == "equilibrium":
        assert extension.why(9).startswith("touches neither the ground nor a frozen body")


def test_only_the_bodies_that_are_named_are_adopted(port):
    column(port, 3)
    extension = StabilityExtension(port)
    with pytest.raises(KeyError, match="unknown body 7"):
        extension.adopt([7])
    assert extension.adopt([0, 1]).frozen == (0, 1)
    assert extension.adopt([2]).frozen == (2,)


def test_what_moves_is_not_adopted(port):
    column(port, 2)
    port.touches[1].velocity = (0.1, 0.0, 0.0)
    extension = StabilityExtension(port)
    assert extension.adopt().frozen == ()  # they slide on each other
    port.touches[1].velocity = (0.0, 0.0, 0.0)
    extension.update(DT)
    port.center[1] = (1e-3, 0.0, 0.015)
    assert extension.adopt().frozen == (0,)
    extension.disturb([1])
    assert extension.adopt().frozen == ()


@pytest.mark.parametrize("policy", ["at_rest", "pile"])
def test_policies_that_ask_for_rest_alone_adopt_nothing(port, policy):
    column(port, 3)
    assert StabilityExtension(port, policy=policy).adopt().frozen == ()


# -- any size ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", [1e-2, 0.1, 10.0, 1e3])
def test_a_stack_of_any_size_freezes_as_the_plank_does(port, factor):
    """Lengths times ``factor``, speeds times its root: deeper, faster, and judged alike."""
    column(port, 3)
    port.center = {body: tuple(factor * x for x in center) for body, center in port.center.items()}
    for touch in port.touches:
        touch.points = [tuple(factor * x for x in point) for point in touch.points]
        touch.separation = -0.9 * SETTINGS.rest_penetration * SIZE * factor
        touch.velocity = (0.9 * SETTINGS.rest_slip * FALL * math.sqrt(factor), 0.0, 0.0)
    changes = run(StabilityExtension(port), 3 * REST_FRAMES + 1)
    assert [change.frozen for change in changes if change.frozen] == [(0,), (1,), (2,)]


# -- why --------------------------------------------------------------------------------------------------------------


def test_each_reason_for_which_a_body_stays_live_is_reported(port):
    column(port, 2)
    port.add(7, (1.0, 0.0, 1.0))
    extension = StabilityExtension(port, policy="equilibrium")
    with pytest.raises(KeyError, match="unknown body 0"):
        extension.why(0)
    extension.update(DT)
    assert extension.why(7).startswith("touches nothing: the port lists no contact of this body")
    assert extension.why(1).startswith("touches neither the ground nor a frozen body")
    assert extension.why(0) == "listed for the first time as a live body: its speed is not known yet"
    extension.update(DT)
    assert extension.why(0) == "at rest for 0.02 s of 0.1 s"
    port.center[0] = (0.0, 0.0, 0.006)
    extension.update(DT)
    assert extension.why(0) == "moves at 60 mm/s, above 2.8 mm/s; has kept its place for 0.00 s of 0.5 s"
    port.touches[0].velocity = (0.5, 0.0, 0.0)
    extension.update(DT)
    assert (
        extension.why(0) == "slides at a contact at 5e+02 mm/s, above 9.3 mm/s; has kept its place for 0.00 s of 0.5 s"
    )
    port.touches[0].velocity, port.touches[0].separation = (0.0, 0.0, 0.0), -0.5e-3
    extension.update(DT)
    assert extension.why(0).startswith("0.5 mm deep in its support, above 0.17 mm, and still moving there at 30 mm/s")
    extension.disturb([0])
    extension.update(DT)
    assert extension.why(0) == "held by the user: the body may freeze after its release"
    extension.release([0])
    settle(extension)
    assert extension.why(0) == "frozen: safe region"
    extension.disturb([0])
    extension.update(DT)
    extension.release([0])
    extension.update(DT)
    assert extension.why(0).startswith("unfrozen (disturbed) and perhaps at the start of a collapse")


def test_each_refusal_is_reported(port):
    port.add(0, (0.06, 0.0, 0.005))
    port.lay(0, GROUND, (0.0, 0.05), DEEP, 0.0)
    extension = StabilityExtension(port, policy="equilibrium")
    run(extension, 20)
    assert extension.why(0) == "topples: the centre of mass lies outside the contact area"
    port.lay(0, GROUND, (0.0, 0.05), DEEP, 0.0)
    port.touch(0, GROUND, [(0.11, y, 0.0) for y in DEEP], normal=(-1.0, 0.0, 0.0))
    run(extension, 40)
    assert extension.why(0).startswith(
        "in doubt: statics proves neither that the body stands nor that it falls; the body may freeze after it has kept"
    )
    port.touches[-1].friction = 0.01
    run(extension, 40)
    assert extension.why(0) == "falls: no contact forces hold the body in the stack"
    other = StabilityExtension(port, policy="paper")
    run(other, 20)
    assert other.why(0).startswith("at rest, but not frozen: the policy did not find the body stable")
