"""The ground under a scene: as large as the scene asks for."""

import pytest

from adapters import ENGINES, EngineNotInstalledError, open_engine
from scenarios.model import World
from scenarios.planks import box

FRAMES = 120
FAR = 9.0
"""Where the slab's middle lies [m]."""


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("profile", ["game", "game@scale=10"])
def test_a_large_scene_has_ground_under_all_of_it(engine, profile):
    """A slab of 6 m that lies 6 to 12 m from the middle sinks by less than a hundredth of its thickness in two seconds,
    and does not tip over an edge."""
    slab = box((6.0, 2.0, 1.0), FAR, level=1)
    try:
        simulation = open_engine(engine, profile, world=World(), sleeping="off", expected=[slab])
    except EngineNotInstalledError as error:
        pytest.skip(str(error))
    simulation.spawn(slab)
    for _ in range(FRAMES):
        simulation.step(simulation.info.frame_s)
    _, position, quaternion = simulation.poses()
    simulation.close()
    assert position[0] == pytest.approx((FAR, 0.0, 0.5), abs=0.01)
    assert abs(quaternion[0, 0]) == pytest.approx(1.0, abs=1e-4)
