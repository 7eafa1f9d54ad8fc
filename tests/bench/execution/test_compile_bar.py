"""A terminal shows how many kernels are compiled while another process compiles them, and nothing if all are kept."""

from __future__ import annotations

import io
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.console import Console

from bench.execution import compile_bar
from bench.execution.compile_bar import CompileBar, kernels_cached

NAMES = ("settle", "resolve", "unfreeze")


def kernel(name: str, folder: Path) -> SimpleNamespace:
    function = SimpleNamespace(__module__="stability_core.frame", __qualname__=name)
    return SimpleNamespace(py_func=function, stats=SimpleNamespace(cache_path=str(folder)))


@pytest.fixture
def cache(tmp_path, monkeypatch) -> Path:
    """A cache of three kernels of which one is compiled."""
    folder = tmp_path / "stability_core_0"
    folder.mkdir()
    monkeypatch.setattr(compile_bar, "KEPT", [kernel(name, folder) for name in NAMES])
    monkeypatch.setattr(compile_bar, "NOT_KEPT", [])
    monkeypatch.setattr(compile_bar, "_POLL_S", 0.01)
    (folder / "frame.settle-12.py311.nbi").touch()
    (folder / "other.settle-12.py311.nbi").touch()
    return folder


def shown(*, terminal: bool, compiles: tuple[str, ...], cache: Path, kind: str = "xterm") -> str:
    page = io.StringIO()
    with CompileBar(Console(file=page, force_terminal=terminal, width=120, _environ={"TERM": kind})):
        for name in compiles:
            (cache / f"frame.{name}-1.py311.nbi").touch()
        time.sleep(0.5)
    return page.getvalue()


def test_kernels_in_the_cache_are_counted(cache: Path) -> None:
    assert kernels_cached() == 1
    (cache / "frame.resolve-80.py311.nbi").touch()
    (cache / "frame.resolve-80.py311.1.nbc").touch()
    assert kernels_cached() == 2


def test_the_real_cache_names_kernels_as_is_assumed() -> None:
    """Numba names an index by module, function and line; after any test of the core the cache has some."""
    from stability_core.compiled import KEPT

    folders = {Path(one.stats.cache_path) for one in KEPT}
    if not [index for folder in folders for index in folder.glob("*.nbi")]:
        pytest.skip("no kernel of the core is compiled yet")
    assert 0 < kernels_cached() <= len(KEPT)


def test_a_terminal_shows_a_bar_and_then_one_line(cache: Path) -> None:
    text = shown(terminal=True, compiles=("resolve", "unfreeze"), cache=cache)
    assert "compiling the core, once per version" in text
    assert "3 of up to 3 kernels" in text
    assert "compiled the core: 2 kernels in" in text.splitlines()[-1]


def test_a_terminal_that_cannot_move_its_cursor_shows_two_lines(cache: Path) -> None:
    first, last = shown(terminal=True, compiles=("resolve",), cache=cache, kind="dumb").split("\n", 1)
    assert first == "compiling the core, once per version"
    assert last.strip().startswith("compiled the core: 1 kernels in")


@pytest.mark.parametrize(("terminal", "compiles"), [(True, ()), (False, ("resolve",))])
def test_nothing_is_shown_without_work_and_in_a_log(cache: Path, terminal: bool, compiles) -> None:
    assert shown(terminal=terminal, compiles=compiles, cache=cache) == ""


def test_kernels_that_cannot_be_kept_are_said_to_be_compiled_each_time(cache: Path, monkeypatch) -> None:
    monkeypatch.setattr(compile_bar, "NOT_KEPT", ["no folder can be written"])
    assert "set NUMBA_CACHE_DIR to a folder" in shown(terminal=True, compiles=(), cache=cache)
