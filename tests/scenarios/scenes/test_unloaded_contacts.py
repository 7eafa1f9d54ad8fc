"""Scenes in which sides, walls or a ceiling touch what they do not hold, and scenes of fixed slopes and edges.

Each closed form is worked out again from the bricks as they are built.
"""

import math

import numpy as np
import pytest

from scenarios.geometry import Boxes, overlap_in_plan, room_above_fixed
from scenarios.model import CLEARANCE, Place, Push, Remove
from scenarios.placement_noise import NoRoomError, with_placement_noise
from scenarios.registry import build
from scenarios.statics.contact_patch import GROUND, contact_patches
from scenarios.statics.truth import first_fall
from tests.scenarios.statics.load_bearing import UNLOADED, first_fall_by_load, still

PAIRS = [
    (build("neighbour_side"), build("neighbour_side", margin=-0.15)),
    (build("neighbour_side", margin=0.05), build("neighbour_side", margin=-0.05)),
    (build("character"), build("character", margin=-0.3)),
    (build("prop_between_walls"), build("prop_between_walls", carried="nothing")),
    (build("prop_between_walls", friction=0.01), build("prop_between_walls", friction=0.01, carried="nothing")),
    (build("ceiling"), build("ceiling", taken="lower")),
    (build("ceiling", bricks=5), build("ceiling", bricks=5, taken="lower")),
    (build("seesaw"), build("seesaw", block="beyond")),
    (build("incline", half="lower"), build("incline", half="lower", margin=-0.15)),
    (
        build("robbed_stack", stack="two_blocks", pause=10),
        build("robbed_stack", stack="two_blocks", taken="support", pause=10),
    ),
]
every_pair = pytest.mark.parametrize(("stands", "falls"), PAIRS, ids=[falls.variant for _, falls in PAIRS])


def x_of(brick):
    return brick.position[0]


def span_of(brick):
    """From where to where along x [m] a level box reaches."""
    return x_of(brick) - brick.size[0] / 2, x_of(brick) + brick.size[0] / 2


def floor_of(brick):
    return brick.position[2] - brick.size[2] / 2


def roof_of(brick):
    return brick.position[2] + brick.size[2] / 2


@every_pair
def test_one_side_stands_and_its_mirror_image_falls(stands, falls):
    assert (stands.expectation.outcome, falls.expectation.outcome) == ("stand", "fall")
    assert stands.pair == falls.pair == stands.variant
    judge = first_fall_by_load if falls.scenario in UNLOADED else first_fall
    assert judge(still(stands)) is None
    assert judge(still(falls)) == falls.expectation.level == falls.levels


@every_pair
def test_what_is_undermined_falls_when_the_removal_comes(stands, falls):
    removals = [action.time for action in falls.actions if isinstance(action, Remove)]
    assert falls.expectation.not_before_s == max(removals, default=0.0)


# -- sides that touch ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("margin", [0.15, -0.05, -0.15, -0.25])
def test_a_brick_that_tips_does_not_press_on_the_neighbour_that_it_touches(margin):
    """Turned about the pedestal's edge its inner end moves up, and away from the neighbour at every corner."""
    pedestal, neighbour, brick, counterweight = build("neighbour_side", margin=margin).bricks
    edge = span_of(pedestal)[1]
    assert edge - x_of(brick) == pytest.approx(margin * brick.size[0] / 2)
    assert span_of(neighbour)[1] == pytest.approx(span_of(brick)[0], abs=1e-15)
    assert [floor_of(neighbour), floor_of(brick)] == pytest.approx([roof_of(pedestal)] * 2)
    assert span_of(pedestal)[0] < span_of(neighbour)[0]
    for corner in Boxes.of([brick]).corners[0]:
        if corner[0] < x_of(brick):
            x, z = corner[0] - edge, corner[2] - roof_of(pedestal)
            away, up = z, -x  # of a turn that lowers the outer end
            assert up > 0
            assert away >= -1e-12
    held = (x_of(brick) * brick.mass + x_of(counterweight) * counterweight.mass) / (brick.mass + counterweight.mass)
    assert held < edge - 0.07 * brick.size[0]
    assert span_of(counterweight)[0] > span_of(brick)[0]  # it lies on the brick alone


@pytest.mark.parametrize("margin", [0.3, 0.05, -0.05, -0.3])
def test_the_plank_needs_its_character_once_the_prop_has_gone(margin):
    pedestal, prop, plank, figure = build("character", margin=margin).bricks
    edge = span_of(pedestal)[1]
    assert edge - x_of(plank) == pytest.approx(margin * plank.size[0] / 2)
    assert span_of(prop)[0] > edge
    assert span_of(prop)[1] == pytest.approx(span_of(plank)[1])
    assert [roof_of(prop), floor_of(plank)] == pytest.approx([roof_of(pedestal)] * 2)
    assert span_of(figure)[0] == pytest.approx(span_of(plank)[0])
    inward = plank.mass * (edge - x_of(plank)) + figure.mass * (edge - x_of(figure))
    assert inward > 0.3 * figure.mass * plank.size[0] / 2


def test_a_character_is_never_at_rest_for_long_and_stays_where_it_is():
    """Struck until it leaves, as often to the left as to the right; each blow moves it by v^2 / (2 mu g) = 0.28 mm."""
    scene = build("character", margin=-0.3)
    figure = scene.bricks[3]
    pushes = [action for action in scene.actions if isinstance(action, Push)]
    leaves = scene.expectation.not_before_s
    assert {action.brick for action in pushes} == {3}
    assert sum(action.impulse[0] for action in pushes) == 0
    times = [3.0, *(action.time for action in pushes), leaves]
    assert max(np.diff(times)) <= 0.25
    assert max(action.time for action in pushes) < leaves
    speed = abs(pushes[0].impulse[0]) / figure.mass
    assert speed**2 / (2 * scene.world.friction * 9.81) == pytest.approx(0.283e-3, rel=0.01)
    assert figure.mass == pytest.approx(0.19, abs=0.01)


# -- walls and ceilings ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("carried", ["nothing", "ledges"])
def test_only_ledges_are_below_a_block_between_walls(carried):
    scene = build("prop_between_walls", carried=carried)
    prop, block = scene.bricks
    left, right = scene.world.fixed[:2]
    assert span_of(left)[1] == pytest.approx(span_of(block)[0], abs=1e-15)
    assert span_of(right)[0] == pytest.approx(span_of(block)[1], abs=1e-15)
    assert roof_of(left) > roof_of(block)
    alone = contact_patches([block], scene.world.fixed)
    upward = [patch for patch in alone if patch.normal[2] > 0.5]
    assert len(alone) - len(upward) == 2, "it touches both walls"
    assert len(upward) == (2 if carried == "ledges" else 0)
    assert room_above_fixed(Boxes.of([block]), Boxes.of(scene.world.fixed)) == (
        pytest.approx(0.0, abs=1e-15) if carried == "ledges" else math.inf
    )
    assert floor_of(block) == pytest.approx(3 * block.size[2])
    beside = Boxes.of(scene.world.fixed)
    assert not overlap_in_plan(Boxes.of([prop]), beside).any()


def test_a_block_between_walls_has_no_room_for_placement_noise():
    with pytest.raises(NoRoomError, match="use seed 0"):
        with_placement_noise(build("prop_between_walls"), 1)
    assert with_placement_noise(build("prop_between_walls", gap=1), 1).bricks


@pytest.mark.parametrize("bricks", [2, 3, 6])
def test_a_column_fills_the_room_below_the_ceiling(bricks):
    scene = build("ceiling", bricks=bricks, taken="lower")
    (above,) = scene.world.fixed
    top = scene.bricks[-1]
    assert roof_of(top) == pytest.approx(floor_of(above), abs=1e-15)
    (patch,) = contact_patches([top], scene.world.fixed)
    assert (patch.first, patch.normal.tolist()) == (GROUND, [0, 0, -1]), "the ceiling alone touches it, from above"
    taken = {action.brick for action in scene.actions if isinstance(action, Remove)}
    assert taken == set(range(bricks - 1))
    assert scene.actions[bricks - 1].height == 0.0, "there is no room to drop it"


# -- slopes and edges ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", [10.0, 20.0, 35.0])
def test_both_sides_of_a_groove_press_on_the_bar_alike(tilt):
    """From the normals as they are built: the weight across the groove gives mu_eff = mu / cos(45 deg)."""
    scene = build("groove", tilt=tilt, margin=-0.35)
    (bar,) = scene.bricks
    patches = contact_patches(scene.bricks, scene.world.fixed)
    assert [patch.first for patch in patches] == [GROUND, GROUND]
    along = np.array([math.cos(math.radians(tilt)), 0.0, math.sin(math.radians(tilt))])
    normals = np.array([patch.normal for patch in patches])
    assert normals @ along == pytest.approx([0, 0], abs=1e-12)
    assert normals[0] @ normals[1] == pytest.approx(0, abs=1e-12)
    across = np.array([0.0, 0.0, 1.0]) - along * along[2]
    pressing = np.linalg.solve(np.column_stack([*normals, along]), across)[:2]
    assert pressing[0] == pytest.approx(pressing[1])
    limit = along[2] / pressing.sum()
    wedged = limit / math.hypot(1.0, limit)  # mu N (cos, sin) along and across: their best ratio, tan(45 deg) = 1
    assert scene.world.friction == pytest.approx(0.65 * wedged)
    assert build("groove", tilt=tilt).world.friction == pytest.approx(1.35 * limit)
    for patch in patches:
        corners = (patch.points - bar.position) @ along
        assert np.ptp(corners) == pytest.approx(bar.size[0])
        assert patch.points[:, 2].min() > 0.05


def test_a_bar_slides_far_before_it_leaves_the_groove():
    scene = build("groove", margin=-0.35)
    corners = Boxes.of(scene.world.fixed).corners.reshape(-1, 3)
    assert corners[:, 2].min() > 0, "the groove is above the ground"
    bar = Boxes.of(scene.bricks).corners[0]
    assert bar[:, 0].min() - corners[:, 0].min() > 5 * scene.bricks[0].size[1]


@pytest.mark.parametrize("block", ["between", "beyond"])
def test_the_blocks_moment_about_the_lower_edge_decides(block):
    scene = build("seesaw", block=block)
    plank, load = scene.bricks
    patches = [patch for patch in contact_patches(scene.bricks, scene.world.fixed) if patch.first == GROUND]
    lower, upper = sorted(float(patch.points[:, 0].mean()) for patch in patches)
    assert lower == pytest.approx(0.0, abs=1e-15)
    if block == "beyond":
        assert plank.position[2] > load.position[2] + 5e-3, "the plank's middle is the higher one"
    moment = plank.mass * (x_of(plank) - lower) + load.mass * (x_of(load) - lower)
    total = moment / (plank.mass + load.mass)
    if block == "beyond":
        assert load.mass * (lower - x_of(load)) > 1.3 * plank.mass * (x_of(plank) - lower)
        assert total < lower - 1e-3
    else:
        assert lower + 0.2 * (upper - lower) < total < upper - 0.2 * (upper - lower)
    assert math.tan(math.radians(15)) < 0.7 * scene.world.friction


@pytest.mark.parametrize("half", ["lower", "upper"])
def test_a_tile_lies_on_either_half_of_a_ramp(half):
    _, slab, tile = build("incline", half=half).bricks
    assert (tile.position[2] < slab.position[2]) == (half == "lower")
    foot = Boxes.of([slab]).corners[0][:, 0].min()
    assert Boxes.of([tile]).corners[0][:, 0].min() - foot > 2 * tile.size[2], "room to slide"


def test_nothing_is_below_a_block_whose_support_has_gone():
    lower, upper = build("robbed_stack", stack="two_blocks", taken="support").bricks
    assert floor_of(upper) == pytest.approx(roof_of(lower))
    assert roof_of(lower) == pytest.approx(lower.size[2])
    assert x_of(upper) == x_of(lower)


# -- what a real drop adds -------------------------------------------------------------------------------------------


def test_what_must_stand_outlasts_ten_times_the_energy_of_laying_its_last_bricks():
    """A body of mass M with its centre h above an edge and a beside it takes M g (sqrt(h^2 + a^2) - h) to tip."""

    def least(bricks, edge, height):
        mass = sum(brick.mass for brick in bricks)
        beside = edge - sum(brick.mass * x_of(brick) for brick in bricks) / mass
        above = sum(brick.mass * brick.position[2] for brick in bricks) / mass - height
        return mass * (math.hypot(above, beside) - above)

    def laying(scene):
        last = [action for action in scene.actions if isinstance(action, Place)][-1]
        return CLEARANCE * sum(brick.mass for brick in last.bricks)

    scene = build("neighbour_side", margin=-0.15)
    pedestal, _, *held = scene.bricks
    assert least(held, span_of(pedestal)[1], roof_of(pedestal)) > 10 * laying(scene)
    scene = build("neighbour_side")
    pedestal, _, brick, _ = scene.bricks
    assert least([brick], span_of(pedestal)[1], roof_of(pedestal)) > 10 * brick.mass * CLEARANCE
    scene = build("character", margin=-0.3)
    pedestal, _, *carried = scene.bricks
    assert least(carried, span_of(pedestal)[1], roof_of(pedestal)) > 10 * laying(scene)
    scene = build("prop_between_walls", carried="nothing")
    assert least(scene.bricks, span_of(scene.bricks[0])[1], 0.0) > 10 * laying(scene)
    scene = build("ceiling")
    assert least(scene.bricks, span_of(scene.bricks[0])[1], 0.0) > 10 * laying(scene)
