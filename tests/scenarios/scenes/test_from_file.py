"""A scene of one's own: a file of bricks, checked, and judged by exact statics."""

import math
from pathlib import Path

import pytest

from bench.studies.schema import StudyError, load_study
from bench.studies.selection import Selection, selected
from scenarios.model import CLEARANCE, Place, Pull, Push, Remove
from scenarios.registry import build
from scenarios.scenes.from_file import EXAMPLES
from scenarios.statics.falling import fall_time

PLANK = {"size": [0.12, 0.02, 0.01], "position": [0.0, 0.0, 0.005], "mass": 0.01, "time": 0.0}


def plank(**changed):
    return {name: value for name, value in {**PLANK, **changed}.items() if value is not None}


def table(name: str, fields: dict) -> str:
    return "\n".join([f"[[{name}]]", *(f"{field} = {value}" for field, value in fields.items())])


@pytest.fixture
def write(tmp_path):
    """Writes bricks into a file, one table each; returns its name."""

    def to_file(*bricks, head: str = "", name: str = "mine.toml", fixed=()) -> str:
        tables = [table("brick", fields) for fields in bricks] + [table("fixed", fields) for fields in fixed]
        path = tmp_path / name
        path.write_text("\n".join([head, *tables]), encoding="utf-8")
        return str(path)

    return to_file


def leaning(write, levels: int, offset: float = 0.12 / 4.5) -> str:
    bricks = [plank(position=[k * offset, 0.0, 0.005 + 0.01 * k], time=float(k)) for k in range(levels)]
    return write(*bricks, name=f"tower{levels}.toml")


def test_its_truth_is_that_of_exact_statics(write):
    """Planks shifted by L / 4.5 each: four stand, the fifth falls (n d > L)."""
    four, five = (build("own_scene", file=leaning(write, levels)) for levels in (4, 5))
    assert (four.expectation.outcome, five.expectation.outcome) == ("stand", "fall")
    assert five.expectation.level == five.levels == 5
    assert five.expectation.not_before_s == 0.0
    assert four.planar


def test_what_is_undermined_falls_when_its_support_is_taken():
    """The example: without its counterweight the load's moment is 1.7 times the lintel's."""
    scene = build("own_scene")
    assert [brick.level for brick in scene.bricks] == [1, 1, 2, 3, 3]
    assert scene.expectation.outcome == "fall"
    assert scene.expectation.not_before_s == 6.0
    assert [type(action) for action in scene.actions] == [Place] * 5 + [Remove]


def test_bricks_of_one_time_come_together_and_in_the_order_of_time(write):
    far = plank(position=[0.5, 0.0, 0.005], time=2.0)
    upper = plank(position=[0.0, 0.0, 0.015], time=2.0)
    scene = build("own_scene", file=write(upper, far, plank()))
    assert [len(action.bricks) for action in scene.actions] == [1, 2]
    assert [brick.level for brick in scene.bricks] == [1, 2, 1]


def test_a_hair_is_no_gap_and_no_overlap(write):
    """0.1 mm of rounding either way: the brick is planned where it touches."""
    for error in (1e-4, -1e-4):
        scene = build("own_scene", file=write(plank(), plank(position=[0.01, 0.0, 0.015 + error], time=1.0)))
        assert scene.bricks[1].position[2] == pytest.approx(0.015, abs=1e-12)
        assert scene.expectation.outcome == "stand"


def test_a_changed_file_is_another_scene(write):
    first = build("own_scene", file=write(plank())).variant
    again = build("own_scene", file=write(plank())).variant
    other = build("own_scene", file=write(plank(mass=0.02))).variant
    assert first == again != other
    assert first.startswith("own_scene-mine-")


TABLE = {"size": [0.1, 0.1, 0.1], "position": [0.0, 0.0, 0.05]}


def test_a_fixed_box_carries_and_is_no_brick(write):
    """A plank whose centre is 6 mm beyond the table's edge falls, one 6 mm inside stands."""
    outside, inside = (
        build("own_scene", file=write(plank(position=[x, 0.0, 0.105]), fixed=[TABLE], name=name))
        for x, name in ((0.056, "out.toml"), (0.044, "in.toml"))
    )
    assert (outside.expectation.outcome, inside.expectation.outcome) == ("fall", "stand")
    assert [brick.level for brick in inside.bricks] == [1]
    assert [box.position for box in inside.world.fixed] == [(0.0, 0.0, 0.05)]


def test_a_brick_between_fixed_walls_is_put_on_its_prop(write):
    """Walls that it touches carry nothing: 0.1 mm above its prop it is lowered by that."""
    walls = [{"size": [0.1, 0.1, 0.1], "position": [side * 0.11, 0.0, 0.05]} for side in (-1, 1)]
    scene = build("own_scene", file=write(plank(), plank(position=[0, 0, 0.0151], time=1.0), fixed=walls))
    assert scene.bricks[1].position[2] == pytest.approx(0.015, abs=1e-12)


def test_a_scene_with_a_turned_fixed_box_is_not_planar(write):
    file = write(plank(position=[0.0, 0.0, 0.105]), fixed=[{**TABLE, "yaw": 30.0}])
    assert not build("own_scene", file=file).planar


@pytest.mark.parametrize(
    ("brick", "fixed", "message"),
    [
        (plank(), {**TABLE, "mass": 1.0}, r"unknown field of fixed\[0\] 'mass'"),
        (plank(), {"size": [0.1, 0.1, 0.1]}, r"fixed\[0\].position is missing: add a list of 3 numbers"),
        (
            plank(position=[0, 0, 0.125]),
            TABLE,
            r"brick\[0\] must touch .* is 20.000 mm above .* set position z of brick\[0\] to 0.105",
        ),
        (plank(position=[0, 0, 0.095]), TABLE, r"brick\[0\] and fixed body 0 .from 0.: .* must not overlap"),
    ],
)
def test_a_fixed_box_that_makes_no_scene_is_reported_with_the_fix(write, brick, fixed, message):
    with pytest.raises(ValueError, match=message):
        build("own_scene", file=write(brick, fixed=[fixed]))


@pytest.mark.parametrize(
    ("bricks", "message"),
    [
        ([], r"the file must contain 1 to 5000 tables \[\[brick\]\]"),
        ([plank(position=[0, 0, 0.015])], r"brick\[0\] must touch .* but is 10.000 mm above the nearest body"),
        (
            [plank(), plank(position=[0, 0, 0.025], time=1.0)],
            r"brick\[1\] must touch .* set position z of brick\[1\] to 0.015",
        ),
        ([plank(position=[0, 0, 0.015]), plank(time=1.0)], r"brick\[0\] must touch .* place its support earlier"),
        ([plank(), plank(position=[0.06, 0, 0.005], time=1.0)], "overlap"),
        ([plank(position=[0, 0, 0.0])], "ground"),
        ([plank(mass=None)], r"brick\[0\].mass is missing"),
        ([plank(mass=-1)], r"brick\[0\].mass must be a number from"),
        ([plank(mass="nan")], r"brick\[0\].mass must be a number from"),
        ([plank(size=[0.1, 0.1])], r"brick\[0\].size must be a list of 3 numbers"),
        ([plank(yaw=0, quaternion=[1, 0, 0, 0])], r"brick\[0\] must have yaw or quaternion, got both"),
        ([plank(quaternion=[1, 1, 0, 0])], r"brick\[0\].quaternion must be of unit length, got the length 1.41"),
        ([plank(weight=1)], r"unknown field of brick\[0\] 'weight'"),
        (
            [plank(time=2.0, removed=1.0)],
            r"brick\[0\].removed must be later than brick\[0\].time, which is 2 s, got 1 s: give a later time",
        ),
    ],
)
def test_what_makes_no_scene_is_reported_with_its_brick_and_the_fix(write, bricks, message):
    with pytest.raises(ValueError, match=message):
        build("own_scene", file=write(*bricks))


def test_a_file_that_is_not_there_names_the_examples():
    with pytest.raises(ValueError, match=r"nowhere.toml: cannot read this file .*lintel.toml"):
        build("own_scene", file="nowhere.toml")


def test_a_file_that_is_no_toml_says_so(write):
    with pytest.raises(ValueError, match="not valid TOML"):
        build("own_scene", file=write(plank(), head="friction = "))


def test_the_command_line_takes_a_file_for_a_scenario(write):
    study = selected(load_study("smoke"), Selection(scenarios=[leaning(write, 4)]))
    assert [chosen.name for chosen in study.scenario] == ["own_scene"]
    with pytest.raises(StudyError, match=r"is 95\.000 mm above the nearest body"):
        selected(load_study("smoke"), Selection(scenarios=[write(plank(position=[0, 0, 0.1]))]))


# -- prebuilt stacks, and the whole larger, heavier or turned ----------------------------------------------------------


def test_bricks_of_one_time_on_several_levels_are_a_prebuilt_stack(write):
    upper = plank(position=[0.0, 0.0, 0.015])
    later = plank(position=[0.0, 0.0, 0.025], time=1.0), plank(position=[0.3, 0.0, 0.005], time=1.0)
    whole = build("own_scene", file=write(upper, plank()))
    assert [(place.height, len(place.bricks)) for place in whole.actions] == [(0.0, 2)]
    single = build("own_scene", file=write(plank(), plank(position=[0.3, 0.0, 0.005]), name="single.toml"))
    assert [(place.height, len(place.bricks)) for place in single.actions] == [(CLEARANCE, 2)]
    mixed = build("own_scene", file=write(upper, plank(), *later, name="mixed.toml"))
    assert [(place.height, [b.level for b in place.bricks]) for place in mixed.actions] == [
        (0.0, [2, 1]),
        (0.0, [3, 1]),
    ]


def test_the_whole_may_be_larger_heavier_and_turned(write):
    tower = leaning(write, 5)
    plain, changed = build("own_scene", file=tower), build("own_scene", file=tower, size=3, mass=7, yaw=90)
    for before, after in zip(plain.bricks, changed.bricks, strict=True):
        x, y, z = before.position
        assert after.position == pytest.approx((-3 * y, 3 * x, 3 * z), abs=1e-12)
        assert after.size == pytest.approx([3 * edge for edge in before.size])
        assert after.mass == pytest.approx(7 * before.mass)
        assert after.quaternion == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    assert {place.height for place in changed.actions} == {3 * CLEARANCE}
    assert (plain.planar, changed.planar) == (True, False)
    assert changed.watch_s == pytest.approx(plain.watch_s * math.sqrt(3))
    assert str(changed.expectation) == str(plain.expectation) == "falls at 5"
    assert changed.variant == f"{plain.variant}-size3-mass7-yaw90"


def test_fixed_boxes_change_with_the_bricks(write):
    file = write(plank(position=[0.044, 0.0, 0.105]), fixed=[TABLE])
    [table] = build("own_scene", file=file, size=2, yaw=180).world.fixed
    assert table.position == pytest.approx((0.0, 0.0, 0.1))
    assert table.size == pytest.approx((0.2, 0.2, 0.2))


def test_defaults_change_neither_the_id_nor_a_brick(write):
    tower = leaning(write, 4)
    assert build("own_scene", file=tower, size=1, mass=1, yaw=0) == build("own_scene", file=tower)
    assert build("own_scene", size=1.0).variant == "own_scene"
    assert build("own_scene", size=2).variant == "own_scene-size2"


@pytest.mark.parametrize(("name", "value"), [("size", 0), ("mass", -1), ("yaw", 400), ("size", float("nan"))])
def test_a_factor_that_makes_no_scene_names_what_is_allowed(name, value):
    with pytest.raises(ValueError, match=f"{name} must be a number from"):
        build("own_scene", **{name: value})


# -- scenes of public bug reports --------------------------------------------------------------------------------------

STAND = "stands"
ISSUES = {
    "atonce10": STAND,
    "box3d_tiny_pyramid": STAND,
    "bullet3_3049": STAND,
    "cannon_es_177": STAND,
    "flax_15_40": STAND,
    "flax_15_60": "falls at 2",
    "genesis_893": STAND,
    "habitat_801": "falls at 2 after 12 s",
    "jolt_1390_100": STAND,
    "mujoco_366_mu0": STAND,
    "pallet": STAND,
    "peel_mass_ratio_100": STAND,
    "peel_mass_ratio_300": STAND,
    "qu3e_54": STAND,
    "slow_tip_0.2": "falls at 1",
}
"""What must happen to each example, by name of its file."""
AT_ONCE = {
    "atonce10", "box3d_tiny_pyramid", "cannon_es_177", "mujoco_366_mu0", "peel_mass_ratio_100", "peel_mass_ratio_300",
    "qu3e_54",
}  # fmt: skip
"""Those that are in place when the simulation starts."""


@pytest.mark.parametrize("changes", [{}, {"size": 3, "mass": 7, "yaw": 13}], ids=["as reported", "changed"])
@pytest.mark.parametrize("name", ISSUES)
def test_exact_statics_says_what_must_happen_to_the_scene_of_a_bug_report(name, changes):
    """Whatever its size, its weight and its direction."""
    scene = build("own_scene", file=f"issue_{name}.toml", **changes)
    pace = math.sqrt(changes.get("size", 1.0))
    assert str(scene.expectation) == ISSUES[name].replace("12 s", f"{12 * pace:g} s")
    assert scene.expectation.not_before_s == pytest.approx(12.0 * pace if name == "habitat_801" else 0.0)
    assert (scene.actions[0].height == 0.0) == (name in AT_ONCE)
    outcome = "Must stand" if ISSUES[name] == STAND or name == "habitat_801" else f"Must {ISSUES[name]}"
    output = (EXAMPLES / f"issue_{name}.toml").read_text(encoding="utf-8").splitlines()[1]
    assert output.startswith(f"# {outcome.replace('falls at', 'fall at level')}")


def test_the_study_plays_all_of_them():
    parameters = [chosen.parameters for chosen in load_study("any_stack").scenario]
    files = sorted(f"issue_{name}.toml" for name in ISSUES)
    assert [one["file"] for one in parameters] == [files, files]
    assert sorted(path.name for path in EXAMPLES.glob("issue_*.toml")) == files
    assert [{k: v for k, v in one.items() if k != "file"} for one in parameters] == [
        {},
        {"size": 3.0, "mass": 7.0, "yaw": 13.0},
    ]


def test_a_fall_takes_the_root_of_its_size_longer_and_is_watched_to_its_end():
    for size in (1, 3):
        post = build("own_scene", file="issue_slow_tip_0.2.toml", size=size)
        assert fall_time(post.bricks, post.world) == pytest.approx(1.24 * math.sqrt(size), rel=0.01)
        assert post.watch_s > 3 * fall_time(post.bricks, post.world)


def test_a_file_says_how_long_it_is_watched(write):
    assert build("own_scene", file=write(plank())).watch_s == 5.0
    minute = write(plank(), head="watch_s = 60.0")
    assert build("own_scene", file=minute).watch_s == 60.0
    assert build("own_scene", file=minute, size=4.0).watch_s == 120.0, "times grow with the root of lengths"
    with pytest.raises(ValueError, match="watch_s"):
        build("own_scene", file=write(plank(), head="watch_s = 0.0"))


def test_a_file_pushes_and_pulls(write):
    """The numbers of bricks are those of the file; with the scene's size, velocities grow as lengths over times."""
    tables = [plank(time=1.0, position=[0.0, 0.0, 0.015]), plank()]
    head = "\n".join(["name = 'my scene'", "gravity = [0.0, 0.5, -9.0]", "friction = 0.3"])
    file = write(*tables, head=head)
    with Path(file).open("a", encoding="utf-8") as stream:
        stream.write("\n".join(["", table("push", {"brick": 0, "time": 3.0, "impulse": [0.01, 0.0, 0.0]})]))
        pull = {"brick": 1, "time": 4.0, "velocity": [0.0, 0.1], "seconds": 2.0, "carried": "true"}
        stream.write("\n".join(["", table("pull", pull)]))
    scene = build("own_scene", file=file)
    assert scene.world.gravity == (0.0, 0.5, -9.0)
    assert scene.variant.startswith("own_scene-my_scene-")
    assert scene.actions[-2:] == (Push(3.0, 1, (0.01, 0.0, 0.0)), Pull(4.0, 0, (0.0, 0.1), 2.0, is_carried=True))
    assert scene.expectation.outcome == "study"
    turned = build("own_scene", file=file, size=4.0, mass=3.0, yaw=90.0)
    assert turned.actions[-2].impulse == pytest.approx((0.0, 3 * 2 * 0.01, 0.0))
    assert turned.actions[-1].velocity == pytest.approx((-0.2, 0.0))
    assert (turned.actions[-1].time, turned.actions[-1].seconds, turned.actions[-1].is_carried) == (8.0, 4.0, True)


def test_a_pull_that_is_carried_by_another_word_than_true_or_false_is_refused(write):
    file = write(plank())
    with Path(file).open("a", encoding="utf-8") as stream:
        pull = {"brick": 0, "time": 4.0, "velocity": [0.0, 0.1], "seconds": 2.0, "carried": 1}
        stream.write("\n" + table("pull", pull))
    with pytest.raises(ValueError, match=r"pull\[0\].carried must be true or false"):
        build("own_scene", file=file)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ({"brick": 3, "time": 1.0, "impulse": [0, 0, 0]}, r"push\[0\].brick must be a number from 0 to 0"),
        (
            {"brick": 0, "time": 0.0, "impulse": [0, 0, 0]},
            r"push\[0\].time must be after brick\[0\].time, which is 0 s, got 0 s: give a time after the placement",
        ),
        ({"brick": 0, "time": 1.0}, r"push\[0\].impulse is missing: add a list of 3 numbers"),
        ({"brick": 0, "time": 1.0, "force": [0, 0, 0]}, r"unknown field of push\[0\] 'force'"),
    ],
)
def test_a_push_that_makes_no_scene_is_reported_with_the_fix(write, action, message):
    file = write(plank())
    with Path(file).open("a", encoding="utf-8") as stream:
        stream.write("\n" + table("push", action))
    with pytest.raises(ValueError, match=message):
        build("own_scene", file=file)


def test_a_file_may_have_more_than_two_hundred_bricks(write):
    scene = build("own_scene", file=write(*(plank(position=[0.2 * k, 0.0, 0.005]) for k in range(201))))
    assert (len(scene.bricks), scene.expectation.outcome) == (201, "study")
    assert "--truth" in scene.expectation.theory
