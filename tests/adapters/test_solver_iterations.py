"""Engines that report the iterations of their solver, and engines that do not."""

import pytest

from adapters import open_engine
from adapters.conformance.rig import advance, frozen_column, place_on


@pytest.mark.parametrize(("profile", "iterations"), [("game", 50), ("tuned", 200), ("game@scale=10", 50)])
def test_bullet_uses_all_iterations_where_no_residual_ends_them(profile: str, iterations: int) -> None:
    simulation = open_engine("bullet", profile)
    place_on(simulation, 0)
    advance(simulation, 0.2)
    assert simulation.solver_iterations() == iterations
    simulation.close()


def test_mujoco_needs_few_iterations_of_newtons_method() -> None:
    simulation = open_engine("mujoco", "game")
    frozen_column(simulation, 1)
    place_on(simulation, 1)
    used = []
    for _ in range(30):
        simulation.step(simulation.info.frame_s)
        used.append(simulation.solver_iterations())
    simulation.close()
    assert 1 <= max(count for count in used if count is not None) <= 100


@pytest.mark.parametrize("engine", ["dart", "physx", "rapier", "box3d", "pymunk"])
def test_other_engines_report_none(engine: str) -> None:
    simulation = open_engine(engine, "game")
    place_on(simulation, 0)
    advance(simulation, 0.05)
    assert simulation.solver_iterations() is None
    simulation.close()
