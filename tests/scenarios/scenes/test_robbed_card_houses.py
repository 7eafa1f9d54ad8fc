"""Card houses, placed at once, that lose a card fall, though frozen cards could hold the rest as a rock would.

On Rapier the live cards once leaned on two frozen ones for good: the estimated friction forces had no thrust, so that
they balanced no moments, and the extension took the cards for held by a joint.
"""

import pytest

from tests.scenarios.played import played

SCENES = {
    "card_house": {"storeys": 2, "built": "at_once"},
    "robbed_stack": {"stack": "card_house", "taken": "support", "built": "at_once"},
}


@pytest.mark.parametrize("engine", ["bullet", "mujoco", "physx", "rapier", "box3d"])
@pytest.mark.parametrize("scene", SCENES)
def test_a_card_house_that_loses_a_card_falls(engine, scene):
    assert played(engine, "tuned", scene, SCENES[scene], "equilibrium").verdict == "right"
