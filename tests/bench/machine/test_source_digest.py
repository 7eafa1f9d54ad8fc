"""The digest of the sources: code and the engines' settings change it, other files do not."""

from pathlib import Path

import pytest

from bench.machine.source_digest import SUITE, sources_digest


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "deep" / "profiles").mkdir(parents=True)
    (tmp_path / "profiles").mkdir()
    for name in ("one.py", "deep/two.py", "profiles/engine.toml", "notes.txt", "study.toml"):
        (tmp_path / name).write_text("x = 1")
    return tmp_path


@pytest.mark.parametrize("name", ["one.py", "deep/two.py", "profiles/engine.toml"])
def test_code_and_profiles_change_it(folder: Path, name: str) -> None:
    before = sources_digest([folder])
    (folder / name).write_text("x = 2")
    assert sources_digest([folder]) != before


@pytest.mark.parametrize("name", ["notes.txt", "study.toml"])
def test_nothing_else_changes_it(folder: Path, name: str) -> None:
    before = sources_digest([folder])
    (folder / name).write_text("x = 2")
    assert sources_digest([folder]) == before


def test_the_engines_profiles_are_among_the_sources() -> None:
    assert [path for folder in SUITE for path in folder.glob("profiles/*.toml")]


def test_a_port_to_an_engine_counts_only_where_it_is_listed(folder: Path) -> None:
    """A port decides nothing: an edit of a port must not discard the core's kernels."""
    (folder / "ports").mkdir()
    (folder / "ports" / "engine.py").write_text("x = 1")
    core, ports = sources_digest([folder]), sources_digest([folder / "ports"])
    (folder / "ports" / "engine.py").write_text("x = 2")
    assert sources_digest([folder]) == core
    assert sources_digest([folder / "ports"]) != ports
    assert any(path.parts[-2:] == ("stability_core", "ports") for path in SUITE)
