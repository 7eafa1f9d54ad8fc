"""The examples of docs/using_it_in_your_engine.md do what the page says, and stay short."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parent.parent / "docs"
EXAMPLES = ("pybullet_tower", "mujoco_gripper", "gymnasium_stacking", "pymunk_toy")


def example(name: str) -> dict[str, Any]:
    return runpy.run_path(str(DOCS / "examples" / f"{name}.py"))


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_is_short_and_has_a_picture_and_a_link(name: str) -> None:
    page = (DOCS / "using_it_in_your_engine.md").read_text(encoding="utf-8")
    assert len((DOCS / "examples" / f"{name}.py").read_text(encoding="utf-8").splitlines()) < 80
    assert f"(examples/{name}.py)" in page
    assert f"(pictures/{name}.png)" in page
    assert (DOCS / "pictures" / f"{name}.png").stat().st_size > 1000


def test_a_tower_in_pybullet_freezes_one_by_one_and_prebuilt() -> None:
    tower = example("pybullet_tower")
    assert tower["one_a_second"](2) == [1, 2]
    assert tower["prebuilt"](8) == list(range(1, 9))


def test_a_ball_unfreezes_the_top_of_a_tower_in_pymunk_and_not_its_foot(monkeypatch) -> None:
    """The ball strikes the last of eight blocks, and drives it on by half a block at least."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame")
    toy, screen = example("pymunk_toy")["Toy"](), pygame.Surface((640, 400))
    blocks = []
    for level in range(8):
        blocks.append(toy.add_block(300, 380 - (level + 0.55) * 20))
        toy.play(60)
    toy.draw(screen)
    assert [toy.extension.body_of(body) for body in toy.extension.frozen] == blocks
    assert screen.get_at((300, 370)) == pygame.Color("peru")
    toy.throw_ball(270, 229)
    toy.play(36)
    toy.draw(screen)
    assert blocks[7].position.x > 330
    assert screen.get_at(tuple(map(round, blocks[7].position))) == pygame.Color("orange")
    assert screen.get_at((300, 370)) == pygame.Color("peru")


@pytest.mark.slow
def test_a_gripper_stacks_four_parts_and_topples_them() -> None:
    """The centres of parts of 50 mm stand at 25, 75, 125 and 175 mm; afterwards the upper ones lie on the floor."""
    stacked, toppled = example("mujoco_gripper")["main"]()
    assert stacked == pytest.approx([0.025, 0.075, 0.125, 0.175], abs=2e-3)
    assert max(toppled) < 0.05


@pytest.mark.slow
def test_an_episode_ends_early_without_the_extension_and_in_full_with_it() -> None:
    """The page names both numbers."""
    play = example("gymnasium_stacking")["play"]
    with play(False) as env:
        assert len(env.bricks) == 14
    with play(True) as env:
        assert len(env.bricks) == 20
