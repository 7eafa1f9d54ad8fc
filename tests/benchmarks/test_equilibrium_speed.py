"""What exact statics costs: run with ``uv run pytest tests/benchmarks --benchmark-enable``."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, Settings, StabilityExtension, solve_equilibrium

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
MASS = 0.0119
MU = 0.45
DT = 1 / 60
UP = (0.0, 0.0, 1.0)
NO_MASS = Masses(np.empty(0, np.int64), np.empty(0), np.empty((0, 3)))


def contacts_of(rows) -> Contacts:
    lower, upper, point, normal = zip(*rows, strict=True)
    n = len(rows)
    return Contacts(
        np.array(lower),
        np.array(upper),
        np.array(point),
        np.array(normal, float),
        np.zeros(n),
        np.zeros((n, 3)),
        np.full(n, MU),
    )


def rectangle(x, y, z, lower, upper):
    return [(lower, upper, (x + i, y + j, z), UP) for i in (-DEPTH / 2, DEPTH / 2) for j in (-DEPTH / 2, DEPTH / 2)]


def plank_of_four_stack(body: int):
    """Two planks a level, each level across the one below: centre and contacts of plank ``body``."""
    level, side = divmod(body, 2)
    reach = (LENGTH - DEPTH) / 2 * (2 * side - 1)
    z = level * THICKNESS
    along_x = level % 2 == 0
    center = (0.0, reach, z + THICKNESS / 2) if along_x else (reach, 0.0, z + THICKNESS / 2)
    rows = []
    for end in (0, 1):
        at = (LENGTH - DEPTH) / 2 * (2 * end - 1)
        lower = GROUND if level == 0 else 2 * (level - 1) + end
        rows += rectangle(*((at, reach) if along_x else (reach, at)), z, lower, body)
    return center, rows


class FourStackPort:
    """A 4-stack that grows plank by plank; all arrays are made beforehand, so that the port costs the core nothing."""

    def __init__(self) -> None:
        self.frozen: set[int] = set()
        self.place(0)

    def place(self, body: int) -> None:
        self.live = body
        center, rows = plank_of_four_stack(body)
        self.touch = contacts_of(rows)
        self.weight = Masses(np.array([body]), np.array([MASS]), np.array([center]))

    def contacts(self) -> Contacts:
        return Contacts.empty() if self.live in self.frozen else self.touch

    def masses(self) -> Masses:
        return NO_MASS if self.live in self.frozen else self.weight

    def sleep(self, bodies: list[int]) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies: list[int]) -> None:
        self.frozen.difference_update(bodies)


@pytest.mark.parametrize("height", [12, 100, 1000])
def test_one_plank_more_on_a_four_stack(benchmark, height):
    """The frame in which a plank joins: its safe region decides, whatever is below."""
    port = FourStackPort()
    extension = StabilityExtension(port, "equilibrium")

    def grow_to_the_last_frame_before_freezing() -> None:
        if port.live in port.frozen:
            port.place(port.live + 1)
        for _ in range(Settings().rest_frames):
            assert not extension.update(DT).frozen

    while port.live < height - 1:
        grow_to_the_last_frame_before_freezing()
        extension.update(DT)
    benchmark.pedantic(
        lambda: extension.update(DT), setup=grow_to_the_last_frame_before_freezing, rounds=50, iterations=1
    )
    assert len(port.frozen) >= height
    assert port.frozen == set(range(len(port.frozen))), "no plank was left out and none woke"


def four_stack(n: int) -> tuple[Contacts, Masses]:
    planks = [plank_of_four_stack(body) for body in range(n)]
    rows = [row for _, contacts in planks for row in contacts]
    return contacts_of(rows), Masses(np.arange(n), np.full(n, MASS), np.array([center for center, _ in planks]))


def row_of_vs(pairs: int) -> tuple[Contacts, Masses]:
    """Inverted Vs side by side under a roof over each two neighbours: friction holds all of it."""
    theta = np.radians(70.0)
    across = (-DEPTH / 2, DEPTH / 2)
    spread, edge = LENGTH * np.cos(theta), THICKNESS * np.sin(theta)
    top = LENGTH * np.sin(theta) + THICKNESS * np.cos(theta)
    pitch = LENGTH - 4 * edge
    rows, centers = [], []
    for pair in range(pairs):
        for side in (1.0, -1.0):
            foot = pair * pitch - side * spread
            rows += [(GROUND, len(centers), (foot, y, 0.0), UP) for y in across]
            centers.append((foot + side * (spread - edge) / 2, 0.0, top / 2))
        ridge = (pair * pitch, LENGTH * np.sin(theta))
        rows += [(2 * pair, 2 * pair + 1, (ridge[0], y, ridge[1]), (1.0, 0.0, 0.0)) for y in across]
    for roof in range(0, pairs - 1, 2):
        for body, x in enumerate((-edge, edge, pitch - edge, pitch + edge)):
            rows += [(2 * roof + body, len(centers), (roof * pitch + x, y, top), UP) for y in across]
        centers.append(((roof + 0.5) * pitch, 0.0, top + THICKNESS / 2))
    return contacts_of(rows), Masses(np.arange(len(centers)), np.full(len(centers), MASS), np.array(centers))


@pytest.mark.parametrize("n", [12, 100, 300])
def test_four_stack_from_scratch(benchmark, n):
    world = four_stack(n)
    assert benchmark(solve_equilibrium, *world).stable


@pytest.mark.parametrize("pairs", [2, 20, 40])
def test_roofed_vs_from_scratch(benchmark, pairs):
    world = row_of_vs(pairs)
    assert benchmark(solve_equilibrium, *world).stable
