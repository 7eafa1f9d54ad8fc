"""Contact forces are means over a frame, stay with their rows, and can be switched off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from adapters import open_engine
from adapters.profile_variants import ProfileError
from adapters.shared.contact_completion import joined
from adapters.shared.contact_forces import SubstepForces, mean_force
from scenarios.planks import lay
from stability_core.port import Contacts, Masses
from stability_core.validation import check_shapes

UP = np.array([[0.0, 0.0, 1.0]])


def rows(*pairs: tuple[int, int], force: list[float]) -> SubstepForces:
    body_a, body_b = np.array(pairs, np.int64).T
    return SubstepForces(body_a, body_b, np.array(force)[:, None] * UP)


def contacts_of(last: SubstepForces) -> Contacts:
    n = len(last.body_a)
    zeros = np.zeros((n, 3))
    return Contacts(last.body_a, last.body_b, zeros, UP.repeat(n, 0), zeros[:, 0], zeros, zeros[:, 0], last.force)


def test_the_force_of_a_pair_is_its_mean_over_the_substeps() -> None:
    """Two points bear 1 N and 3 N, after substeps of 2 N and 6 N: 4 N on average, in the shares of the last one."""
    last = rows((-1, 0), (-1, 0), force=[1.0, 3.0])
    earlier = [rows((-1, 0), force=[2.0]), rows((-1, 0), (-1, 0), force=[2.0, 4.0])]
    assert mean_force(last, UP.repeat(2, 0), earlier)[:, 2] == pytest.approx([1.0, 3.0])


def test_a_force_is_turned_where_an_engine_names_the_pair_the_other_way_round() -> None:
    last = rows((4, 7), force=[1.0])
    assert mean_force(last, UP, [rows((7, 4), force=[-3.0])])[:, 2] == pytest.approx([2.0])


def test_a_point_without_force_takes_an_equal_part_of_what_came_earlier() -> None:
    last = rows((4, 7), (4, 7), (1, 2), force=[0.0, 0.0, 5.0])
    earlier = [rows((4, 7), force=[4.0])]
    assert mean_force(last, UP.repeat(3, 0), earlier)[:, 2] == pytest.approx([1.0, 1.0, 2.5])


def test_forces_of_pairs_that_came_apart_are_left_out() -> None:
    last = rows((1, 2), force=[1.0])
    assert mean_force(last, UP, [rows((0, 1), (-1, 9), force=[8.0, 8.0])])[:, 2] == pytest.approx([0.5])


def test_points_added_from_geometry_bear_nothing() -> None:
    """Each list keeps its own rows, whichever has forces."""
    output = contacts_of(rows((0, 1), (0, 1), force=[1.0, 2.0]))
    silent = replace(output, force=None)
    assert joined(output, silent).force[:, 2] == pytest.approx([1.0, 2.0, 0.0, 0.0])
    assert joined(silent, output).force[:, 2] == pytest.approx([0.0, 0.0, 1.0, 2.0])
    assert joined(silent, silent).force is None


def test_chosen_rows_keep_their_forces() -> None:
    output = contacts_of(rows((0, 1), (0, 2), (0, 3), force=[1.0, 2.0, 3.0]))
    assert output.chosen(np.array([True, False, True])).force[:, 2] == pytest.approx([1.0, 3.0])
    assert replace(output, force=None).chosen(np.array([2])).force is None


def test_forces_of_the_wrong_shape_are_refused() -> None:
    output = contacts_of(rows((0, 1), (0, 2), force=[1.0, 2.0]))
    masses = Masses(np.array([0]), np.array([1.0]), np.zeros((1, 3)))
    check_shapes(output, masses)
    check_shapes(replace(output, force=None), masses)
    with pytest.raises(ValueError, match=r"contacts.force must be None or have shape \(2, 3\), .* got \(2,\)"):
        check_shapes(replace(output, force=np.zeros(2)), masses)
    with pytest.raises(ValueError, match=r"contacts.force must be a NumPy array, got list"):
        check_shapes(replace(output, force=[[0.0, 0.0, 0.0]] * 2), masses)  # type: ignore[arg-type]


@pytest.mark.parametrize("engine", ["bullet", "mujoco", "dart", "physx", "rapier", "box3d", "ode"])
def test_a_profile_without_forces_reports_none_and_moves_alike(engine: str) -> None:
    ends = []
    for profile in ("tuned", "tuned@forces=0"):
        simulation = open_engine(engine, profile)
        try:
            port = simulation.port
            simulation.spawn(lay(0.0, level=1))
            for _ in range(10):
                simulation.step(simulation.info.frame_s)
            contacts = port.contacts()
            assert len(contacts)
            assert (contacts.force is None) == profile.endswith("forces=0")
            ends.append(np.hstack(simulation.poses()[1:]).tobytes())
        finally:
            simulation.close()
    assert ends[0] == ends[1], "reading forces must not change a pose by a bit"


def test_forces_are_on_or_off() -> None:
    with pytest.raises(ProfileError, match=r"forces must be 0 \(contacts without forces\) or 1, got '2'"):
        open_engine("bullet", "game@forces=2")
