"""Proofs fail closed: none outlives what it was made with, and what is in doubt is frozen late and woken at once."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Settings, StabilityExtension
from tests.stability_core.dwell import REST_FRAMES
from tests.stability_core.masonry import tilted

DT = 1 / 60
SETTINGS = Settings()
SOON = 5 * REST_FRAMES
LATER = int(SETTINGS.doubt_s / DT) + 2 * REST_FRAMES
WIDE, DEEP, THICKNESS = (-0.05, 0.05), (-0.01, 0.01), 0.01


def frames(extension, n: int) -> list:
    return [extension.update(DT) for _ in range(n)]


@pytest.fixture
def extension(port) -> StabilityExtension:
    return StabilityExtension(port, "equilibrium")


def pedestal(port, body: int, x: float, half: float = 0.05) -> None:
    port.add(body, (x, 0.0, 0.05), mass=10.0)
    port.lay(body, GROUND, (x - half, x + half), DEEP, 0.0)


def overhang_beside_neighbour(port, excess: float) -> None:
    """A brick 2 whose centre lies ``excess`` beyond pedestal 0, its inner end against the heavy neighbour 1."""
    pedestal(port, 0, -0.1, half=0.1)
    port.add(1, (excess - 0.1, 0.0, 0.105), mass=10.0)
    port.lay(1, 0, (excess - 0.15, excess - 0.05), DEEP, 0.1)
    port.add(2, (excess, 0.0, 0.105))
    port.lay(2, 0, (excess - 0.05, 0.0), DEEP, 0.1)
    side = [(excess - 0.05, y, z) for y in DEEP for z in (0.1, 0.11)]
    port.touch(2, 1, side, normal=(1.0, 0.0, 0.0))


def test_what_a_neighbours_side_could_hold_is_frozen_only_once_the_engine_has_held_it(port, extension):
    overhang_beside_neighbour(port, 0.005)
    frames(extension, SOON)
    assert port.frozen == {0, 1}
    changes = frames(extension, LATER)
    assert port.frozen == {0, 1, 2}
    assert {change.reasons.get(2) for change in changes} == {None, "held by the engine"}


def test_its_mirror_image_is_frozen_at_once(port, extension):
    overhang_beside_neighbour(port, -0.005)
    frames(extension, SOON)
    assert port.frozen == {0, 1, 2}


def test_an_engine_that_does_not_hold_it_is_never_overruled(port, extension):
    """The brick sinks by 0.3 mm a second: slow enough for every rule of rest, too fast to be held."""
    overhang_beside_neighbour(port, 0.005)
    for frame in range(3 * LATER):
        port.center[2] = (0.005, 0.0, 0.105 - 0.3e-3 * frame * DT)
        extension.update(DT)
    assert port.frozen == {0, 1}


@pytest.mark.parametrize("change", ["load", "neighbour", "mass", "support's neighbour"])
def test_what_is_in_doubt_wakes_at_any_change(port, extension, change):
    overhang_beside_neighbour(port, 0.005)
    frames(extension, SOON + LATER)
    assert port.frozen == {0, 1, 2}
    if change == "load":
        port.add(3, (0.0, 0.0, 0.115), mass=0.001)
        port.lay(3, 2, (-0.005, 0.005), DEEP, 0.11)
    elif change == "neighbour":
        port.remove(1)
    elif change == "mass":
        port.mass[2] = 2.0
        port.show_frozen = True
    else:
        extension.disturb([1])
    assert {body for update in frames(extension, SOON) for body in update.woken} >= {2}


def test_a_doubt_elsewhere_does_not_keep_others_live(port, extension):
    """A column far off has no part in it."""
    overhang_beside_neighbour(port, 0.005)
    port.add(3, (1.0, 0.0, 0.005))
    port.lay(3, GROUND, (0.95, 1.05), DEEP, 0.0)
    frames(extension, SOON)
    assert port.frozen == {0, 1, 3}


def test_no_friction_across_a_gap(port, extension):
    """A neighbour 0.1 mm away holds nothing: the brick falls, by a proof."""
    overhang_beside_neighbour(port, 0.005)
    port.touches[-1].separation = 0.1e-3
    frames(extension, SOON + LATER)
    assert port.frozen == {0, 1}


def test_a_proof_with_a_live_counterweight_goes_with_it(port, extension):
    """A plank beyond a pedestal, propped; the prop goes while a character fidgets on the inner end; then that goes."""
    pedestal(port, 0, -0.05)
    port.add(1, (0.015, 0.0, 0.105))
    port.lay(1, 0, (-0.035, 0.0), DEEP, 0.1)
    port.add(2, (0.055, 0.0, 0.05))
    port.lay(2, GROUND, (0.05, 0.06), DEEP, 0.0)
    port.lay(1, 2, (0.05, 0.06), DEEP, 0.1)
    frames(extension, SOON)
    assert port.frozen == {0, 1, 2}

    def fidget(n: int) -> set[int]:
        woken: set[int] = set()
        for frame in range(n):
            port.center[3] = (-0.03, 2e-4 * (frame % 2), 0.12)
            woken.update(extension.update(DT).woken)
        return woken

    port.add(3, (-0.03, 0.0, 0.12), mass=1.0)
    port.lay(3, 1, (-0.035, -0.025), DEEP, 0.11, velocity=(0.0, 0.02, 0.0))
    assert fidget(20) == set()
    port.remove(2)
    assert fidget(20) == set(), "the character holds the plank: 30 mm inside against 15 mm outside"
    port.remove(3)
    assert {body for change in frames(extension, SOON) for body in change.woken} == {1}


@pytest.mark.parametrize("friction", [0.0, 0.01, 0.2])
def test_a_brick_between_walls_falls_with_its_prop(port, extension, friction):
    """Both walls are the ground: their normals must not be averaged into nothing."""
    port.add(0, (0.0, 0.0, 0.05))
    port.lay(0, GROUND, (-0.01, 0.01), DEEP, 0.0)
    port.add(1, (0.0, 0.0, 0.15))
    port.lay(1, 0, (-0.01, 0.01), DEEP, 0.1)
    for side in (-1.0, 1.0):
        corners = [(side * 0.05, y, z) for y in DEEP for z in (0.1, 0.2)]
        port.touch(1, GROUND, corners, normal=(-side, 0.0, 0.0), friction=friction)
    frames(extension, SOON)
    assert port.frozen == {0, 1}
    port.remove(0)
    assert {body for change in frames(extension, 2) for body in change.woken} == {1}
    assert port.frozen == set()


@pytest.mark.parametrize(("friction", "stands"), [(0.05, False), (0.4, True)])
def test_a_bar_in_a_groove_slides_iff_the_walls_do_not_hold_it(port, extension, friction, stands):
    """A groove of 90 deg, down 15 deg: N = W cos 15 / sqrt(2) on each wall, so it slides iff tan 15 > mu sqrt 2."""
    assert (np.tan(np.radians(15.0)) < friction * np.sqrt(2.0)) == stands
    turn = np.array([[np.cos(0.2618), 0.0, np.sin(0.2618)], [0.0, 1.0, 0.0], [-np.sin(0.2618), 0.0, np.cos(0.2618)]])
    port.add(0, tuple(turn @ (0.0, 0.0, 0.01)))
    for side in (-1.0, 1.0):
        points = [tuple(turn @ (x, side * 0.01, 0.0)) for x in WIDE]
        port.touch(0, GROUND, points, normal=tuple(turn @ (0.0, -side / 2**0.5, 0.5**0.5)), friction=friction)
    frames(extension, SOON)
    assert (port.frozen == {0}) == stands


@pytest.mark.parametrize("policy", ["equilibrium", "paper"])
def test_the_low_end_of_a_tilted_plank_carries_a_block(port, policy):
    """The plank's centre is the higher one, yet the block stands on it, and tips it about the lower edge."""
    extension = StabilityExtension(port, policy)
    up = tilted((0.0, 0.0, 1.0), 0.0)
    angle = np.radians(15.0)
    along, across = np.array([np.cos(angle), 0.0, np.sin(angle)]), np.array([-np.sin(angle), 0.0, np.cos(angle)])
    center = np.array([0.0, 0.0, 0.2])
    port.add(0, tuple(center))
    for s in (-0.05, 0.05):
        edge = center + s * along - 0.005 * across
        port.touch(0, GROUND, [tuple(edge + np.array([0.0, y, 0.0])) for y in DEEP], normal=tuple(across))
    frames(extension, SOON)
    assert port.frozen == {0}
    block = center - 0.13 * along + 0.015 * across
    port.add(1, tuple(block), mass=5.0)
    corners = [tuple(block - 0.01 * across + s * along + np.array([0.0, y, 0.0])) for s in (-0.01, 0.01) for y in DEEP]
    port.touch(1, 0, corners, normal=tuple(across))
    woken = {body for change in frames(extension, 3 * SOON) for body in change.woken}
    assert up == (0.0, 0.0, 1.0)
    assert 0 in woken
    assert port.frozen == set()


@pytest.mark.parametrize("policy", ["equilibrium", "paper", "at_rest"])
def test_a_ceiling_carries_nothing(port, policy):
    """A column from floor to ceiling whose lower bricks are taken: the topmost falls."""
    extension = StabilityExtension(port, policy)
    for body in range(3):
        port.add(body, (0.0, 0.0, (body + 0.5) * THICKNESS))
        port.lay(body, body - 1 if body else GROUND, WIDE, DEEP, body * THICKNESS)
    port.touch(2, GROUND, [(x, y, 3 * THICKNESS) for x in WIDE for y in DEEP], normal=(0.0, 0.0, -1.0))
    frames(extension, 3 * SOON)
    assert port.frozen == {0, 1, 2}
    port.remove(0)
    port.remove(1)
    assert {body for change in frames(extension, SOON) for body in change.woken} == {2}
    frames(extension, SOON)
    assert port.frozen == set()


def test_a_steep_face_keeps_its_four_corners(port, extension):
    """Seen from above a wall's contact is a line: its height must not be lost."""
    port.add(0, (0.0, 0.0, 0.01))
    port.lay(0, GROUND, WIDE, DEEP, 0.0)
    port.touch(0, GROUND, [(-0.05, y, z) for y in DEEP for z in (0.0, 0.02)], normal=(1.0, 0.0, 0.0))
    frames(extension, SOON)
    patches = extension._world.graph.patches
    steep = patches[(patches["kind"] == 1) & (patches["vertices"] > 0)]
    assert steep["vertices"].tolist() == [4]
    assert sorted(steep["vertex"][0, :4, 2]) == pytest.approx([0.0, 0.0, 0.02, 0.02])
