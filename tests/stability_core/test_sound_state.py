"""Bad input and failing ports: one clear error, and a state that the next frame can go on from."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses, Settings, StabilityExtension, solve_equilibrium
from tests.stability_core.dwell import REST_FRAMES

DT = 1 / 60
WIDE, DEEP, THICKNESS = (-0.05, 0.05), (-0.01, 0.01), 0.01
SOON = 5 * REST_FRAMES


def column(port, planks: int) -> None:
    for body in range(planks):
        port.add(body, (0.0, 0.0, (body + 0.5) * THICKNESS))
        port.lay(body, body - 1 if body else GROUND, WIDE, DEEP, body * THICKNESS)


class Spoiled:
    """A port whose answers a test spoils for some frames."""

    def __init__(self, port) -> None:
        self.port = port
        self.spoil_contacts = self.spoil_masses = lambda table: table
        self.raises: set[str] = set()

    def contacts(self) -> Contacts:
        return self.spoil_contacts(self.port.contacts())

    def masses(self) -> Masses:
        return self.spoil_masses(self.port.masses())

    def sleep(self, bodies) -> None:
        if "sleep" in self.raises:
            raise RuntimeError("the engine is busy")
        self.port.sleep(bodies)

    def wake(self, bodies) -> None:
        if "wake" in self.raises:
            raise RuntimeError("the engine is busy")
        self.port.wake(bodies)

    def heal(self) -> None:
        self.spoil_contacts = self.spoil_masses = lambda table: table
        self.raises = set()


def with_row(masses: Masses, body: int) -> Masses:
    return Masses(
        np.append(masses.body, body),
        np.append(masses.mass, 1.0),
        np.vstack([masses.center_of_mass, [0.0, 0.0, 0.5]]),
        masses.removed,
    )


def replaced(**fields):
    return lambda table: dataclasses.replace(table, **{name: make(table) for name, make in fields.items()})


SPOILED_CONTACTS = {
    "unknown": (replaced(body_b=lambda c: np.full_like(c.body_b, 77)), "77, but masses.. never listed"),
    "float": (replaced(body_a=lambda c: c.body_a + 0.5), "contacts.body_a must hold integers"),
    "list": (replaced(body_a=lambda c: c.body_a.tolist()), "contacts.body_a must be a NumPy array"),
    "flipped": (replaced(normal=lambda c: -c.normal), "change the sign of all normals"),
    "few forces": (replaced(force=lambda c: np.zeros((len(c) - 1, 3))), "contacts.force must be None or have shape"),
    "an empty list of forces": (
        replaced(force=lambda c: np.zeros((0 * len(c), 3))),
        "contacts.force must be None or have",
    ),
}
SPOILED_MASSES = {
    "float": (replaced(body=lambda m: m.body.astype(float)), "masses.body must hold integers"),
    "twice": (lambda m: with_row(m, 0), "body 0 must have one row, but is listed twice"),
    "removed -1": (replaced(removed=lambda _: [-1]), "ids of at least 0, got -1"),
    "removed 2.0": (replaced(removed=lambda _: [2.0]), "integer ids, got 2.0"),
}


@pytest.mark.parametrize("what", SPOILED_CONTACTS)
def test_spoiled_contacts_change_nothing(port, what):
    spoil, message = SPOILED_CONTACTS[what]
    check_that_nothing_changes(port, "spoil_contacts", spoil, message)


@pytest.mark.parametrize("what", SPOILED_MASSES)
def test_spoiled_masses_change_nothing(port, what):
    spoil, message = SPOILED_MASSES[what]
    check_that_nothing_changes(port, "spoil_masses", spoil, message)


def check_that_nothing_changes(port, where: str, spoil, message: str) -> None:
    """The frames of error are as if they had never been: the stack freezes when it would have."""
    column(port, 3)
    spoiled = Spoiled(port)
    extension = StabilityExtension(spoiled, "equilibrium")
    for _ in range(3):
        extension.update(DT)
    before = extension._world.graph.bodies.copy()
    setattr(spoiled, where, spoil)
    for _ in range(2):
        with pytest.raises(ValueError, match=message):
            extension.update(DT)
    fields = [name for name in before.dtype.names if name != "place"]  # a scratch of every frame
    for name in fields:
        assert (extension._world.graph.bodies[name][: len(before)] == before[name]).all(), name
    spoiled.heal()
    for _ in range(SOON):
        extension.update(DT)
    assert port.frozen == {0, 1, 2}


OBJECTS = (replaced(point=lambda c: c.point.astype(object)), "contacts.point must hold numbers")


@pytest.mark.parametrize("spoil", [*(SPOILED_CONTACTS[what] for what in ("flipped", "float", "list")), OBJECTS])
def test_the_solver_names_the_same_mistakes(port, spoil):
    column(port, 2)
    with pytest.raises(ValueError, match=spoil[1]):
        solve_equilibrium(spoil[0](port.contacts()), port.masses())


def test_a_brick_under_a_ceiling_is_no_flipped_normal(port):
    column(port, 1)
    port.touch(0, GROUND, [(x, y, THICKNESS) for x in WIDE for y in DEEP], normal=(0.0, 0.0, -1.0))
    StabilityExtension(port).update(DT)
    assert solve_equilibrium(port.contacts(), port.masses()).verdict == "stable"


def test_an_engine_may_lag_a_frame_behind_a_removal(port):
    """Its rows are dropped and counted in the frame of its removal and the next; later they are an error."""
    column(port, 2)
    spoiled = Spoiled(port)
    extension = StabilityExtension(spoiled, "equilibrium")
    extension.update(DT)
    stale_contacts, stale_masses = port.contacts(), port.masses()
    port.remove(1)
    spoiled.spoil_contacts = lambda _: stale_contacts
    spoiled.spoil_masses = lambda masses: dataclasses.replace(stale_masses, removed=masses.removed)
    for _ in range(2):
        extension.update(DT)
    assert extension.dropped == 2 * (len(stale_contacts) // 2 + 1)
    spoiled.spoil_masses = lambda masses: masses
    with pytest.raises(ValueError, match="listed it as removed"):
        extension.update(DT)


def test_a_body_that_was_never_seen_may_leave(port):
    column(port, 1)
    spoiled = Spoiled(port)
    spoiled.spoil_masses = replaced(removed=lambda _: [5, 10_000])
    StabilityExtension(spoiled).update(DT)


def test_a_failed_sleep_is_asked_again(port):
    column(port, 3)
    spoiled = Spoiled(port)
    extension = StabilityExtension(spoiled, "equilibrium")
    spoiled.raises = {"sleep"}
    failed = 0
    for _ in range(SOON):
        try:
            extension.update(DT)
        except RuntimeError:
            failed += 1
            assert len(extension.frozen) == 0, "the engine froze nothing, and the core knows"
    assert failed > 0
    spoiled.heal()
    for _ in range(3 * SOON):
        extension.update(DT)
    assert port.frozen == {0, 1, 2} == set(extension.frozen.tolist())


def test_a_failed_wake_is_asked_again(port):
    column(port, 3)
    spoiled = Spoiled(port)
    extension = StabilityExtension(spoiled, "equilibrium")
    for _ in range(SOON):
        extension.update(DT)
    port.remove(0)
    spoiled.raises = {"wake"}
    with pytest.raises(RuntimeError):
        extension.update(DT)
    assert set(extension.frozen.tolist()) == {1, 2} == port.frozen
    spoiled.heal()
    assert extension.update(DT).woken == (1, 2)
    assert port.frozen == set()


def test_a_frozen_body_that_has_moved_is_live(port):
    column(port, 2)
    extension = StabilityExtension(port, "equilibrium")
    for _ in range(SOON):
        extension.update(DT)
    port.show_frozen = True
    x, y, z = port.center[1]
    port.center[1] = (x, y, z + 0.01)
    change = extension.update(DT)
    assert change.woken == (1,)
    assert change.reasons[1] == "moved"


@pytest.mark.parametrize(
    ("field", "value"),
    [("rest_s", 0), ("rest_s", -1.0), ("lean_s", True), ("rest_speed", "3"), ("contact_gap", np.nan)],
)
def test_settings_that_make_no_sense_are_named(field, value):
    with pytest.raises(ValueError, match=f"setting {field}"):
        Settings(**{field: value})
