"""What lies in a pile waits until no blow has shaken the pile for ``quiet_s``; the first blow on a stack is free."""

from __future__ import annotations

import pytest

from stability_core import GROUND, StabilityExtension
from stability_core.settings import Settings

DT = 1 / 60
X, Y = (-0.06, 0.06), (-0.01, 0.01)
FALL = (0.0, 0.0, -1.0)
"""Velocity of a body that lands [m/s]: a hard blow on a body of this size."""
REST_FRAMES = 8
"""Frames until a body at rest has frozen."""
CALM_FRAMES, QUIET_FRAMES = round(Settings().calm_s / DT), round(Settings().quiet_s / DT)


def row_of_blocks(port, count: int) -> None:
    """Blocks on the ground, each of which touches the next one."""
    for body in range(count):
        x = 0.12 * body
        port.add(body, (x, 0.0, 0.01))
        port.lay(body, GROUND, [x + i for i in X], Y, 0.0)
        if body > 0:
            port.touch(body, body - 1, [(x - 0.06, y, z) for y in Y for z in (0.0, 0.02)], normal=(1.0, 0.0, 0.0))


def run(extension, frames: int) -> list[int]:
    """Play frames, and return the bodies that froze."""
    return [body for _ in range(frames) for body in extension.update(DT).frozen]


def drop_on(port, extension, target: int, striker: int = 99) -> None:
    """Let a block land hard on a block for a frame, and take it away."""
    x = port.center[target][0]
    port.add(striker, (x, 0.0, 0.04))
    port.lay(striker, target, [x + i for i in X], Y, 0.02, velocity=FALL)
    extension.update(DT)
    port.remove(striker)


def move(port, bodies, shift: float = 1e-3) -> None:
    """Move live bodies, as after a blow, so that they may freeze again once they are at rest."""
    for body in bodies:
        x, y, z = port.center[body]
        port.center[body] = (x, y + shift, z)


@pytest.fixture
def extension(port):
    row_of_blocks(port, 3)
    made = StabilityExtension(port, "equilibrium")
    run(made, REST_FRAMES)
    assert port.frozen == {0, 1, 2}
    return made


def strike(port, extension, target: int) -> None:
    """Strike a block, which moves."""
    drop_on(port, extension, target)
    assert target not in port.frozen
    move(port, {0, 1, 2} - port.frozen)


def test_a_first_blow_delays_nothing(port, extension):
    strike(port, extension, 1)
    assert 1 in run(extension, REST_FRAMES + 2)


def test_a_second_blow_makes_the_pile_wait(port, extension):
    strike(port, extension, 1)
    run(extension, REST_FRAMES + 2)
    strike(port, extension, 1)
    assert run(extension, QUIET_FRAMES - 4) == []
    assert "shaken by blows" in extension.why(1)
    assert 1 in run(extension, REST_FRAMES + 4)


def test_every_blow_on_the_pile_begins_the_wait_anew(port, extension):
    for _ in range(2):
        strike(port, extension, 1)
        run(extension, REST_FRAMES + 2)
    assert 1 not in port.frozen
    run(extension, QUIET_FRAMES // 2)
    drop_on(port, extension, 1)
    assert run(extension, QUIET_FRAMES - 4) == []
    assert 1 in run(extension, REST_FRAMES + 4)


def test_live_neighbours_wait_too_and_frozen_ones_keep_the_shock_to_themselves(port, extension):
    for _ in range(2):
        strike(port, extension, 0)
        run(extension, REST_FRAMES + 2)
    assert port.frozen == {1, 2}, "only the struck block waits"
    port.add(3, (-0.12, 0.0, 0.01))
    port.lay(3, GROUND, [-0.12 + i for i in X], Y, 0.0)
    port.touch(0, 3, [(-0.06, y, z) for y in Y for z in (0.0, 0.02)], normal=(1.0, 0.0, 0.0))
    drop_on(port, extension, 0)
    assert run(extension, QUIET_FRAMES - 4) == [], "the new block touches the shaken one"
    assert set(run(extension, REST_FRAMES + 4)) == {0, 3}


def test_another_pile_does_not_wait(port, extension):
    for _ in range(2):
        strike(port, extension, 0)
        run(extension, REST_FRAMES + 2)
    port.add(7, (5.0, 0.0, 0.01))
    port.lay(7, GROUND, [5.0 + i for i in X], Y, 0.0)
    drop_on(port, extension, 0)
    assert run(extension, REST_FRAMES + 2) == [7]


def test_a_policy_that_solves_no_statics_does_not_wait(port):
    row_of_blocks(port, 3)
    extension = StabilityExtension(port, "at_rest")
    run(extension, REST_FRAMES)
    strike(port, extension, 1)
    run(extension, REST_FRAMES + 2)
    strike(port, extension, 1)
    assert 1 in run(extension, REST_FRAMES + CALM_FRAMES), "it waits only because it has unfrozen twice"
