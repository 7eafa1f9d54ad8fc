"""The example files played by engines, from the file to the record of a trial."""

import importlib.util

import pytest

from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial
from scenarios.registry import build

LIMITS = Limits(ratio=False)
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
    scene = build("own_scene", file=file)
    with_core, alone = (
        run_trial(Trial(engine, "game", "own_scene", scene.variant, {"file": file}, policy, 0, 0), LIMITS, "", _ignore)
        for policy in ("equilibrium", "none")
    )
    assert alone.record.status in ("completed", "collapsed")
    assert with_core.record.status == ("completed" if scene.expectation.outcome == "stand" else "collapsed")


def _ignore(progress):
    pass
