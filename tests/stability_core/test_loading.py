"""Feasible is not stable: structures that contact forces could hold, and whether those forces would arise."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import solve_equilibrium
from tests.stability_core.masonry import (
    LONG,
    arch,
    brick_between_walls,
    inverted_v,
    logs,
    overhang,
    rod_between_walls,
    spheres,
)
from tests.stability_core.piles import Pile

UPRIGHT = np.eye(3)
LIMIT = 0.107426
"""Least thickness over radius of a semicircular arch with friction above 0.3958 (Couplet and Heyman)."""
LEAST_FRICTION = 0.3092
"""Below it no semicircular arch, however thick, has an equilibrium."""


def verdict(pile: Pile) -> str:
    return solve_equilibrium(*pile.world(UPRIGHT)).verdict


def noisy(pile: Pile, angle: float, length: float, random: np.random.Generator) -> str:
    """The verdict with each normal and each point off by normal deviates [rad], [m]."""
    contacts, masses = pile.world(UPRIGHT)
    contacts.normal[:] += angle * random.normal(size=contacts.normal.shape)
    contacts.normal[:] /= np.linalg.norm(contacts.normal, axis=1, keepdims=True)
    contacts.point[:] += length * random.normal(size=contacts.point.shape)
    return solve_equilibrium(contacts, masses).verdict


@pytest.mark.parametrize(
    ("excess", "friction"), [(0.001, 0.45), (0.005, 0.45), (0.01, 0.45), (0.005, 0.8), (0.03, 0.8)]
)
def test_a_neighbours_side_does_not_hold_an_overhang(excess, friction):
    """As the brick begins to turn its inner end rises past the neighbour: nothing presses, so no friction arises."""
    assert verdict(overhang(excess, friction)) in {"doubt", "unstable"}
    assert verdict(overhang(-excess, friction)) == "stable"


@pytest.mark.parametrize("outer", [0.001, 0.1])
def test_a_light_block_on_its_outer_end_changes_nothing(outer):
    assert verdict(overhang(0.005, outer=outer)) in {"doubt", "unstable"}


def test_a_heavy_block_on_the_table_side_holds_it():
    """5 kg 30 mm inside the edge against 1 kg 5 mm outside."""
    assert verdict(overhang(0.005, outer=5.0, at=LONG / 2 - 0.035)) == "stable"


def test_an_unrelated_v_licenses_no_self_stress_elsewhere():
    pile = overhang(0.005)
    inverted_v(np.radians(72.0), 0.45, pile, 1.0)
    found = solve_equilibrium(*pile.world(UPRIGHT))
    assert found.verdict == "doubt"
    assert found.in_doubt.tolist() == [True, False, False, False]


@pytest.mark.parametrize("tilt", [-0.001, 0.001])
@pytest.mark.parametrize("outer", [0.0, 0.001])
@pytest.mark.parametrize("excess", [0.001, 0.005])
def test_no_verdict_hangs_on_the_sign_of_a_normals_error(excess, outer, tilt):
    """Tilted one way the side closes as the brick turns, by a thousandth of its slip; the other way it opens."""
    assert verdict(overhang(excess, outer=outer, side_tilt=tilt)) in {"doubt", "unstable"}


@pytest.mark.parametrize("angle", [10.0, 17.0, 24.0])
def test_a_rod_jammed_between_walls_is_a_doubt(angle):
    """Up to atan(0.45) = 24.2 deg forces along the rod lie in both cones, but only a hammer brings them about."""
    assert verdict(rod_between_walls(np.radians(angle), 0.45)) == "doubt"
    assert verdict(rod_between_walls(np.radians(25.0), 0.45)) == "unstable"


@pytest.mark.parametrize(("friction", "expected"), [(0.0, "unstable"), (0.2, "doubt"), (0.8, "doubt")])
def test_a_brick_between_walls_is_held_by_prestress_alone(friction, expected):
    assert verdict(brick_between_walls(friction)) == expected


@pytest.mark.parametrize("angle", [1e-6, 1e-4, 1e-3])
@pytest.mark.parametrize("length", [1e-7, 1e-5, 1e-4])
def test_noise_never_turns_a_fall_into_stable(angle, length):
    """Seed 20261127. The brick's centre is 5 mm outside: noise of the edge moves that by a fiftieth."""
    random = np.random.default_rng(20261127)
    for _ in range(20):
        assert noisy(overhang(0.005), angle, length, random) != "stable"
        assert noisy(overhang(0.005, outer=0.001), angle, length, random) != "stable"
        assert noisy(rod_between_walls(np.radians(17.0), 0.45), angle, length, random) != "stable"


ARCHES = [
    *(("semicircular", n, t, mu, np.pi) for n in (7, 15, 31, 51, 101) for t in (0.12, 0.15, 0.2) for mu in (0.5, 1.0)),
    *(("semicircular", n, 0.108, mu, np.pi) for n in (50, 101) for mu in (0.45, 1.5)),
    *(("segmental", n, 0.1, mu, np.radians(deg)) for n in (9, 30) for deg in (60, 90, 120) for mu in (0.4, 0.8)),
]


def test_there_are_as_many_arches_as_were_attacked():
    assert len(ARCHES) == 46


@pytest.mark.parametrize(("kind", "voussoirs", "thickness", "friction", "embrace"), ARCHES)
def test_an_arch_that_has_an_equilibrium_stands(kind, voussoirs, thickness, friction, embrace):
    """Its joints close as the weight comes on: the thrust arises."""
    assert verdict(arch(voussoirs, thickness, friction, embrace)) == "stable"


@pytest.mark.parametrize("voussoirs", [50, 200])
def test_the_thinnest_arch_is_decided_to_a_tenth_of_a_per_cent(voussoirs):
    assert verdict(arch(voussoirs, 0.1074, 0.45)) == "unstable"
    assert verdict(arch(voussoirs, 0.1075, 0.45)) == "stable"


@pytest.mark.parametrize("thickness", [0.2, 0.3])
def test_an_arch_slides_below_its_least_friction(thickness):
    for share, expected in ((0.998, "unstable"), (1.002, "stable"), (1.15, "stable")):
        assert verdict(arch(50, thickness, share * LEAST_FRICTION)) == expected


@pytest.mark.parametrize("build", [logs, spheres])
@pytest.mark.parametrize("gap", [0.02, 0.05])
def test_more_friction_never_turns_stable_into_doubt(build, gap):
    """First unstable, then stable: in this order for rising friction, also in single precision."""
    for noise in (0.0, 1e-9, 1e-7):
        found = [verdict(build(gap, friction, noise)) for friction in (0.2, 0.33, 0.4, 0.5, 0.65, 0.8, 1.0, 2.0)]
        order = ["unstable", "doubt", "stable"]
        assert found == sorted(found, key=order.index), (noise, found)
        assert found[-1] == "stable"


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-7])
def test_a_sphere_on_a_floor_stands_in_single_precision(noise):
    pile = Pile(0.45)
    pile.add((0.0, 0.0, 1.0), 1.0)
    pile.touch(0, -1, [(noise, -noise, 0.0)])
    assert verdict(pile) == "stable"


def test_a_sphere_rolls_off_its_support():
    pile = Pile(0.45)
    pile.add((0.0, 0.0, 1.0), 1.0)
    pile.touch(0, -1, [(1e-4, 0.0, 0.0)])
    assert verdict(pile) == "unstable"
