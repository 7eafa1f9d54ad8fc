"""``docs/paper_map.md`` and ``docs/convex_program_map.md`` lead to the code: every place that they name exists."""

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAPS = {"paper_map": "stability_core", "convex_program_map": "stability_core.equilibrium"}
"""The package below which each map names its places."""


def rows(name: str) -> list[list[str]]:
    """The second and third cell of each row of the map's table."""
    text = (ROOT / f"docs/{name}.md").read_text(encoding="utf-8").partition("## Where the text is open")[0]
    return [line.split("|")[2:4] for line in text.replace("|f_t|", "").splitlines() if line.startswith("| ")][1:]


PLACES = sorted({(name, place) for name in MAPS for row in rows(name) for place in re.findall(r"`([\w.]+)`", row[0])})
TESTS = sorted({test for name in MAPS for row in rows(name) for test in re.findall(r"`([\w.]+)`", row[1])})


def exists(package: str, place: str) -> bool:
    """Whether a dotted path below a package leads to a module, to something in it, or to a field of a record."""
    thing, path = importlib.import_module(package), package
    for name in place.split("."):
        path += f".{name}"
        if hasattr(thing, "__path__") and importlib.util.find_spec(path):
            thing = importlib.import_module(path)
        elif hasattr(thing, name):
            thing = getattr(thing, name)
        else:
            return name in (getattr(thing, "names", None) or getattr(thing, "__annotations__", ()))
    return True


@pytest.mark.parametrize(("name", "place"), PLACES)
def test_every_place_in_the_code_exists(name, place) -> None:
    assert exists(MAPS[name], place)


@pytest.mark.parametrize("test", TESTS)
def test_every_test_exists(test) -> None:
    """A file's name, or the beginning of a test's."""
    files = list((ROOT / "tests").rglob("test_*.py"))
    named = re.compile(rf"def {re.escape(test.rstrip('.'))}")
    assert any(test == path.name or named.search(path.read_text(encoding="utf-8")) for path in files)
