"""The documentation: every public name has an entry, every page is reachable, and the site builds without a warning."""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
MODULES = {
    "stability_core": "reference/stability_core.md",
    "stability_core.ports": "reference/stability_core_ports.md",
    "scenarios.model": "reference/scenarios_model.md",
    "adapters.base": "reference/adapters_base.md",
    "reports": "reference/reports_load.md",
}
LISTED_ELSEWHERE = ("adr", "results")
"""Folders whose pages are listed by an index of their own."""


def public_names(module: str) -> set[str]:
    """The names of ``__all__``, or else everything public that the module defines."""
    loaded = importlib.import_module(module)
    if hasattr(loaded, "__all__"):
        return set(loaded.__all__)
    return {
        name
        for name, value in vars(loaded).items()
        if not name.startswith("_") and getattr(value, "__module__", "") == module and inspect.getdoc(value)
    }


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_has_an_entry_in_the_reference(module: str) -> None:
    page = (DOCS / MODULES[module]).read_text(encoding="utf-8")
    names = public_names(module)
    assert names
    if f"::: {module}\n" not in page:
        assert all(f"::: {module}.{name}" in page for name in names)
    elif "members: [" in page:
        listed = re.search(r"members: \[([^\]]*)\]", page)
        assert listed is not None
        assert set(listed[1].split(", ")) == names


def test_every_page_is_in_the_navigation() -> None:
    """A page that nothing lists is found by search alone."""
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")}
    pages = {page for page in pages if not page.startswith(LISTED_ELSEWHERE)}
    config = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert [page for page in sorted(pages) if f": {page}\n" not in config] == [], "add it to nav in mkdocs.yml"


def test_the_index_of_decisions_lists_each_by_its_title() -> None:
    index = (DOCS / "adr" / "index.md").read_text(encoding="utf-8")
    for page in DOCS.glob("adr/0*.md"):
        title = page.read_text(encoding="utf-8").splitlines()[0].lstrip("# ")
        assert f"- [{title}]({page.name})" in index


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_indexes_every_public_name(tmp_path: Path) -> None:
    """Strict: a link to a missing page or anchor is an error."""
    commands = pytest.importorskip("mkdocs.commands.build", reason="needs uv run --group docs")
    config = importlib.import_module("mkdocs.config").load_config(
        str(ROOT / "mkdocs.yml"), strict=True, site_dir=str(tmp_path)
    )
    config.plugins.on_startup(command="build", dirty=False)
    commands.build(config)
    for module, page in MODULES.items():
        html = (tmp_path / page.removesuffix(".md") / "index.html").read_text(encoding="utf-8")
        assert [name for name in public_names(module) if f'id="{module}.{name}"' not in html] == []
