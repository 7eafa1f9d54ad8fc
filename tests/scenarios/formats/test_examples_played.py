"""The example files played by engines, from the file to the record of a trial."""

import importlib.util

import pytest

from scenarios.registry import build
from tests.scenarios.played import played

PLAYABLE = {
    "robot_cubes.xml": ("bullet", "mujoco"),
    "four_blocks.xml": ("bullet", "mujoco"),
    "cans.xml": ("bullet",),  # friction of its own for each can, which MuJoCo's adapter refuses
    "prisms.xml": ("bullet", "mujoco"),
    "logs.xml": ("bullet", "mujoco"),
    "jenga_block.urdf": ("bullet", "mujoco"),
    "jenga_levels.urdf": ("bullet", "mujoco"),
    "crates.usda": ("bullet", "mujoco"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("file", "engine"), [(file, one) for file, engines in PLAYABLE.items() for one in engines])
def test_the_extension_makes_a_file_do_what_statics_says(file, engine):
    """Alone, an engine may drop what must stand (prisms of MuJoCo, cans of Bullet); the trial ends all the same."""
    if file.endswith(".usda") and importlib.util.find_spec("pxr") is None:
        pytest.skip("OpenUSD is not installed (group usd)")
    with_core, alone = (
        played(engine, "game", "own_scene", {"file": file}, policy) for policy in ("equilibrium", "none")
    )
    assert alone.status in ("completed", "collapsed")
    outcome = build("own_scene", file=file).expectation.outcome
    assert with_core.status == ("completed" if outcome == "stand" else "collapsed")
