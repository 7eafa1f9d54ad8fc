"""Table of the engines by name. The entry of an engine imports the adapter on first use."""

from __future__ import annotations

import importlib
import importlib.metadata
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from scenarios.lookup import look_up


class EngineEntry(Protocol):
    """Interface of an entry of ``ENGINES``, which loads the adapter of an engine."""

    @property
    def module(self) -> str:
        """Return the name of the module that a process imports before it runs trials of the engine."""
        ...

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that does not load, as text for an error message."""
        ...

    @property
    def is_optional(self) -> bool:
        """Return whether the suite's studies skip the engine if its package is missing."""
        ...

    def version(self) -> str:
        """Return the engine's version.

        Raises:
            ImportError: if the engine's package is missing.
            PeerError: if an engine behind the bridge does not start.
        """
        ...

    def load(self) -> Any:
        """Return the engine's class, a subclass of ``adapters.base.Simulation``.

        Raises:
            ImportError: if the adapter does not load.
            PeerError: if an engine behind the bridge does not start.
        """
        ...


def _install_engines(package: str) -> str:
    return f"install '{package}' with: uv sync --group engines"


@dataclass(frozen=True, slots=True)
class Entry:
    """An engine whose adapter is a class in a module."""

    module: str
    simulation: str
    package: str
    """The Python distribution that contains the engine. Records state the version of this distribution."""
    is_optional: bool = False

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that does not load, as text for an error message."""
        return _install_engines(self.package)

    def version(self) -> str:
        """Return the version of the package.

        Raises:
            PackageNotFoundError: if the package is missing.
        """
        return importlib.metadata.version(self.package)

    def load(self) -> Any:
        """Return the class of the adapter.

        Raises:
            ImportError: if the package is missing, or is a release that the adapter cannot import.
        """
        return getattr(importlib.import_module(self.module), self.simulation)


_WASM_LOCK = Path(__file__).parent / "wasm" / "package-lock.json"


@dataclass(frozen=True, slots=True)
class WasmEntry:
    """An engine that runs in Node.js. The adapter loads without Node.js."""

    module: str
    simulation: str
    package: str
    """The npm package that contains the engine. Records state the version of this package."""
    is_optional: bool = True

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that opens no world, as text for an error message."""
        return "install Node.js and the engine with: uv run --group wasm -m adapters.wasm"

    def version(self) -> str:
        """Return the version of the package in the lock file."""
        lock = json.loads(_WASM_LOCK.read_text(encoding="utf-8"))
        return str(lock["packages"][f"node_modules/{self.package}"]["version"])

    def load(self) -> Any:
        """Return the class of the adapter."""
        return getattr(importlib.import_module(self.module), self.simulation)


@dataclass(frozen=True, slots=True)
class LibraryEntry:
    """An engine in a shared library, which several packages provide. The adapter loads without the library."""

    module: str
    simulation: str
    adapter: str
    """Module of the adapter."""
    library: str
    """Module that loads the library. Its ``VERSION`` is the engine's version in records."""
    group: str
    """Dependency group with one of the packages that provide the library."""
    is_optional: bool = True

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that opens no world, as text for an error message."""
        return f"install the engine's library with: uv sync --group {self.group}"

    def version(self) -> str:
        """Return the version of the library in use.

        Raises:
            ImportError: if the library is missing, or does not export ODE's functions.
        """
        return str(importlib.import_module(self.library).VERSION)

    def load(self) -> Any:
        """Return the class of the adapter."""
        return getattr(importlib.import_module(self.adapter), self.simulation)


@dataclass(frozen=True, slots=True)
class ReferenceEntry:
    """A reference engine, whose code is in this repository."""

    module: str
    simulation: str
    revision: int
    """Version number of the engine. A change of the code that changes poses must raise this number."""
    package: str = ""
    """The Python distribution that solves the engine's quadratic programs; empty if the engine needs none."""
    is_optional: bool = False

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that does not load, as text for an error message."""
        return _install_engines(self.package) if self.package else "install the suite's packages with: uv sync"

    def version(self) -> str:
        """Return the revision, then in brackets the package and its version if the engine needs a package.

        Raises:
            PackageNotFoundError: if the package is missing.
        """
        solver = f" ({self.package} {importlib.metadata.version(self.package)})" if self.package else ""
        return f"{self.revision}{solver}"

    def load(self) -> Any:
        """Return the class of the adapter.

        Raises:
            ImportError: if the package is missing.
        """
        return getattr(importlib.import_module(self.module), self.simulation)


ENGINES: dict[str, EngineEntry] = {
    "bullet": Entry("adapters._bullet", "BulletSimulation", "pybullet"),
    "mujoco": Entry("adapters._mujoco", "MujocoSimulation", "mujoco"),
    "dart": Entry("adapters._dart", "DartSimulation", "dartpy"),
    "physx": Entry("adapters._physx", "PhysxSimulation", "sapien"),
    "pymunk": Entry("adapters._pymunk", "PymunkSimulation", "pymunk"),
    "rapier": Entry("adapters._rapier", "RapierSimulation", "rapier3d"),
    "box3d": Entry("adapters._box3d", "Box3dSimulation", "robox3d"),
    "jolt": WasmEntry("adapters._jolt", "JoltSimulation", "jolt-physics"),
    "havok": WasmEntry("adapters._havok", "HavokSimulation", "@babylonjs/havok"),
    "ode": LibraryEntry("adapters._ode_world", "OdeSimulation", "adapters._ode", "adapters._ode_library", "ode"),
    "staggered": ReferenceEntry("adapters._staggered", "StaggeredSimulation", 1, "piqp"),
    "erleben": ReferenceEntry("adapters._erleben", "ErlebenSimulation", 1),
}


def engine_version(engine: str) -> str:
    """Return the version of an engine, for records.

    Raises:
        UnknownNameError: if no engine has this name.
        ImportError: if the package or the library of the engine is missing.
        PeerError: if an engine behind the bridge does not start.
    """
    return look_up("engine", engine, ENGINES).version()
