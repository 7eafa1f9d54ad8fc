"""The judge and the core against other people's code: the RBE solver of `compas_cra` (see ``rbe.py``)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scenarios.planks import LENGTH, MASS
from scenarios.registry import build
from scenarios.statics.contact_patch import Patch
from scenarios.statics.force_balance import solve_balance
from scenarios.statics.truth import equilibrium
from stability_core import Contacts, Masses, solve_equilibrium
from tests.oracle.rbe import FAMILIES, SOLIDS, at_the_end, of_solids

CASES = json.loads((Path(__file__).parents[1] / "fixtures" / "rbe.json").read_text(encoding="utf-8"))["cases"]
NO_TENSION = 3e-4
"""Of a plank's weight: what stands needs less than 2e-5, the least pile that falls more than 5e-3."""
CIRCUMSCRIBED = 1 / np.cos(np.pi / 8)
"""How far RBE's pyramid of eight sides reaches beyond Coulomb's cone."""
PRECISE = 1e-5
"""Of all weight: the residual that an interior-point solver may leave, besides the tension."""


def stands_by_rbe(case: dict) -> bool:
    return case["tension"] is not None and case["tension"] < NO_TENSION


def ask_the_judge(case: dict, friction: float) -> str:
    """Return the judge's verdict on the existence of forces, which is all that RBE answers."""
    center, mass = np.array(case["center"]), np.array(case["mass"])
    patches = [
        Patch(first, second, np.array([point]), np.array(normal)) for first, second, point, normal in case["contacts"]
    ]
    found = solve_balance(center, np.outer(mass, (0.0, 0.0, -9.81)), patches, friction, LENGTH)
    return {True: "stable", False: "unstable", None: "doubt"}[found.balanced]


def ask_the_core(case: dict, friction: float) -> str:
    first, second, point, normal = (np.array(column) for column in zip(*case["contacts"], strict=True))
    n = len(first)
    contacts = Contacts(first, second, point, normal, np.zeros(n), np.zeros((n, 3)), np.full(n, friction))
    masses = Masses(np.arange(len(case["mass"])), np.array(case["mass"]), np.array(case["center"]))
    return solve_equilibrium(contacts, masses).verdict


@pytest.mark.parametrize("ask", [ask_the_judge, ask_the_core])
def test_verdicts_agree_with_rbe(ask):
    """What falls with the wider pyramid falls; what stands with it stands with as much friction in every direction."""
    for name, case in CASES.items():
        if stands_by_rbe(case):
            assert ask(case, CIRCUMSCRIBED * case["friction"]) == "stable", name
        else:
            assert ask(case, case["friction"]) == "unstable", name


def test_scenes_of_the_catalogue_stand_and_fall_as_they_claim():
    """A second opinion on those that have no closed form (``robbed_stack``), a third on all others."""
    scenes = {name: case for name, case in CASES.items() if "stands" in case}
    assert {case["stands"] for case in scenes.values()} == {True, False}
    assert [name for name, case in scenes.items() if stands_by_rbe(case) != case["stands"]] == []


def test_the_fixture_is_of_the_scenes_as_they_are():
    """A scene that changed needs the fixture anew: see ``rbe.py``."""
    for scenario, parameters in FAMILIES:
        scene = build(scenario, **parameters)
        case = CASES[f"{scene.variant} at the end"]
        assert case["stands"] == (scene.expectation.outcome == "stand"), scene.variant
        assert case["friction"] == scene.world.friction, scene.variant
        assert case["mass"] == pytest.approx([brick.mass for brick in at_the_end(scene)]), scene.variant
        assert np.array(case["center"]) == pytest.approx(
            np.array([brick.position for brick in at_the_end(scene)]), abs=1e-12
        ), scene.variant


def test_the_fixture_is_of_the_solids_as_they_are():
    for scenario, parameters in SOLIDS:
        scene = build(scenario, **parameters)
        case, problem = CASES[f"{scene.variant} at the end"], of_solids(scene)
        if scene.expectation.outcome == "study":  # RBE answers only whether forces exist
            assert case["stands"] == equilibrium(at_the_end(scene), scene.world).balanced, scene.variant
        else:
            assert case["stands"] == (scene.expectation.outcome == "stand"), scene.variant
        assert case["friction"] == problem["friction"], scene.variant
        assert case["mass"] == pytest.approx(problem["mass"]), scene.variant
        assert np.array(case["center"]) == pytest.approx(np.array(problem["center"]), abs=1e-12), scene.variant


def test_forces_of_rbe_hold_the_piles_that_stand():
    """Recomputed with our contacts and signs: no net force and moment, and every force within the wider cone."""
    for name, case in CASES.items():
        if not stands_by_rbe(case):
            continue
        rest = np.zeros((len(case["mass"]) + 1, 6))  # the last row is the ground's
        rest[:-1, 2] = np.multiply(case["mass"], -9.81)
        center = np.vstack([case["center"], np.zeros(3)])
        weight = -rest[:, 2].sum()
        for (first, second, point, normal), force in zip(case["contacts"], np.array(case["forces"]), strict=True):
            for body, sign in ((first, -1.0), (second, 1.0)):
                rest[body] += sign * np.concatenate([force, np.cross(point - center[body], force) / LENGTH])
            along = force @ normal
            across = np.linalg.norm(force - along * np.array(normal))
            assert across <= CIRCUMSCRIBED * case["friction"] * along + PRECISE * weight, name
        assert np.abs(rest[:-1]).max() < PRECISE * weight, name


def test_the_cases_are_of_both_kinds():
    """Neither side may have been lost: RBE has accepted and refused scenes and random piles alike."""
    for kind in ("pile", "a", "of"):
        verdicts = {stands_by_rbe(case) for name, case in CASES.items() if kind in name}
        assert verdicts == {True, False}, kind
    tensions = [case["tension"] for case in CASES.values() if case["tension"] is not None]
    assert not any(NO_TENSION / 10 < tension < 10 * NO_TENSION for tension in tensions), "no case is a matter of taste"
    assert max(max(case["mass"]) for case in CASES.values()) < 10 * MASS, "the tension is in weights of a plank"
