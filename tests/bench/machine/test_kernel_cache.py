"""Kernels of one version of the core never serve another."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from bench.machine import kernel_cache


@pytest.fixture
def core(tmp_path, monkeypatch):
    folder = tmp_path / "core"
    folder.mkdir()
    (folder / "kernel.py").write_text("x = 1\n")
    monkeypatch.setattr(kernel_cache, "_CORE", folder)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    return folder


def chosen(monkeypatch) -> Path:
    kernel_cache.keep_kernels_apart()
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    return folder


def test_the_same_sources_share_a_folder_and_changed_ones_do_not(core, monkeypatch):
    first = chosen(monkeypatch)
    assert first.is_dir()
    assert chosen(monkeypatch) == first
    (core / "kernel.py").write_text("x = 2\n")
    assert chosen(monkeypatch) != first


def test_the_users_choice_is_left_alone(core, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "elsewhere")
    kernel_cache.keep_kernels_apart()
    assert os.environ["NUMBA_CACHE_DIR"] == "elsewhere"


def test_a_process_with_another_numpy_does_not_inherit_the_folder_of_its_parent(core, monkeypatch):
    kernel_cache.keep_kernels_apart()
    parent = os.environ["NUMBA_CACHE_DIR"]
    monkeypatch.setattr(kernel_cache.importlib.metadata, "version", lambda _: "1.26.4")
    kernel_cache.keep_kernels_apart()
    assert os.environ["NUMBA_CACHE_DIR"] == f"{parent}-numpy1"


def test_a_home_that_cannot_be_written_is_no_error(core, tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert chosen(monkeypatch).is_dir()
