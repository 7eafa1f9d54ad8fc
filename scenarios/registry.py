"""Scenarios by name. A new scenario needs a file in ``scenarios/scenes`` and an entry in ``SCENARIOS``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

from scenarios.lookup import look_up
from scenarios.model import Scene
from scenarios.parameters import Value
from scenarios.scenario import AT_ONCE, ONE_BY_ONE, Scenario
from scenarios.scenes.asleep import asleep
from scenarios.scenes.ball_pyramid import ball_pyramid
from scenarios.scenes.belt_tower import belt_tower
from scenarios.scenes.branches import branches
from scenarios.scenes.brick_wall import brick_wall
from scenarios.scenes.cantilever import cantilever
from scenarios.scenes.card_house import card_house
from scenarios.scenes.ceiling import ceiling
from scenarios.scenes.character import character
from scenarios.scenes.corbelled_arch import corbelled_arch
from scenarios.scenes.dome_ring import dome_ring
from scenarios.scenes.dominoes import dominoes
from scenarios.scenes.dropped_plank import dropped_plank
from scenarios.scenes.four_stack import four_stack
from scenarios.scenes.from_file import own_scene
from scenarios.scenes.groove import groove
from scenarios.scenes.growing_column import growing_column
from scenarios.scenes.harmonic_overhang import harmonic_overhang
from scenarios.scenes.heavy_top import heavy_top
from scenarios.scenes.incline import incline
from scenarios.scenes.jenga import jenga
from scenarios.scenes.leaning_drums import leaning_drums
from scenarios.scenes.leaning_pair import leaning_pair
from scenarios.scenes.leaning_tower import leaning_tower
from scenarios.scenes.lifted_tower import lifted_tower
from scenarios.scenes.log_cabin import log_cabin
from scenarios.scenes.log_pile import log_pile
from scenarios.scenes.mould import mould
from scenarios.scenes.neighbour_side import neighbour_side
from scenarios.scenes.overhang import overhang
from scenarios.scenes.plank_bridge import plank_bridge
from scenarios.scenes.plank_tower import plank_tower
from scenarios.scenes.poured_pile import poured_pile
from scenarios.scenes.pressed_plank import pressed_plank
from scenarios.scenes.prop_between_walls import prop_between_walls
from scenarios.scenes.pulled_plank import pulled_plank
from scenarios.scenes.pushed_plank import pushed_plank
from scenarios.scenes.pyramid import pyramid
from scenarios.scenes.random_tower import random_tower
from scenarios.scenes.seesaw import seesaw
from scenarios.scenes.shared.prebuilt import at_once, at_once_below
from scenarios.scenes.shared.transforms import resized
from scenarios.scenes.slope import slope
from scenarios.scenes.support_removal import robbed_stack
from scenarios.scenes.table import table
from scenarios.scenes.tilt_test import tilt_test
from scenarios.scenes.tilted_ground import tilted_ground
from scenarios.scenes.tipping_post import tipping_post
from scenarios.scenes.trapdoor import trapdoor
from scenarios.scenes.voussoir_arch import voussoir_arch
from scenarios.scenes.wall_plank import wall_plank

SCENARIOS: Mapping[str, Scenario[...]] = {
    scenario.name: scenario
    for scenario in (
        plank_tower,
        four_stack,
        leaning_tower,
        card_house,
        brick_wall,
        pyramid,
        log_cabin,
        jenga,
        robbed_stack,
        random_tower,
        harmonic_overhang,
        cantilever,
        plank_bridge,
        corbelled_arch,
        table,
        branches,
        wall_plank,
        incline,
        groove,
        seesaw,
        neighbour_side,
        character,
        prop_between_walls,
        ceiling,
        pushed_plank,
        pulled_plank,
        dropped_plank,
        pressed_plank,
        tilted_ground,
        tilt_test,
        lifted_tower,
        belt_tower,
        trapdoor,
        slope,
        overhang,
        leaning_pair,
        tipping_post,
        heavy_top,
        growing_column,
        asleep,
        voussoir_arch,
        dome_ring,
        leaning_drums,
        log_pile,
        ball_pyramid,
        dominoes,
        poured_pile,
        mould,
        own_scene,
    )
}
"""All scenarios by name, in the order in which users see them."""


def build(name: str, **parameters: Value) -> Scene:
    """Return the scene of scenario ``name`` with ``parameters``; missing parameters take their defaults.

    Raises:
        UnknownNameError: if no scenario has the ``name``, or the scenario has no parameter with a given name.
        ValueError: if a parameter's value is not allowed, or the scenario cannot build a scene with these values; the
            message names the scenario and the fix.
    """
    scenario = look_up("scenario", name, SCENARIOS)
    for parameter in parameters:
        look_up(f"parameter of {name}", parameter, scenario.parameters)
    try:
        if not scenario.is_static:
            return scenario(**parameters)
        size = parameters.pop("size", 1.0)
        built = scenario.ranges["built"].check("built", parameters.pop("built", ONE_BY_ONE))
        if built == ONE_BY_ONE:
            scene = scenario(**parameters)
            scene = replace(scene, parameters={**scene.parameters, "built": built})
        else:
            scene = _prebuilt(scenario, built, **parameters)
        return resized(scene, size)
    except ValueError as error:
        raise ValueError(f"scenario {name}: {error}") from error


@lru_cache(maxsize=256, typed=True)
def _prebuilt(scenario: Scenario[...], built: str, **parameters: Value) -> Scene:
    """Return a prebuilt scene.

    A cache keeps the scenes, because the search for the brick to remove solves statics many times.
    """
    scene = scenario(**parameters)
    return at_once(scene) if built == AT_ONCE else at_once_below(scene)


def with_defaults(name: str, parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Return the parameters of an old record, with the defaults of the missing parameters of scenario ``name``.

    The parameters of an unknown scenario stay the same. A new parameter does not change the scene at its default, so
    that old records remain comparable with new records.
    """
    scenario = SCENARIOS.get(name)
    return {**(scenario.parameters if scenario else {}), **parameters}
