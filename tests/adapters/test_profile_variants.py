"""Profiles varied by name: frame rate, distance from the origin, and any knob of the engine."""

import math

import numpy as np
import pytest

from adapters import ProfileError, open_engine, profile_named
from adapters.conformance.rig import plank
from scenarios.lookup import UnknownNameError
from stability_core.port import GROUND

ENGINES = ("bullet", "mujoco", "dart", "physx", "rapier", "box3d", "ode", "pymunk")
KNOBS = {
    "bullet": ("numSolverIterations", 77),
    "mujoco": ("option.impratio", 5.0),
    "dart": ("matrix_free_max_iterations", 99),
    "physx": ("solver_position_iterations", 7),
    "rapier": ("contact_softness.natural_frequency", 120.0),
    "box3d": ("contactRecycleDistance", 0.01),
    "ode": ("ERP", 0.25),
    "pymunk": ("iterations", 5),
}


@pytest.mark.parametrize("engine", ENGINES)
def test_any_knob_goes_by_its_name_and_reaches_the_engine(engine: str) -> None:
    name, value = KNOBS[engine]
    simulation = open_engine(engine, f"game@{name}={value}")
    try:
        simulation.spawn(plank())
        assert simulation.read_knobs()[name] == pytest.approx(value)
    finally:
        simulation.close()


@pytest.mark.parametrize("engine", ENGINES)
def test_a_brick_far_from_the_origin_rests_on_the_same_ground(engine: str) -> None:
    """A plank lies where it was put, to 10 um sideways more than at the origin; contacts are in the scene's places."""
    rested = {}
    for profile in ("game", "game@offset=100"):
        simulation = open_engine(engine, profile, expected=[plank()])
        try:
            simulation.spawn(plank())
            for _ in range(30):
                simulation.step(simulation.info.frame_s)
            rested[profile] = simulation.poses()[1][0]
            contacts = simulation.port.contacts()
            assert set(contacts.body_b.tolist()) | set(contacts.body_a.tolist()) == {0, GROUND}
            assert np.abs(contacts.point[:, 0]).max() < 0.06
        finally:
            simulation.close()
    assert rested["game@offset=100"] == pytest.approx(rested["game"], abs=2e-5)


@pytest.mark.parametrize("text", ["false", "False"])
def test_a_knob_that_is_true_or_false_goes_by_name_as_profiles_show_it(text: str) -> None:
    assert profile_named("dart", "game").knobs["matrix_free"].value is True
    assert profile_named("dart", f"game@matrix_free={text}").knobs["matrix_free"].value is False


def test_the_frame_rate_goes_by_name() -> None:
    profile = profile_named("bullet", "game@hz=240")
    assert profile.frame_s == pytest.approx(1 / 240)
    assert profile.substeps == profile_named("bullet", "game").substeps
    assert profile_named("bullet", "game@hz=50,offset=10,contactERP=0.2").knobs["contactERP"].value == 0.2


@pytest.mark.parametrize(
    ("profile", "message"),
    [
        ("game@hz=0", "hz must be frames a second"),
        ("game@offset=inf", "offset must be a finite number"),
        ("game@numSolverIterations=many", "'numSolverIterations' must be a whole number, such as 200, got 'many'"),
    ],
)
def test_a_value_that_makes_no_sense_is_refused(profile: str, message: str) -> None:
    with pytest.raises(ProfileError, match=message):
        profile_named("bullet", profile)


def test_a_misspelt_knob_is_refused() -> None:
    with pytest.raises(
        UnknownNameError,
        match=r"variation of a profile of engine 'bullet' 'contactErp'.*'contactERP'.* Use one of scale, .*contactERP",
    ):
        profile_named("bullet", "game@contactErp=0.2")


def test_a_length_that_follows_the_world_grows_with_it_whatever_comes_first() -> None:
    first, last = (
        profile_named("physx", f"game@{names}")
        for names in ("scale=10,contact_offset=0.002", "contact_offset=0.002,scale=10")
    )
    assert math.isclose(float(first.knobs["contact_offset"].value), 0.02)
    assert math.isclose(float(last.knobs["contact_offset"].value), 0.02)
