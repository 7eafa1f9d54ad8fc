"""The base class of engines in Node: the check of the npm package, and the command of the process."""

from __future__ import annotations

from typing import ClassVar

from adapters import wasm
from adapters.bridge.simulation import BridgeSimulation


class WasmSimulation(BridgeSimulation):
    """One world of an engine that runs in Node.js. A subclass names the engine and its package."""

    package: ClassVar[str]
    """The npm package that contains the engine."""

    @classmethod
    def check_installed(cls) -> None:
        """Raise ``ImportError`` if Node, or the package in its locked version, is missing."""
        wasm.check_package(cls.engine, cls.package)

    @classmethod
    def command(cls) -> list[str]:
        """Return the command that starts the engine's process.

        Raises:
            ImportError: if the wheel with Node is missing.
        """
        return [str(wasm.node()), str(wasm.FOLDER / "peer.mjs"), cls.engine]
