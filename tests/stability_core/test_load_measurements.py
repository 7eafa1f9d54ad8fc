"""The measurements of loads measure what they say. What they find is on their pages, not here."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bench.trial.own_contacts import PRECISION
from scenarios.planks import MASS, MU, THICKNESS
from tests.stability_core import pile_cost, steady_force, struck_wall, tilt
from tests.stability_core.loaded_stacks import ARMS, kept_runs, standing

G = 9.81


def test_a_run_that_is_kept_is_not_played_again(tmp_path):
    played = []

    def play(engine, number):
        played.append((engine, number))
        return {"figure": 2 * number}

    assert kept_runs("some", "core", [("a", 1)], play, tmp_path) == [{"key": ["a", 1], "figure": 2}]
    found = kept_runs("some", "core", [("a", 1), ("a", 2)], play, tmp_path)
    assert [row["figure"] for row in found] == [2, 4]
    kept_runs("some", "other core", [("a", 1)], play, tmp_path)
    assert played == [("a", 1), ("a", 2), ("a", 1)]


@pytest.mark.parametrize(("arm", "is_frozen"), [("alone", False), ("equilibrium", True)])
def test_a_stack_stands_in_place_before_anything_happens(arm, is_frozen):
    with standing("mujoco", "tuned", ARMS[arm], struck_wall.TOWER[:3]) as stack:
        assert stack.is_frozen == is_frozen
        assert stack.off_plan < 1e-4
        assert stack.simulation.info.profile.forces
    assert ARMS["equilibrium, no forces"].profile("game") == "game@forces=0"


class TestStruckWall:
    def test_the_wall_has_25_planks_and_is_struck_at_a_third_of_its_height(self):
        assert len(struck_wall.WALL) == 25
        striker = struck_wall.STRIKES["thrown at 2 m/s"].striker(np.zeros(3))
        assert striker.position[2] == pytest.approx(10 * THICKNESS / 3)

    @pytest.mark.parametrize("name", struck_wall.STRIKES)
    def test_a_striker_arrives_when_and_as_fast_as_is_said(self, name):
        strike = struck_wall.STRIKES[name]
        start = strike.striker(np.zeros(3)).position[strike.along]
        face = min(brick.position[strike.along] - brick.size[strike.along] / 2 for brick in strike.stack)
        way = face - strike.edge / 2 - start
        first = strike.impulse[strike.along] / strike.mass
        slowing = MU * G if strike.slides else 0.0
        assert first * strike.blow_s - slowing * strike.blow_s**2 / 2 == pytest.approx(way)
        assert first - slowing * strike.blow_s == pytest.approx(strike.speed)

    def test_shifts_are_small_and_the_same_in_every_arm(self):
        shifts = np.array([struck_wall.shift_of(run) for run in range(20)])
        assert np.abs(shifts).max() <= 0.5e-3
        assert np.abs(shifts).max(axis=0).min() > 0.3e-3
        assert (struck_wall.shift_of(3) == shifts[3]).all()
        striker = struck_wall.STRIKES["slow push"].striker(shifts[0])
        assert striker.position[2] == striker.size[2] / 2, "it stays on the ground"

    def test_medians_must_lie_in_the_widened_range_and_flights_below_their_limit(self):
        alone = [
            {"displaced": n, "momentum": 0.1 + 0.001 * n, "farthest": 0.1, "diverged": False} for n in range(10, 21)
        ]
        assert struck_wall.wide_range([0.0, 1.0], "by length") == pytest.approx((0.05 - 0.225, 0.95 + 0.225))
        assert struck_wall.wide_range([0.0, 1.0], "by ends") == pytest.approx((0.75 * 0.05, 1.25 * 0.95))

        def run(displaced, momentum, farthest, diverged=False):
            figures = {"displaced": displaced, "momentum": momentum, "farthest": farthest, "diverged": diverged}
            return struck_wall.failures(alone, [figures])

        both = struck_wall.READINGS
        assert run(20, 0.12, 0.14) == {"displaced": (), "momentum": (), "farthest": ()}
        assert run(0, 0.5, 0.16) == {"displaced": both, "momentum": both, "farthest": both}
        assert run(22, 0.12, 0.14)["displaced"] == ("by length",)
        assert run(20, 0.12, 0.14, diverged=True)["farthest"]
        alone[0]["diverged"] = True
        assert "farthest" not in run(20, 0.12, 0.14), "there is nothing to compare with"

    def test_a_run_gives_all_figures_of_the_page(self):
        keys = [("bullet", "tuned", "slow push", arm, 0) for arm in ("alone", "equilibrium")]
        rows = [{"key": list(key), **struck_wall.play(*key)} for key in keys]
        assert rows[0]["off_plan"] < struck_wall.MOST_OFF_PLAN
        assert not rows[0]["frozen"]
        assert rows[1]["frozen"]
        assert rows[0]["displaced"] == 8
        assert 0.0 < rows[0]["momentum"] < 0.45
        page = struck_wall.page(rows)
        assert page.count("| bullet | tuned |") == 2


class TestSteadyForce:
    def test_each_draw_is_played_with_every_factor(self):
        cases = list(steady_force.cases(200))
        assert len(set(cases)) == 200
        assert cases[:5] == [(0, 0.5), (0, 0.9), (0, 1.1), (0, 2.0), (0, 10.0)]

    def test_the_limit_of_a_cube_at_a_tower_is_the_friction_of_all(self):
        draw = steady_force.draw_of(0)
        assert (draw.kind, draw.through) == ("tower", "cube")
        weight = G * sum(brick.mass for brick in draw.bricks)
        assert draw.limit == pytest.approx(MU * weight, rel=2e-3)

    def test_the_limit_of_a_topmost_plank_is_its_friction(self):
        bricks = steady_force.plank_tower(levels=3).bricks
        assert steady_force.limit_of(bricks, (1.0, 0.0, 0.0), 1.0) == pytest.approx(MU * MASS * G, rel=2e-3)
        assert steady_force.limit_of(bricks, (0.0, 0.0, -1.0), 1.0) == math.inf

    @pytest.mark.parametrize(("factor", "moved", "is_right"), [(0.9, False, True), (0.9, True, False), (2, True, True)])
    def test_what_exceeds_the_limit_must_move(self, factor, moved, is_right):
        row = {"key": ["bullet", "tuned", "alone", 0, factor], "moved": moved, "kind": "tower", "through": "cube"}
        assert steady_force.is_right(row) == is_right
        assert ("% **no**" in steady_force.page([row])) != is_right

    def test_a_plank_that_is_pressed_beyond_its_friction_slides(self):
        stack = steady_force.plank_tower(levels=2).bricks
        for factor in (0.5, 2.0):
            with standing("mujoco", "tuned", ARMS["alone"], stack) as stands:
                found = steady_force._pressed(stands, None, (1.0, 0.0, 0.0), factor * MU * MASS * G)
            assert found["moved"] == (factor > 1)


class TestTilt:
    def test_statics_gives_the_known_angles(self):
        assert tilt.STACKS["column along"].exact == pytest.approx(24.228, abs=1e-3)
        across = tilt.STACKS["column across"]
        assert across.exact == pytest.approx(16.699, abs=1e-3)
        centers = np.array([brick.position for brick in across.bricks])
        found = tilt.limit_angle(across, tilt.contact_patches(across.bricks), centers)
        assert found == pytest.approx(across.exact, abs=2 * PRECISION)

    def test_a_v_that_is_tilted_across_has_one_limit_whatever_the_ridge(self):
        least, most = tilt.exact_angles(tilt.STACKS["V across"])
        assert least == pytest.approx(most, abs=2 * PRECISION)

    def test_what_wakes_late_or_not_at_all_does_not_pass(self):
        alone = {"onset": 10.3}
        run = {"exact": 10.0, "own": 10.1, "wake": 10.14, "onset": 10.5}
        assert tilt.passes(alone, run) == {"wake": True, "onset": True}
        assert tilt.passes(alone, run | {"wake": 10.2, "onset": 10.6}) == {"wake": False, "onset": False}
        assert tilt.passes(alone, run | {"wake": None, "onset": None}) == {"wake": False, "onset": False}
        assert "onset" not in tilt.passes({"onset": None}, run)

    def test_a_run_finds_the_angles(self, monkeypatch):
        monkeypatch.setattr(tilt, "FAST", 60.0)
        monkeypatch.setattr(tilt, "SLOW", 2.0)
        rows = []
        for policy in tilt.POLICIES:
            key = ("mujoco", "game", "V across", policy)
            rows.append({"key": list(key), **tilt.play(*key)})
        assert rows[1]["frozen"]
        assert rows[1]["own"] == pytest.approx(rows[1]["exact"], abs=0.3)
        assert rows[1]["wake"] is not None
        assert "| mujoco | game | all |" in tilt.page(rows)


class TestPileCost:
    def test_the_spread_is_that_of_medians_over_ten_seconds(self):
        assert pile_cost.spread([1.0] * 9 + [5.0] + [1.1] * 10 + [9.0]) == pytest.approx(0.1 / 1.05)
        assert pile_cost.spread([1.0, 2.0]) == 0.0

    def test_a_small_pile_is_poured_and_timed(self):
        key = ("bullet", 3, 1, 1)
        row = {"key": list(key), **pile_cost.play(*key)}
        assert 0 <= row["core"][0] <= row["core"][-1]
        assert row["engine"][0] > 0.0
        assert 0.0 <= row["frozen"] <= 1.0
        assert "| bullet | 3 | 1 | yes |" in pile_cost.page([row])
