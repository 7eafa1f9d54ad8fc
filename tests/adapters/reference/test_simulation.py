"""The hooks of the reference engines: what a world reports after a state that is not finite."""

from __future__ import annotations

import numpy as np
import pytest

from adapters import open_engine
from adapters.reference.simulation import ReferenceSimulation
from scenarios.model import Brick


@pytest.mark.parametrize("engine", ["erleben", "staggered"])
@pytest.mark.parametrize("speed", [np.nan, np.inf])
def test_a_diverged_world_makes_no_further_step_and_reports_nan(engine: str, speed: float) -> None:
    """The second plank is 1 m away and stays finite; without a stop it would fall 0.14 m in 10 frames."""
    simulation = open_engine(engine, "default")
    assert isinstance(simulation, ReferenceSimulation)
    diverged, other = (simulation.spawn(Brick((0.1, 0.1, 0.1), 1.0, (x, 0.0, 1.0))) for x in (0.0, 1.0))
    _ = simulation.port
    boxes = simulation._boxes
    boxes.velocity[boxes.rows(np.array([diverged]))] = speed
    for _ in range(10):
        simulation.step(simulation.info.frame_s)
    assert np.array_equal(boxes.position[boxes.rows(np.array([other]))], [[1.0, 0.0, 1.0]])
    _, positions, quaternions = simulation.poses()
    assert np.isnan(positions).all()
    assert np.isnan(quaternions).all()
    simulation.port.contacts()  # must return, as after each frame of a trial
    simulation.close()
