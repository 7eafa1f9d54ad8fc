"""The digest of the core: prose changes nothing, code changes it."""

import re

import pytest

from bench.machine import core_digest
from bench.machine.core_digest import core_of_commit, digest_of, present_core

CODE = '''
"""A module."""
import math

LIMIT = 0.5
"""Half a plank [m]."""


class Stack:
    """A stack."""

    def height(self, levels: int = 3) -> float:
        """Height [m]."""
        if levels < 0:
            raise ValueError(f"{levels} levels: give 0 or more", "levels")
        return levels * LIMIT  # as planned
'''


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"""A module."""', '"""Another word for it."""'),
        ('"""A module."""\n', ""),
        ('"""Half a plank [m]."""\n', ""),
        ('        """Height [m]."""\n', '        """Return the height [m].\n\n        With its reason.\n        """\n'),
        ("  # as planned", ""),
        ("levels * LIMIT", "(levels *  LIMIT)"),
        ('f"{levels} levels: give 0 or more"', 'f"levels must not be negative, got {levels:d}"'),
        ('f"{levels} levels: give 0 or more"', '"levels must not be negative"'),
    ],
)
def test_prose_and_layout_do_not_change_it(before: str, after: str) -> None:
    assert before in CODE
    assert digest_of({"stack.py": CODE.replace(before, after)}) == digest_of({"stack.py": CODE})


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("0.5", "0.6"),
        ("levels * LIMIT", "levels + LIMIT"),
        ("= 3", "= 4"),
        ("height", "rise"),
        ("import math\n", ""),
        ("return levels", "return 'levels'; levels"),
        ('"levels"', '"storeys"'),
        ("levels < 0", "levels < 1"),
    ],
)
def test_any_change_of_code_changes_it(before: str, after: str) -> None:
    assert before in CODE
    assert digest_of({"stack.py": CODE.replace(before, after)}) != digest_of({"stack.py": CODE})


def test_names_of_files_count_and_their_order_does_not() -> None:
    one, two = {"a.py": "x = 1", "b.py": "y = 2"}, {"b.py": "y = 2", "a.py": "x = 1"}
    assert digest_of(one) == digest_of(two) != digest_of({"a.py": "y = 2", "b.py": "x = 1"})


def test_it_is_the_same_on_every_version_of_python() -> None:
    """Pinned: ``ast.dump`` itself differs between versions, in fields that are empty."""
    assert digest_of({"stack.py": CODE}) == "c0ba42525855"


def test_a_commit_has_the_digest_of_its_files(monkeypatch) -> None:
    assert re.fullmatch("[0-9a-f]{12}", present_core())
    assert core_of_commit("no-such-commit") is None
    head = core_of_commit("HEAD")
    if head is None:
        pytest.skip("not a git checkout")
    assert re.fullmatch("[0-9a-f]{12}", head)
    monkeypatch.setattr(core_digest, "ROOT", core_digest.ROOT / "docs")
    assert core_of_commit("HEAD") is None  # no core there


def test_a_port_to_an_engine_does_not_change_it() -> None:
    assert digest_of({"stack.py": CODE, "ports/engine.py": CODE}) == digest_of({"stack.py": CODE})
