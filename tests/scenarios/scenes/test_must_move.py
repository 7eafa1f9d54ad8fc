"""How long what must move takes: by closed form, by the judge, and by integrating the equation of motion."""

import math

import pytest
from scipy.integrate import quad, solve_ivp

from scenarios.model import Remove
from scenarios.registry import build
from scenarios.scenes.asleep import FALL_S
from scenarios.scenes.tipping_post import BALANCE, HEIGHT, WIDTH, post_fall_s
from scenarios.statics.falling import fall_time
from scenarios.statics.truth import equilibrium, first_fall

G = 9.81
FLAT = 90.0 - BALANCE


def motion(_, state):
    """The whole equation of motion of a post that turns about its edge: I phi'' = m g R sin(phi)."""
    inertia, arm = (WIDTH**2 + HEIGHT**2) / 3, math.hypot(WIDTH, HEIGHT) / 2
    return [state[1], G * arm * math.sin(state[0]) / inertia]


def integrated(start: float, end: float) -> float:
    def is_there(_, state):
        return state[0] - math.radians(end)

    is_there.terminal = True
    begin = [math.radians(start), 0.0]
    return solve_ivp(motion, (0, 10), begin, events=is_there, rtol=1e-10, atol=1e-13).t_events[0][0]


@pytest.mark.parametrize(("beyond", "flat", "fallen"), [(0.2, 1.77, 1.313), (0.05, 2.14, 1.673)])
def test_a_post_falls_in_its_time(beyond: float, flat: float, fallen: float) -> None:
    assert post_fall_s(beyond, FLAT) == pytest.approx(integrated(beyond, FLAT), abs=1e-6)
    assert post_fall_s(beyond, FLAT) == pytest.approx(flat, abs=0.006)
    assert post_fall_s(beyond, beyond + 15.0) == pytest.approx(integrated(beyond, beyond + 15.0), abs=1e-6)
    assert post_fall_s(beyond, beyond + 15.0) == pytest.approx(fallen, abs=1e-3)


def test_energy_gives_the_same_time() -> None:
    """phi' = sqrt(2 k (cos(phi0) - cos(phi))), from 1 to 15 degrees beyond the balance."""
    k = 3 * G / (2 * math.hypot(WIDTH, HEIGHT))
    first = math.radians(1.0)
    seconds, _ = quad(
        lambda phi: 1 / math.sqrt(2 * k * (math.cos(first) - math.cos(phi))), first, math.radians(15.0), limit=200
    )
    assert post_fall_s(1.0, 15.0) == pytest.approx(seconds, rel=1e-6)


@pytest.mark.parametrize("beyond", [0.05, 0.2])
def test_the_judge_lets_the_post_fall_at_once_and_in_the_same_time(beyond: float) -> None:
    """It sees a slide by the post's width first, at 11.4 degrees; its motion is linear in the angle: 2 %."""
    scene = build("tipping_post", beyond=beyond)
    assert first_fall(scene) == scene.expectation.level == 1
    slid = math.degrees(math.asin(2 * WIDTH / math.hypot(WIDTH, HEIGHT) + math.sin(math.radians(beyond))))
    assert fall_time(scene.bricks, scene.world) == pytest.approx(post_fall_s(beyond, slid), rel=0.02)


@pytest.mark.parametrize(("beyond", "mm_s"), [(0.2, 22.0), (0.05, 5.7)])
def test_after_half_a_second_it_moves_slower_than_sleeping_rules_see(beyond: float, mm_s: float) -> None:
    _, speed = solve_ivp(motion, (0, 0.5), [math.radians(beyond), 0.0], rtol=1e-10, atol=1e-13).y[:, -1]
    assert 1e3 * speed * math.hypot(WIDTH, HEIGHT) / 2 == pytest.approx(mm_s, rel=0.03)


def test_a_block_whose_support_goes_falls_by_a_fifth_of_a_metre_in_a_fifth_of_a_second() -> None:
    scene = build("asleep")
    assert pytest.approx(0.202, abs=5e-4) == FALL_S
    steps = 20_000
    distance = sum(G * (FALL_S / steps) * (step + 0.5) * (FALL_S / steps) for step in range(steps))
    assert distance == pytest.approx(0.2, rel=1e-6)
    assert isinstance(scene.actions[-1], Remove)
    assert first_fall(scene) == scene.expectation.level == 2
    assert equilibrium(scene.bricks, scene.world).stable


def test_a_striker_tips_a_plank_that_lies_balanced() -> None:
    scene = build("asleep", case="striker")
    assert equilibrium(scene.bricks[:2], scene.world).stable
    assert first_fall(scene) == scene.expectation.level == 3
