"""Exact statics separates stacks 2 % inside their limit from stacks 2 % beyond: closed forms, too near for engines."""

from __future__ import annotations

import pytest

from scenarios.registry import build
from tests.oracle.rbe import at_the_end, of_scene
from tests.oracle.test_rbe import ask_the_core, ask_the_judge

FAMILIES = [
    ("harmonic_overhang", {"bricks": 3}),
    ("harmonic_overhang", {"bricks": 5}),
    ("cantilever", {}),
    ("table", {"legs": 2}),
    ("table", {"legs": 4}),
    ("branches", {"columns": 3}),
    ("plank_bridge", {}),
    ("corbelled_arch", {}),
    ("wall_plank", {}),
    ("incline", {}),
]


@pytest.mark.parametrize("ask", [ask_the_judge, ask_the_core])
@pytest.mark.parametrize(("margin", "verdict"), [(0.02, "stable"), (-0.02, "unstable")])
@pytest.mark.parametrize(("family", "parameters"), FAMILIES)
def test_two_percent_decide(family, parameters, margin, verdict, ask) -> None:
    scene = build(family, **parameters, margin=margin)
    friction = scene.world.friction
    assert ask(of_scene(at_the_end(scene), friction), friction) == verdict
