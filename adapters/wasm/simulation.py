"""A world of an engine in Node: what it says without Node, its package and its process."""

from __future__ import annotations

from typing import ClassVar

from adapters import wasm
from adapters.bridge.simulation import BridgeSimulation


class WasmSimulation(BridgeSimulation):
    """One world of an engine that runs in Node; subclasses say which."""

    package: ClassVar[str]
    """The npm package that brings the engine."""

    @classmethod
    def check_installed(cls) -> None:
        """Raise ``ImportError`` if Node or the package is missing."""
        wasm.check_package(cls.engine, cls.package)

    @classmethod
    def command(cls) -> list[str]:
        """Return the command that starts it."""
        return [str(wasm.node()), str(wasm.FOLDER / "peer.mjs"), cls.engine]
