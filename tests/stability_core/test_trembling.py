"""Loads that tremble on a frozen stack: leaning planks that never rest, on posts, in a world without physics.

``test_certain_loads`` gives the statics of the V on two posts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stability_core import GROUND, Settings, StabilityExtension
from stability_core.policies.equilibrium import Equilibrium
from tests.stability_core.dwell import LOAD_FRAMES, REST_FRAMES
from tests.stability_core.test_certain_loads import DT, LENGTH, TIPS, VOnPosts

SETTINGS = Settings()
DEPTH = 1.5 * SETTINGS.lean_penetration * LENGTH / 2
"""Depth of the contacts of the planks [m], more than a leaning body may have."""
HEIGHT = 0.9 * TIPS
"""Posts of this height stand [m]."""
FAR = 4.0
"""Ratio of the planks' thrust to the thrust that balances them, which overturns the posts by far."""


class TremblingV(VOnPosts):
    """The planks sway up and down by 4 mm, twice a second, too deep in their contacts to freeze."""

    frame, planks = 0, ()

    def lay_planks(self):
        super().lay_planks()
        self.planks = (self.next - 2, self.next - 1)

    def masses(self):
        self.frame += 1
        step = 0.004 * (np.sin(4 * np.pi * self.frame * DT) - np.sin(4 * np.pi * (self.frame - 1) * DT))
        for body in self.planks:
            self.center[body] = self.center[body] + (0.0, 0.0, step)
        return super().masses()

    def contacts(self):
        found = super().contacts()
        is_deep = np.isin(found.body_a, self.planks) | np.isin(found.body_b, self.planks)
        return replace(found, separation=np.where(is_deep, -DEPTH, 0.0))


def loaded(world: VOnPosts) -> StabilityExtension:
    """Freeze the posts, and lay the planks."""
    extension = StabilityExtension(world, policy="equilibrium")
    for _ in range(12):
        extension.update(DT)
    assert world.frozen == {0, 1}
    world.lay_planks()
    return extension


def first_wake(extension: StabilityExtension, frames: int) -> int | None:
    """Return the number of frames until a body unfreezes, or None."""
    for frame in range(frames):
        if extension.update(DT).woken:
            return frame
    return None


def test_posts_that_are_overturned_by_far_unfreeze_after_a_second_judgement():
    """The first judgement takes place once the planks have lain there for ``load_s``, the second ``rest_s`` later."""
    found = first_wake(loaded(TremblingV(HEIGHT, foot=FAR)), 60)
    assert found is not None
    assert LOAD_FRAMES + REST_FRAMES - 1 <= found <= LOAD_FRAMES + REST_FRAMES + 3


def test_posts_that_stand_stay_frozen_under_planks_that_tremble():
    world = TremblingV(HEIGHT)
    assert first_wake(loaded(world), 120) is None
    assert world.frozen == {0, 1}


def test_a_force_of_some_frames_unfreezes_nothing():
    """For three frames the feet thrust as much as would overturn the posts."""
    world = TremblingV(HEIGHT)
    extension = loaded(world)
    assert first_wake(extension, 30) is None
    usual = list(world.force)
    world.force = [(FAR * x, y, z) for x, y, z in usual]
    assert first_wake(extension, 3) is None
    world.force = usual
    assert first_wake(extension, 60) is None


def test_a_force_that_hardly_changes_is_judged_once(monkeypatch):
    world, judged = TremblingV(HEIGHT), []
    kept = Equilibrium._unbalanced_in_part
    monkeypatch.setattr(
        Equilibrium, "_unbalanced_in_part", lambda self, *given: judged.append(given) or kept(self, *given)
    )
    extension = loaded(world)
    first_wake(extension, 40)
    before = len(judged)
    first_wake(extension, 200)
    assert len(judged) <= before + 6, "a push that lasts is judged again after twice the time each"


def test_a_lost_support_unfreezes_at_once_under_a_load_that_trembles():
    """The loss is judged exactly, because the rules for trembling loads hold only for what stands without them."""
    world = TremblingV(HEIGHT)
    for side in (0, 1):
        world.rows = [row for row in world.rows if row[:2] != (GROUND, side)]
        x, z = (-1, 1)[side] * world.spread, 0.0
        block = world.add((x, 0.0, z - 0.05), 1.0)
        world.touch(GROUND, block, [(x + a, y, z - 0.1) for a in (-0.1, 0.1) for y in (-0.1, 0.1)], (0.0, 0.0, 1.0))
        world.touch(block, side, [(x + a, y, z) for a in (-0.05, 0.05) for y in (-0.05, 0.05)], (0.0, 0.0, 1.0))
    world.force = [(0.0, 0.0, 9.81 / 4)] * len(world.rows)
    extension = StabilityExtension(world, policy="equilibrium")
    for _ in range(30):
        extension.update(DT)
    assert world.frozen == {0, 1, 2, 3}
    world.lay_planks()
    assert first_wake(extension, 60) is None
    world.center.pop(2), world.mass.pop(2)
    world.rows, world.force = map(
        list, zip(*[pair for pair in zip(world.rows, world.force, strict=True) if 2 not in pair[0][:2]], strict=True)
    )
    world.frozen.discard(2)
    world.removed.append(2)
    assert 0 in extension.update(DT).woken


def test_what_is_woken_does_not_freeze_with_the_next_question_of_a_neighbour(port):
    """A woken body waits until it is calm, also if a body that comes to rest on it asks in the meantime."""
    for body in range(4):
        port.add(body, (0.0, 0.0, 0.01 * body + 0.005))
        port.lay(body, body - 1 if body else GROUND, (-0.05, 0.05), (-0.01, 0.01), 0.01 * body)
    extension = StabilityExtension(port, "equilibrium")
    for _ in range(30):
        extension.update(DT)
    assert port.frozen == {0, 1, 2, 3}
    assert set(extension.wake([2]).woken) == {2, 3}
    port.add(4, (0.06, 0.0, 0.045))  # its centre lies beyond what carries it, so that a joint solve must decide
    port.lay(4, 3, (0.01, 0.05), (-0.01, 0.01), 0.04)
    for _ in range(round(SETTINGS.calm_s / DT) - 1):
        extension.update(DT)
        assert not port.frozen & {2, 3}
    for _ in range(30):
        extension.update(DT)
    assert 2 in port.frozen


def test_a_body_on_a_restless_pile_waits_as_long_as_the_pile(port):
    """After four unfreezings, the pile waits for 2 s before it freezes, and what lands on it for 1 s."""
    port.add(0, (0.0, 0.0, 0.005))
    port.lay(0, GROUND, (-0.05, 0.05), (-0.01, 0.01), 0.0)
    extension = StabilityExtension(port, "equilibrium")
    for _ in range(4):
        while not port.frozen:
            extension.update(DT)
        extension.wake([0])
    while not port.frozen:
        extension.update(DT)
    port.add(1, (0.0, 0.0, 0.015))
    port.lay(1, 0, (-0.05, 0.05), (-0.01, 0.01), 0.01)
    waited = 0
    while 1 not in port.frozen:
        extension.update(DT)
        waited += 1
        assert waited < 300
    assert waited * DT == pytest.approx(SETTINGS.rest_s + 2 * SETTINGS.calm_s, abs=3 * DT)


def test_a_body_that_freezes_anew_has_no_earlier_judgement():
    world = TremblingV(HEIGHT)
    extension = loaded(world)
    first_wake(extension, 30)
    load = extension.policy._trembling._load
    assert np.isfinite(load[[0, 1]]).any()
    extension.policy._trembling.forget([0, 1])
    assert np.isnan(load[[0, 1]]).all()
