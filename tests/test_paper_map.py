"""``docs/paper_map.md`` leads a reader of the paper to the code: every place that it names must be there."""

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAP = (ROOT / "docs/paper_map.md").read_text().partition("## Where the text is open")[0]
ROWS = [line.split("|")[2:4] for line in MAP.splitlines() if line.startswith("|")][2:]
PLACES = sorted({place for row in ROWS for place in re.findall(r"`([\w.]+)`", row[0])})
TESTS = sorted({test for row in ROWS for test in re.findall(r"`([\w.]+)`", row[1])})


def found(place: str) -> bool:
    """Whether a dotted path below the package leads to something: a module, what is in it, or a field of a record."""
    thing, path = importlib.import_module("stability_core"), "stability_core"
    for name in place.split("."):
        path += f".{name}"
        if hasattr(thing, "__path__") and importlib.util.find_spec(path):
            thing = importlib.import_module(path)
        elif hasattr(thing, name):
            thing = getattr(thing, name)
        else:
            return name in (getattr(thing, "names", None) or getattr(thing, "__annotations__", ()))
    return True


@pytest.mark.parametrize("place", PLACES)
def test_every_place_in_the_code_is_there(place) -> None:
    assert found(place)


@pytest.mark.parametrize("test", TESTS)
def test_every_test_is_there(test) -> None:
    """A file's name, or the beginning of a test's."""
    files = list((ROOT / "tests").rglob("test_*.py"))
    named = re.compile(rf"def {re.escape(test.rstrip('.'))}")
    assert any(test == path.name or named.search(path.read_text()) for path in files)
