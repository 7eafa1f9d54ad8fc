"""A brick whose support is taken drops; a stack that moves into what still lies below it sinks."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import measure
from bench.trial import run_trial as trials
from bench.trial.builder import Builder
from bench.trial.measure import Plan
from bench.trial.support import drop_heights
from scenarios.model import Brick, Expectation, Place, Pull, Remove, Scene, World

EDGE = 0.2
"""Edge [m] of the cubes."""


def cube(x: float, level: int) -> Brick:
    return Brick((EDGE, EDGE, EDGE), 1.0, (x, 0.0, (level - 0.5) * EDGE), level=level)


def on_shim(thickness: float) -> tuple[Brick, Brick]:
    shim = Brick((EDGE, EDGE, thickness), 1.0, (0.0, 0.0, thickness / 2))
    return shim, Brick((EDGE, EDGE, EDGE), 1.0, (0.0, 0.0, thickness + EDGE / 2), level=2)


def scene_of(*actions: Place | Remove | Pull) -> Scene:
    return Scene("test", "test", {}, World(), actions, Expectation("fall", "", 2), "", watch_s=2.0)


def kind_after_fall(builder: Builder, simulation, body: int, fall: float) -> str | None:
    """What the builder's plan says of a brick that moved straight down by ``fall`` [m]."""
    (x, y, z), quaternion = simulation.pose[body]
    simulation.move(body, (x, y, z - fall), quaternion)
    _, position, quaternions = simulation.poses()
    return measure.faults(builder.plan, position, quaternions).kind


@pytest.mark.parametrize(("fall", "kind"), [(0.09, None), (0.11, "drop")])
def test_a_cube_drops_by_half_its_thickness_when_its_support_is_taken(fake_engine, fall: float, kind) -> None:
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0, (cube(0, 1),)), Place(1, (cube(0, 2),)), Remove(2, 0)), simulation)
    for time in (0.0, 1.0, 2.0):
        builder.act(time)
    assert kind_after_fall(builder, simulation, 1, fall) == kind


def test_a_cube_that_sinks_into_its_support_has_not_dropped(fake_engine) -> None:
    """By half an edge, by an edge and more, and right through the cube below: none is a fall through free space."""
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0, (cube(0, 1),)), Place(1, (cube(0, 2),))), simulation)
    for time in (0.0, 1.0):
        builder.act(time)
    steps = (0.11, 0.11, 0.11, 0.11)  # 0.44 m in all: the cube leaves the one below it, and ends in the ground
    assert [kind_after_fall(builder, simulation, 1, step) for step in steps] == ["sink"] * 4


def test_a_thin_support_leaves_little_room_to_drop() -> None:
    """Over a shim of a quarter of its thickness a cube has dropped when it fell by half of the shim's."""
    shim, upper = on_shim(EDGE / 4)
    plan = Plan.of([upper])
    assert drop_heights(plan, plan.position, shim) == pytest.approx([upper.position[2] - EDGE / 8])


def test_only_the_brick_that_rested_on_the_taken_one_drops() -> None:
    """Of two columns of three the first loses its foot: its second cube drops, the others keep what carries them."""
    bricks = [cube(x, level) for level in (1, 2, 3) for x in (0.0, 2 * EDGE)]
    rest = Plan.of(bricks[1:])
    heights = drop_heights(rest, rest.position, bricks[0])
    assert heights == pytest.approx([-np.inf, EDGE, -np.inf, -np.inf, -np.inf])
    fallen = rest.position.copy()
    fallen[[1, 3], 2] -= 0.6 * EDGE
    faults = measure.faults(replace(rest, drop_below=heights), fallen, rest.quaternion)
    assert faults.kind == "drop"
    assert faults.drop.tolist() == [False, True, False, False, False]


def test_a_brick_that_another_still_carries_keeps_its_support() -> None:
    """A lintel on two cubes, one of which is taken, turns over the other: it has no room straight below."""
    left, right = cube(-0.3, 1), cube(0.3, 1)
    lintel = Brick((0.8, 0.2, 0.05), 1.0, (0.0, 0.0, EDGE + 0.025), level=2)
    plan = Plan.of([right, lintel])
    assert np.isneginf(drop_heights(plan, plan.position, left)).all()


def test_unevenness_of_placement_is_no_room_to_drop() -> None:
    """The taken cube was planned 1 mm higher than the one beside it, which carries the lintel now."""
    high, low = cube(-0.3, 1), cube(0.3, 1)
    lintel = Brick((0.8, 0.2, 0.05), 1.0, (0.0, 0.0, EDGE + 0.025 + 1e-3), level=2)
    high = Brick(high.size, 1.0, (-0.3, 0.0, EDGE / 2 + 1e-3))
    plan = Plan.of([low, lintel])
    assert np.isneginf(drop_heights(plan, plan.position, high)).all()


def test_a_brick_drops_once_the_hand_has_pulled_its_support_from_under_it(fake_engine) -> None:
    """As long as the pulled cube lies under the upper one, the upper one can only sink into it."""
    simulation = fake_engine()
    actions = (Place(0, (cube(0, 1),)), Place(1, (cube(0, 2),)), Pull(2, 0, (0.1, 0.0), 9.0))
    builder = Builder(scene_of(*actions), simulation)
    for time in (0.0, 1.0, 2.0):
        builder.act(time)
    heights = []
    for x in (0.9 * EDGE, 1.1 * EDGE):
        simulation.move(0, (x, 0.0, EDGE / 2), (1, 0, 0, 0))
        builder.act(3.0)
        heights.append(builder.plan.drop_below.tolist())
    assert heights[0] == [-math.inf, -math.inf]
    assert heights[1][0] == -math.inf  # the pulled cube is in its place wherever it is
    assert heights[1][1] == pytest.approx(simulation.pose[1][0][2] - EDGE / 2)


@pytest.mark.parametrize(("fall", "kind"), [(0.9, "sink"), (1.1, "drop")])
def test_a_brick_lower_by_more_than_its_thickness_and_inside_nothing_has_dropped(fall: float, kind: str) -> None:
    """A slab that two walls held up stands between them, upright and within its thickness of its place."""
    thickness = 0.05
    slab = Brick((0.4, 0.4, thickness), 1.0, (0.0, 0.0, EDGE + thickness / 2), level=2)
    plan = Plan.of([cube(-0.2, 1), cube(0.2, 1), slab])
    position = plan.position.copy()
    position[0, 0], position[1, 0] = -0.31, 0.31  # each moved by less than its thickness
    position[2, 2] -= fall * thickness
    assert measure.faults(plan, position, plan.quaternion).kind == kind


OWN_SCENE = """
friction = 0.5

[[brick]]
size = [0.2, 0.2, {support}]
position = [0.0, 0.0, {half}]
mass = 1.0
time = 0.0
removed = 3.0

[[brick]]
size = [0.2, 0.2, 0.2]
position = [0.0, 0.0, {upper}]
mass = 1.0
time = 1.0
"""


@pytest.mark.parametrize("support", [0.2, 0.05], ids=["cube", "shim"])
@pytest.mark.parametrize("engine", ["bullet", "mujoco", "dart", "physx", "rapier", "box3d", "jolt", "havok", "ode"])
def test_every_engine_drops_a_cube_whose_support_is_taken(tmp_path, engine: str, support: float) -> None:
    file = tmp_path / "undermined.toml"
    file.write_text(OWN_SCENE.format(support=support, half=support / 2, upper=support + 0.1))
    one = Trial(engine, "game", "own_scene", "undermined", {"file": str(file)}, "none", 0, 0)
    record = trials.run_trial(one, Limits(trial_wall_s=600), "abc", lambda _: None).record
    assert record.expectation.outcome == "fall"
    assert (record.status, record.collapse_kind, record.collapse_level) == ("collapsed", "drop", 2)
    assert record.verdict == "right"
