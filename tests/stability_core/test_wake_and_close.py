"""What the host asks for at once: bodies are woken before an impulse, and a port is handed over."""

from __future__ import annotations

import pytest

from stability_core import StabilityExtension
from tests.stability_core.dwell import REST_FRAMES
from tests.stability_core.test_extension import DEEP, DT, FALL, SETTINGS, column, run, settle

POLICIES = ["paper", "at_rest", "equilibrium"]


def kick(port, bodies, speed: float) -> None:
    """An impulse as an engine takes it: a body that sleeps does not move."""
    for body in set(bodies) - port.frozen:
        x, y, z = port.center[body]
        port.center[body] = (x + speed * DT, y, z)


@pytest.mark.parametrize("policy", POLICIES)
def test_what_is_woken_is_moved_by_an_impulse_of_the_same_frame(port, policy):
    column(port, 3)
    extension = StabilityExtension(port, policy)
    settle(extension)
    port.batches.clear()
    change = extension.wake([1])
    assert change.woken == (1, 2)
    assert change.reasons == {1: "woken by the host", 2: "rested on what was woken by the host"}
    assert port.batches == [("wake", [1, 2])]
    kick(port, [1, 2], 2 * SETTINGS.moving_speed * FALL)
    assert port.center[1][0] > 0.0
    assert extension.update(DT).woken == (), "it was returned already"
    run(extension, 2 * REST_FRAMES + 2)
    assert port.frozen == {0, 1, 2}, "they have moved and are at rest again"


def test_what_is_woken_and_not_moved_waits_until_it_was_calm(port):
    column(port, 1)
    extension = StabilityExtension(port)
    settle(extension)
    extension.wake([0])
    run(extension, REST_FRAMES + 1)
    assert not port.frozen
    assert extension.why(0).startswith("unfrozen (woken by the host) and perhaps at the start of a collapse")
    settle(extension)
    assert port.frozen == {0}


def test_a_body_that_is_live_is_not_woken_again(port):
    column(port, 2)
    extension = StabilityExtension(port)
    settle(extension)
    extension.disturb([1])
    assert extension.wake([1]).woken == (1,)
    assert extension.wake([1]).woken == ()
    assert extension.update(DT).woken == ()
    with pytest.raises(KeyError, match="unknown body 5"):
        extension.wake([5])


def test_a_port_that_cannot_wake_is_asked_again(port):
    column(port, 2)
    extension = StabilityExtension(port)
    settle(extension)
    obey = port.wake

    def refuse(bodies) -> None:
        raise OSError("the engine is busy")

    port.wake = refuse
    with pytest.raises(OSError, match="busy"):
        extension.wake([0])
    assert extension.frozen.tolist() == [0, 1]
    with pytest.raises(OSError, match="busy"):
        extension.close()
    assert extension.frozen.tolist() == [0, 1]
    port.wake = obey
    assert extension.update(DT).woken == (0, 1)


@pytest.mark.parametrize("policy", POLICIES)
def test_a_closed_extension_hands_every_body_back_and_another_takes_over(port, policy):
    column(port, 3)
    with StabilityExtension(port, policy) as first:
        settle(first)
        assert port.frozen == {0, 1, 2}
    assert not port.frozen
    assert not len(first.frozen)
    for refused in (lambda: first.update(DT), first.adopt, lambda: first.wake([0])):
        with pytest.raises(RuntimeError, match="closed: create a new StabilityExtension"):
            refused()
    port.batches.clear()
    first.close()
    assert port.batches == [], "it was closed already"
    settle(StabilityExtension(port, policy))
    assert port.frozen == {0, 1, 2}


def test_a_port_that_was_not_handed_over_is_refused_with_the_remedy(port):
    """The earlier extension froze body 0, which masses() no longer lists."""
    column(port, 1)
    settle(StabilityExtension(port))
    port.add(1, (0.0, 0.0, 0.015))
    port.lay(1, 0, (-0.05, 0.05), DEEP, 0.01)
    with pytest.raises(
        ValueError, match=r"If an earlier extension on this port froze the body, call close\(\) of that extension"
    ):
        StabilityExtension(port).update(DT)
