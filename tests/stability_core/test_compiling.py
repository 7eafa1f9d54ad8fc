"""Kernels are compiled when an extension is made, never while a simulation runs; and the log says so."""

from __future__ import annotations

import importlib
import logging
import pickle
import pkgutil
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

import stability_core
from stability_core import POLICIES, StabilityExtension, compiled, compiling, warm_up
from stability_core.lookup import UnknownNameError
from stability_core.ports import ENGINES
from tests.stability_core.still_world import StillWorld


def compiled_versions() -> dict[str, int]:
    """For how many types of arguments each kernel is compiled in this process."""
    found = {}
    for module in pkgutil.walk_packages(stability_core.__path__, "stability_core."):
        try:
            loaded = importlib.import_module(module.name)
        except ModuleNotFoundError as error:  # a port whose engine is not installed
            if error.name not in ENGINES.values():
                raise
            continue
        for name, kernel in vars(loaded).items():
            if isinstance(kernel, Dispatcher) and kernel.py_func.__module__ == module.name:
                found[f"{module.name}.{name}"] = len(kernel.signatures)
    return found


@pytest.fixture
def cold(monkeypatch):
    """As if no policy had been compiled in this process yet."""
    monkeypatch.setattr(compiling, "_COMPILED", set())


@pytest.mark.parametrize("policy", POLICIES)
def test_nothing_is_compiled_inside_update(policy):
    """Planks are laid, leant, taken, held and woken at random while gravity turns: no kernel meets unknown types."""
    warm_up(policy)
    before = compiled_versions()
    assert before["stability_core.frame.observe"] >= 1
    for seed in range(4):
        random = np.random.default_rng([20261127, seed])
        world = StillWorld(random, friction=0.6)
        extension = StabilityExtension(world, policy=policy)
        for _ in range(25):
            if random.random() < 0.8 or not world.center:
                world.lay() if random.random() < 0.7 else world.lean()
            else:
                world.take(int(random.choice(list(world.center))))
            extension.adopt()
            for _ in range(8):
                extension.update(1 / 60)
            if world.center:
                body = int(random.choice(list(world.center)))
                extension.disturb([body])
                extension.update(1 / 60)
                extension.release([body])
                extension.wake([body])
                extension.gravity = (random.uniform(-1.0, 1.0), 0.0, -9.81)
    assert compiled_versions() == before


def test_an_engine_that_gives_frozen_arrays_costs_no_compilation(port):
    """Arrays that cannot be written, or of single precision, as engines hand them out."""
    port.add(0, (0.0, 0.0, 0.05))
    port.lay(0, -1, (-0.05, 0.05), (-0.05, 0.05), 0.0)
    extension = StabilityExtension(port)
    extension.update(1 / 60)
    before = compiled_versions()
    contacts = port.contacts()
    for item in ("point", "normal", "separation"):
        array = getattr(contacts, item).astype(np.float32)
        array.flags.writeable = False
        object.__setattr__(contacts, item, array)
    contacts.body_a.flags.writeable = False
    port.contacts = lambda: contacts
    extension.update(1 / 60)
    assert compiled_versions() == before


def test_a_policy_is_compiled_once_and_an_unknown_one_is_refused(cold):
    assert warm_up("paper") > 0.0
    assert warm_up("paper") == 0.0
    with pytest.raises(UnknownNameError, match="papre"):
        warm_up("papre")


def test_what_takes_long_is_reported(cold, monkeypatch, caplog):
    monkeypatch.setattr(compiling, "_SILENT_S", 0.0)
    monkeypatch.setattr(compiling, "_is_kept", lambda _: False)
    with caplog.at_level(logging.WARNING, "stability_core"):
        warm_up("paper")
    first, last = caplog.messages
    assert first == "compiling the kernels of policy 'paper': one to two minutes, once per version"
    assert last.startswith("compiled the kernels of policy 'paper' in ")


def test_where_nothing_can_be_written_kernels_are_compiled_and_the_message_names_what_to_set(cold, monkeypatch, caplog):
    def without_a_folder(**options):
        if options.get("cache"):
            raise RuntimeError("cannot cache function: no locator available")
        return lambda function: function

    monkeypatch.setattr(compiled, "njit", without_a_folder)
    monkeypatch.setattr(compiled, "NOT_KEPT", [])
    monkeypatch.setattr(compiling, "NOT_KEPT", compiled.NOT_KEPT)
    assert compiled.compiled(abs)(-1) == 1
    with caplog.at_level(logging.WARNING, "stability_core"):
        warm_up("paper")
    assert "set NUMBA_CACHE_DIR to a folder in which you can write files" in caplog.messages[0]


class OfAnEarlierVersion:
    """An argument's class in the index of a kernel that an earlier version cached: its module is gone."""

    def __reduce__(self):
        return importlib.import_module, ("stability_core.of_an_earlier_version",)


def one_more(x):
    return x + 1


def test_a_kernel_that_an_earlier_version_cached_is_compiled_again(cold, monkeypatch):
    """Numba reads the classes of a cached kernel's arguments before it compares the dates of the sources."""

    def extension_of(port):
        assert kernel(1) == 2
        return StabilityExtension(port, policy="paper")

    monkeypatch.setattr(compiled, "KEPT", [])
    monkeypatch.setattr(compiling, "KEPT", compiled.KEPT)
    kernel = compiled.compiled(one_more)
    index = Path(kernel.stats.cache_path) / kernel._cache._cache_file._index_name
    index.parent.mkdir(parents=True, exist_ok=True)
    index.write_bytes(pickle.dumps(numba.__version__) + pickle.dumps((0.0, OfAnEarlierVersion())))
    with pytest.raises(ModuleNotFoundError, match="of_an_earlier_version"):
        kernel(1)
    assert compiling.compile_policy("of two versions", extension_of) > 0.0
    assert kernel(2) == 3
