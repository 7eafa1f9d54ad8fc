"""Live bodies at rest whose reported forces overturn what carries them: an inverted V on two posts.

Each plank of the V weighs W = m g and leans at 60 deg. By moments about its foot, the ridge presses it back with
H = W / (2 tan 60 deg), so that its post bears W down and H outward at its upper end. With half the width b, height h
and weight P, a post tips outward if H h > (P + W) b.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stability_core import GROUND, StabilityExtension
from tests.stability_core.still_world import StillWorld

DT, G = 1 / 60, 9.81
THETA, LENGTH, HALF, DEEP = np.radians(60), 0.5, 0.05, (-0.05, 0.05)
THRUST = G / (2 * np.tan(THETA))
TIPS = 2 * G * HALF / THRUST
"""Height [m] from which the posts tip, if posts and planks have a mass of 1 kg each."""


class VOnPosts(StillWorld):
    """The posts come first, so that they freeze alone; what would tip stays where it is."""

    def __init__(self, height: float, ridge: float = 1.0, foot: float = 1.0, *, has_forces: bool = True) -> None:
        """Place the posts.

        Args:
            height: of the posts [m].
            ridge: the reported force at the ridge, over the force that balances the planks.
            foot: the same ratio for the horizontal forces between planks and posts.
            has_forces: False if the engine reports no forces.
        """
        super().__init__(np.random.default_rng(0), friction=0.6)
        self.height, self.ridge, self.foot, self.has_forces = height, ridge, foot, has_forces
        self.force: list[tuple[float, float, float]] = []
        self.spread = LENGTH * np.cos(THETA)
        for side in (-1, 1):
            x = side * self.spread
            post = self.add((x, 0.0, height / 2), 1.0)
            self.touch(GROUND, post, [(x + a, y, 0.0) for a in (-HALF, HALF) for y in DEEP], (0.0, 0.0, 1.0))
            self.force += [(0.0, 0.0, G / 4)] * 4

    def lay_planks(self) -> None:
        top, rise = self.height, LENGTH * np.sin(THETA)
        planks = [self.add((side * self.spread / 2, 0.0, top + rise / 2), 1.0) for side in (-1, 1)]
        for post, plank, side in zip((0, 1), planks, (-1, 1), strict=True):
            self.touch(post, plank, [(side * self.spread, y, top) for y in DEEP], (0.0, 0.0, 1.0))
            self.force += [(-side * self.foot * THRUST / 2, 0.0, G / 2)] * 2
        self.touch(*planks, [(0.0, y, top + rise) for y in DEEP], (1.0, 0.0, 0.0))
        self.force += [(self.ridge * THRUST / 2, 0.0, 0.0)] * 2

    def contacts(self):
        if not self.has_forces:
            return super().contacts()
        still = self.frozen | {GROUND}
        live = [force for row, force in zip(self.rows, self.force, strict=True) if not {row[0], row[1]} <= still]
        return replace(super().contacts(), force=np.array(live).reshape(-1, 3))


def frozen_after(world: VOnPosts, seconds: float) -> list[set[int]]:
    """The frozen bodies of each frame, after the planks have come."""
    extension = StabilityExtension(world, policy="equilibrium")
    for _ in range(12):
        extension.update(DT)
    assert world.frozen == {0, 1}
    world.lay_planks()
    seen = []
    for _ in range(round(seconds / DT)):
        extension.update(DT)
        seen.append(set(world.frozen))
    return seen


@pytest.mark.parametrize("excess", [1.1, 1.5])
def test_posts_that_tip_unfreeze_once_the_planks_have_kept_their_place_for_a_second(excess):
    """Earlier, the mean of the reported forces could be wrong by as much as is missing: 3 to 13 % of the largest."""
    seen = frozen_after(VOnPosts(excess * TIPS), 1.2)
    assert seen[50] == {0, 1}
    assert seen[-1] == set()


def test_posts_that_stand_stay_frozen_and_bear_the_planks():
    seen = frozen_after(VOnPosts(0.9 * TIPS), 1.2)
    assert all({0, 1} <= frozen for frozen in seen)
    assert seen[-1] == {0, 1, 2, 3}


@pytest.mark.parametrize("share", [0.8, 0.9])
def test_posts_that_tip_unfreeze_although_the_reported_forces_are_too_small(share):
    """Box3D's forces miss the balance of an arch's stones by 3 to 9 %. With nine tenths of H the posts would stand."""
    seen = frozen_after(VOnPosts(1.03 * TIPS, ridge=share, foot=share), 1.2)
    assert seen[50] == {0, 1}
    assert seen[-1] == set()


def test_posts_that_tip_unfreeze_without_reported_forces():
    seen = frozen_after(VOnPosts(1.1 * TIPS, has_forces=False), 1.2)
    assert seen[-1] == set()


def test_forces_that_do_not_balance_the_planks_prove_nothing():
    """A joint holds the planks, or a port estimates friction: without a force at the ridge, H misses, 0.29 W."""
    seen = frozen_after(VOnPosts(1.1 * TIPS, ridge=0.0), 3.0)
    assert seen[-1] == {0, 1}
