"""The example of the tutorial does what the tutorial says."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from stability_core import StabilityExtension

DOCS = Path(__file__).parent.parent / "docs"
MOST_LINES = 120
"""Of the whole file, marks of its parts included; the port itself is to stay under a hundred."""


@pytest.fixture(scope="module")
def example() -> dict:
    return runpy.run_path(str(DOCS / "examples" / "toy_engine.py"))


def test_the_port_keeps_its_promises_and_the_tutorial_shows_what_is_printed(example) -> None:
    tutorial = (DOCS / "tutorial.md").read_text(encoding="utf-8")
    assert "\n".join(example["check"]()) in tutorial


def test_the_first_plank_freezes_in_the_frame_that_the_tutorial_names(example, capsys) -> None:
    """It falls for 2.7 frames (10 mm at g) and then rests for the time that ``Settings`` asks for."""
    frame = example["freeze_first_plank"]()
    assert frame > 2
    assert capsys.readouterr().out in (DOCS / "tutorial.md").read_text(encoding="utf-8")


def test_a_flipped_normal_is_refused_with_its_fix(example, monkeypatch) -> None:
    port = example["ToyPort"]
    contacts = port.contacts
    monkeypatch.setattr(port, "contacts", lambda self: _flipped(contacts(self)))
    with pytest.raises(ValueError, match="normal"):
        example["check"]()


def _flipped(contacts):
    contacts.normal[:] *= -1.0
    return contacts


def test_the_example_stays_short() -> None:
    assert len((DOCS / "examples" / "toy_engine.py").read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_a_second_plank_freezes_later_and_a_blow_unfreezes_the_first(example) -> None:
    """As the tutorial says: 10 mm above the first it only joins; dropped from 200 mm it strikes the first."""
    assert "struck" not in _reasons(example, drop_m=0.010)
    assert _reasons(example, drop_m=0.200).count("flat") == 3
    assert "struck" in _reasons(example, drop_m=0.200)


def _reasons(example, drop_m: float) -> list[str]:
    """Reasons of all changes until both planks are frozen; the first starts 10 mm above the ground."""
    thickness = example["THICKNESS"]
    engine = example["ToyEngine"]([0.5 * thickness + 0.010, 1.5 * thickness + 0.010 + drop_m])
    extension = StabilityExtension(example["ToyPort"](engine))
    reasons: list[str] = []
    for _ in range(120):
        engine.step()
        reasons += extension.update(example["FRAME_S"]).reasons.values()
    assert extension.frozen.tolist() == [0, 1]
    return reasons
