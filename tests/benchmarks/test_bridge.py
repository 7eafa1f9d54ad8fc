"""What the bridge costs a frame of 100 awake bodies: ``uv run --group wasm pytest --benchmark-only -k the_bridge``.

The cost is the round trip without the engine's own steps, the column ``bridge_ms``. The bodies are a 4-stack of 25
levels, set down at its planned poses anew every second, so that all are awake and touch. A frame that is read also has
the contacts, some 800 points. The least and the lower quartile stand in ``extra_info``, because other programs that run
while the suite waits for the engine lengthen the rest.
"""

from time import perf_counter

import numpy as np
import pytest

from adapters import EngineNotInstalledError, check_installed, open_engine
from adapters.base import Simulation
from scenarios.registry import build

pytestmark = pytest.mark.benchmark(disable_gc=True, group="the bridge at 100 awake bodies")
ENGINES = ("jolt", "havok")
SCENE = build("four_stack", levels=25)
SECONDS, FRAMES, WARM_UP = 10, 60, 10


def set_down(engine: str, is_read: bool) -> Simulation:
    simulation = open_engine(engine, "game", world=SCENE.world, expected=SCENE.bricks)
    if is_read:
        _ = simulation.port
    for brick in SCENE.bricks:
        simulation.spawn(brick)
    for _ in range(WARM_UP):
        simulation.step(simulation.info.frame_s)
    return simulation


@pytest.mark.parametrize("is_read", [False, True], ids=["unread", "read"])
@pytest.mark.parametrize("engine", ENGINES)
def test_the_bridge(benchmark, engine: str, is_read: bool) -> None:
    """Target: 0.1 ms."""
    if not benchmark.enabled:
        pytest.skip("100 bodies are stepped only to be timed: --benchmark-only")
    try:
        check_installed(engine)
    except EngineNotInstalledError as error:
        pytest.skip(str(error))
    simulation = set_down(engine, is_read)
    bridge_ms: list[float] = []

    def begin() -> None:
        nonlocal simulation
        if len(bridge_ms) % FRAMES == FRAMES - 1:
            simulation.close()
            simulation = set_down(engine, is_read)

    def frame() -> None:
        begun = perf_counter()
        simulation.step(simulation.info.frame_s)
        bridge_ms.append((perf_counter() - begun - simulation.own_step_s) * 1e3)

    benchmark.pedantic(frame, setup=begin, rounds=SECONDS * FRAMES)
    least, lower_quartile, median = np.quantile(bridge_ms, (0.0, 0.25, 0.5))
    benchmark.extra_info["bridge_ms"] = {"least": least, "lower_quartile": lower_quartile, "median": median}
    simulation.close()
