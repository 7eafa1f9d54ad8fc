"""The decorator of scenes: what a builder declares once is what users see, and what is checked."""

import inspect
import math
from dataclasses import replace
from typing import Annotated

import pytest

from scenarios.model import Expectation, World
from scenarios.parameters import Choice, Gap, Real, Whole
from scenarios.planks import box, lay, one_a_second
from scenarios.registry import SCENARIOS
from scenarios.scenario import Plan, dynamic_scenario, scenario

UNRANGED = {("own_scene", "file")}
"""Parameters that are no numbers and no choice."""
Kind = Annotated[str, Choice("plain", "striped")]


@scenario
def cubes(
    *, count: Annotated[int, Whole(1, 9)] = 2, edge: Annotated[float, Real(0.01, 1)] = 0.1, kind: Kind = "plain"
) -> Plan:
    """Cubes, one on another.

    More about cubes.
    """
    assert isinstance(edge, float)
    tower = [[box((edge, edge, edge), 0.0, level=level, bottom=(level - 1) * edge)] for level in range(1, count + 1)]
    return Plan(
        world=World(friction=0.3),
        actions=one_a_second(tower),
        expectation=Expectation("stand", "cubes"),
        look_for=kind,
        partner={"kind": "plain"},
    )


def test_a_builder_is_a_scenario_of_its_own_name():
    assert (cubes.name, cubes.description) == ("cubes", "Cubes, one on another.")
    assert dict(cubes.defaults) == {"count": 2, "edge": 0.1, "kind": "plain"}
    assert {name: str(allowed) for name, allowed in cubes.ranges.items()} == {
        "count": "1 to 9",
        "edge": "0.01 to 1",
        "kind": "plain, striped",
        "built": "one_by_one, at_once, at_once_below",
        "size": "0.01 to 1000",
    }


def test_the_scene_has_ids_and_parameters_in_their_types():
    scene = cubes(edge=1, count=3.0, kind="striped")
    assert (scene.scenario, scene.variant, scene.pair) == ("cubes", "cubes-3-edge1-kindstriped", "cubes-3-edge1")
    assert list(scene.parameters.items()) == [("count", 3), ("edge", 1.0), ("kind", "striped")]
    assert [type(value) for value in scene.parameters.values()] == [int, float, str]
    assert scene.look_for == "striped"
    assert scene.levels == 3


def test_a_scenario_of_dynamics_has_its_own_parameters_only():
    pushed = dynamic_scenario(cubes.builder)
    assert not pushed.is_static
    assert set(pushed.parameters) == set(pushed.ranges) == {"count", "edge", "kind"}


@pytest.mark.parametrize("value", [0, 10, 1.5, True, "2", None, math.nan, math.inf])
def test_a_whole_number_is_nothing_else(value):
    with pytest.raises(ValueError, match="count must be a whole number from 1 to 9, got"):
        cubes(count=value)


@pytest.mark.parametrize("value", [0.0, 1.01, True, "0.1", None, math.nan, -math.inf])
def test_a_number_lies_in_its_range(value):
    with pytest.raises(ValueError, match=r"edge must be a number from 0.01 to 1, got"):
        cubes(edge=value)


def test_a_choice_is_one_of_its_words():
    with pytest.raises(ValueError, match="kind must be plain or striped, got 'stripy'"):
        cubes(kind="stripy")


def test_a_parameter_that_was_not_declared_is_refused():
    with pytest.raises(TypeError, match="height"):
        cubes(height=1.0)


def test_the_ends_of_a_range_belong_to_it():
    gap = Gap.__metadata__[0]
    assert (gap.check("gap", 0), gap.check("gap", 20)) == (0.0, 20.0)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_parameter_has_a_range_that_holds_its_default_and_is_documented(name):
    one = SCENARIOS[name]
    assert {(name, parameter) for parameter in one.parameters.keys() - one.ranges.keys()} <= UNRANGED
    for parameter, allowed in one.ranges.items():
        default = one.parameters[parameter]
        assert allowed.check(parameter, default) == default
        assert type(allowed.check(parameter, default)) is type(default)
    output = inspect.getdoc(one.builder)
    assert all(f"    {parameter}: " in output for parameter in one.defaults)


@pytest.mark.parametrize(("y", "yaw"), [(0.01, 0.0), (0.0, 90.0)])
def test_a_planar_scene_whose_brick_leaves_the_plane_is_refused(y, yaw):
    @scenario
    def across() -> Plan:
        """A plank."""
        plank = replace(lay(0.0, level=1, yaw=yaw), position=(0.0, y, 0.0039))
        expectation = Expectation("stand", "it lies")
        return Plan(
            world=World(), actions=one_a_second([[plank]]), expectation=expectation, look_for="nothing", planar=True
        )

    with pytest.raises(ValueError, match="leaves the x-z plane: set y = 0 and turn bricks about y only"):
        across()
