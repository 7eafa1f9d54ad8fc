"""Ids and rows: memory follows what lives, whatever its ids are."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, StabilityExtension
from stability_core.port import IntArray
from stability_core.rows import UNKNOWN, Rows, find_rows, give_rows, rows_for, take_row
from tests.stability_core.dwell import REST_FRAMES
from tests.stability_core.still_world import StillWorld
from tests.stability_core.test_extension import DEEP, DT, WIDE, column, run, settle

POLICIES = ["paper", "at_rest", "equilibrium", "pile"]


def rows_of(rows: Rows, ids) -> IntArray:
    found = np.empty(len(ids), np.int64)
    find_rows(rows.slots, np.array(ids, np.int64), found)
    return found


def test_rows_are_given_in_the_order_of_appearance():
    rows = rows_for(8)
    for ids, expected in (([3, 1, 2], [2, 0, 1]), ([1, 9, 2, 2**62], [0, 3, 1, 4])):
        given = rows_of(rows, ids)
        assert give_rows(rows.slots, rows.spare, np.array(ids), given) == 0
        assert given.tolist() == expected
    more = rows_for(12, rows)
    assert rows_of(more, [2**62, 9, 1, 2, 3, 4]).tolist() == [4, 3, 0, 1, 2, UNKNOWN]
    ids = np.arange(100, 108)
    assert give_rows(more.slots, more.spare, ids, rows_of(more, ids)) == 1, "one row is missing"
    ids = ids[:7]
    given = rows_of(more, ids)
    give_rows(more.slots, more.spare, ids, given)
    assert given.tolist() == list(range(5, 12))


@pytest.mark.parametrize("stride", [1, 64, 2**20, 2**40])
def test_bodies_come_and_go_as_in_a_dictionary(stride):
    """Where a gap is closed behind a body that leaves, all others are found."""
    random = np.random.default_rng(stride)
    rows, known, free = rows_for(64), {}, 64
    for step in range(3000):
        if known and (free == 0 or random.random() < 0.5):
            body = int(random.choice(list(known)))
            take_row(rows.slots, rows.spare, body)
            del known[body]
            free += 1
        else:
            body = step * stride
            given = rows_of(rows, [body])
            give_rows(rows.slots, rows.spare, np.array([body]), given)
            assert given[0] not in known.values()
            known[body] = given[0]
            free -= 1
        assert rows_of(rows, list(known)).tolist() == list(known.values())
        assert rows.spare[0] == free
    assert rows_of(rows, [3000 * stride, GROUND, -7]).tolist() == [UNKNOWN, GROUND, UNKNOWN]


class Renamed:
    """A world whose bodies have other ids."""

    def __init__(self, world: StillWorld, names: dict[int, int]) -> None:
        self.world, self.names = world, names

    def new(self, ids) -> IntArray:
        return np.array([GROUND if i == GROUND else self.names[i] for i in np.asarray(ids).tolist()], np.int64)

    def old(self, ids) -> list[int]:
        back = {name: body for body, name in self.names.items()}
        return [back[i] for i in ids]

    def contacts(self) -> Contacts:
        seen = self.world.contacts()
        return Contacts(
            self.new(seen.body_a),
            self.new(seen.body_b),
            seen.point,
            seen.normal,
            seen.separation,
            seen.relative_velocity,
            seen.friction,
        )

    def masses(self) -> Masses:
        seen = self.world.masses()
        return Masses(self.new(seen.body), seen.mass, seen.center_of_mass, self.new(seen.removed).tolist())

    def sleep(self, ids) -> None:
        self.world.sleep(self.old(ids))

    def wake(self, ids) -> None:
        self.world.wake(self.old(ids))


@pytest.mark.parametrize("policy", POLICIES)
def test_ids_are_names_only(policy):
    """Planks come and go: with ids up to 2^62, in the same order, every frame is the same."""
    names = {body: int(x) for body, x in enumerate(np.sort(np.random.default_rng(3).integers(0, 2**62, 200)))}
    worlds = [StillWorld(np.random.default_rng(5), friction=0.6) for _ in range(2)]
    plain, renamed = StabilityExtension(worlds[0], policy), StabilityExtension(Renamed(worlds[1], names), policy)
    for _ in range(60):
        for world in worlds:
            if world.random.random() < 0.7 or not world.center:
                world.lay() if world.random.random() < 0.7 else world.lean()
            else:
                world.take(int(world.random.choice(list(world.center))))
        for _ in range(8):
            expected, change = plain.update(DT), renamed.update(DT)
            assert [names[body] for body in expected.frozen] == list(change.frozen)
            assert [names[body] for body in expected.woken] == list(change.woken)
            assert {names[body]: reason for body, reason in expected.reasons.items()} == change.reasons
    assert worlds[0].frozen == worlds[1].frozen
    assert [names[body] for body in plain.frozen.tolist()] == renamed.frozen.tolist()
    for body in worlds[0].center:
        assert plain.why(body) == renamed.why(names[body])


@pytest.mark.parametrize("policy", POLICIES)
def test_a_row_is_not_mistaken_for_the_body_that_had_it(port, policy):
    """The plank in the middle is exchanged for one beside the column, frame by frame: what was above wakes."""
    column(port, 3)
    extension = StabilityExtension(port, policy)
    settle(extension)
    above = sorted(port.frozen - {0, 1})
    port.remove(1)
    port.add(7, (5.0, 0.0, 0.005))
    port.lay(7, GROUND, (4.95, 5.05), DEEP, 0.0)
    woken = [*extension.update(DT).woken, *extension.update(DT).woken]
    assert woken == above
    with pytest.raises(KeyError, match="unknown body 1"):
        extension.why(1)
    run(extension, 2 * REST_FRAMES)
    assert 7 in port.frozen


def test_a_support_exchanged_for_a_heavier_one_is_proven_anew(port):
    """Same place, same contacts, same row: yet another body, which the beam below does not bear."""
    column(port, 1)
    port.mass[0] = 20.0
    port.add(1, (0.04, 0.0, 0.015))
    port.lay(1, 0, (-0.01, 0.05), DEEP, 0.01)
    port.add(2, (0.08, 0.0, 0.025), mass=0.1)
    port.lay(2, 1, (0.07, 0.09), DEEP, 0.02)
    extension = StabilityExtension(port, "equilibrium")
    settle(extension)
    assert port.frozen == {0, 1, 2}
    port.remove(2)
    extension.update(DT)
    port.add(3, (0.08, 0.0, 0.025), mass=5.0)
    port.lay(3, 1, (0.07, 0.09), DEEP, 0.02)
    changes = run(extension, 30)
    assert 1 in {body for change in changes for body in change.woken}


def test_contacts_of_a_removed_body_are_forgotten(port):
    """The plank freezes within the dwell time after its prop was taken: nothing is laid on the prop."""
    column(port, 1)
    port.add(1, (0.0, 0.0, 0.015))
    port.lay(1, 0, (-0.05, 0.0), DEEP, 0.01)
    port.add(2, (0.04, 0.0, 0.005))
    port.lay(1, 2, (0.03, 0.05), DEEP, 0.01)
    extension = StabilityExtension(port)
    run(extension, REST_FRAMES)
    port.remove(2)
    run(extension, 3)
    bodies, patches = extension._world.graph.bodies, extension._world.graph.patches
    at = bodies["first_support"][1]
    while at >= 0:
        assert patches["lower"][at] in (GROUND, 0)
        at = patches["next_support"][at]


class Stream:
    """Bricks on a table, ``alive`` at a time: each frame some come and as many go."""

    def __init__(self, alive: int, each: int) -> None:
        self.alive, self.each, self.first = alive, each, 0
        self.frozen: set[int] = set()

    def next(self) -> None:
        self.first += self.each

    def contacts(self) -> Contacts:
        ids = np.repeat(self._live(), 4)
        corners = np.array([(x, y, 0.0) for x in WIDE for y in DEEP])
        n = len(ids)
        points = np.tile(corners, (n // 4, 1)) + np.column_stack([0.2 * (ids % 1000), np.zeros((n, 2))])
        return Contacts(
            np.full(n, GROUND), ids, points, np.tile((0.0, 0.0, 1.0), (n, 1)), np.zeros(n), np.zeros((n, 3)), np.ones(n)
        )

    def masses(self) -> Masses:
        live = self._live()
        center = np.column_stack([0.2 * (live % 1000), np.zeros(len(live)), np.full(len(live), 0.005)])
        gone = [body for body in range(self.first - self.each, self.first) if body >= 0]
        self.frozen -= set(gone)
        return Masses(live, np.ones(len(live)), center, gone)

    def _live(self) -> IntArray:
        return np.array(
            [body for body in range(self.first, self.first + self.alive) if body not in self.frozen], np.int64
        )

    def sleep(self, ids) -> None:
        self.frozen.update(ids)

    def wake(self, ids) -> None:
        self.frozen -= set(ids)


@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_memory_is_flat_however_many_bodies_pass_through(policy):
    """A hundred at a time, 10,000 in all."""
    stream = Stream(alive=100, each=10)
    extension = StabilityExtension(stream, policy)
    held = []
    for frame in range(1000):
        stream.next()
        extension.update(DT)
        if frame in (200, 999):
            world = extension._world
            held.append(sum(table.nbytes for table in (*world.graph, *world.buffers, *world._rows)))
    assert stream.frozen
    assert len(extension._world.graph.bodies) <= 256
    assert held[1] == held[0]
    assert len(extension._reasons) <= stream.alive
