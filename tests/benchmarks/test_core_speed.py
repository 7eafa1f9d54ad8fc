"""What the core costs: run with ``uv run pytest tests/benchmarks --benchmark-enable``."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, Settings, StabilityExtension

SIZE = np.array([117.0, 23.4, 7.8]) * 1e-3
CORNERS = np.array([(x, y, 0.0) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]) * SIZE
DT = 1 / 60
NO_MASS = Masses(np.empty(0, np.int64), np.empty(0), np.empty((0, 3)))


class ColumnPort:
    """A straight column of planks, built to ``height`` and frozen, and one live plank on top of it."""

    def __init__(self, height: int) -> None:
        self.height = height
        self.frozen: set[int] = set()
        self.place(0)

    def place(self, body: int) -> None:
        """Put the next plank on top; all arrays are made here, so that the port costs the core nothing."""
        n = len(CORNERS)
        self.live = body
        self.touch = Contacts(
            np.full(n, body - 1 if body else GROUND),
            np.full(n, body),
            CORNERS + np.array([0.0, 0.0, body * SIZE[2]]),
            np.tile([0.0, 0.0, 1.0], (n, 1)),
            np.zeros(n),
            np.zeros((n, 3)),
            np.full(n, 0.45),
        )
        self.weight = Masses(np.array([body]), np.array([0.0119]), np.array([[0.0, 0.0, (body + 0.5) * SIZE[2]]]))

    def contacts(self) -> Contacts:
        return Contacts.empty() if self.live in self.frozen else self.touch

    def masses(self) -> Masses:
        return NO_MASS if self.live in self.frozen else self.weight

    def sleep(self, bodies: list[int]) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies: list[int]) -> None:
        self.frozen.difference_update(bodies)


class CarpetPort:
    """``live`` planks on a table, a contact at each corner: all at rest, or all sliding to and fro."""

    def __init__(self, live: int, is_moving: bool) -> None:
        self.is_moving = is_moving
        self.frozen: set[int] = set()
        self.lay(0, live)

    def lay(self, first: int, live: int) -> None:
        """Show ``live`` planks with ids from ``first``, and no others: those are frozen."""
        ids = np.arange(first, first + live)
        n = live * len(CORNERS)
        place = np.column_stack([0.2 * ids, np.zeros((live, 2))])
        middle = np.array([0.0, 0.0, SIZE[2] / 2])
        self.touch = Contacts(
            np.full(n, GROUND),
            np.repeat(ids, len(CORNERS)),
            (place[:, None] + CORNERS).reshape(-1, 3),
            np.tile([0.0, 0.0, 1.0], (n, 1)),
            np.zeros(n),
            np.zeros((n, 3)),
            np.full(n, 0.45),
        )
        self.weight = Masses(ids, np.full(live, 0.0119), place + middle)

    def contacts(self) -> Contacts:
        return self.touch

    def masses(self) -> Masses:
        if self.is_moving:
            self.weight.center_of_mass[:, 1] = 0.002 - self.weight.center_of_mass[:, 1]
        return self.weight

    def sleep(self, bodies: list[int]) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies: list[int]) -> None:
        self.frozen.difference_update(bodies)


def built(port: ColumnPort, policy: str) -> StabilityExtension:
    extension = StabilityExtension(port, policy)
    while len(port.frozen) < port.height:
        extension.update(DT)
        if port.live in port.frozen:
            port.place(port.live + 1)
    extension.update(DT)
    return extension


@pytest.mark.parametrize("frozen", [10, 100, 1000, 10_000])
@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_quiet_frame(benchmark, policy, frozen):
    """One live brick that touches the stack, nothing to decide: the core's part of almost every frame."""
    port = CarpetPort(10, is_moving=False)
    extension = StabilityExtension(port, policy)
    while len(port.frozen) < frozen:
        port.lay(len(port.frozen), min(100, frozen - len(port.frozen)))
        for _ in range(Settings().rest_frames + 1):
            extension.update(DT)
    port.is_moving = True
    port.lay(frozen, 1)
    extension.update(DT)
    change = benchmark(extension.update, DT)
    assert not change.frozen
    assert not change.woken
    assert len(port.frozen) == frozen


@pytest.mark.parametrize("frozen", [100, 1000])
def test_freezing_one_more(benchmark, frozen):
    """The frame in which a plank joins a column: the load is carried down to the ground."""
    port = ColumnPort(frozen)
    extension = built(port, "paper")

    def until_due():
        extension.update(DT)
        while not extension.update(DT).frozen:
            pass
        port.place(port.live + 1)

    benchmark.pedantic(until_due, rounds=20, iterations=1)
    assert len(port.frozen) >= frozen + 1


@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_a_hundred_moving_bricks(benchmark, policy):
    """All are tracked and their 400 contacts filtered."""
    port = CarpetPort(100, is_moving=True)
    extension = StabilityExtension(port, policy)
    assert not benchmark(extension.update, DT).frozen


@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_a_hundred_bricks_come_to_rest_at_once(benchmark, policy):
    """The worst frame for them: each is decided, on the contacts of six frames."""

    def one_frame_before() -> tuple[tuple[StabilityExtension], dict[str, float]]:
        extension = StabilityExtension(CarpetPort(100, is_moving=False), policy)
        for _ in range(Settings().rest_frames):
            assert not extension.update(DT).frozen
        return (extension,), {}

    change = benchmark.pedantic(lambda extension: extension.update(DT), setup=one_frame_before, rounds=50)
    assert len(change.frozen) == 100
