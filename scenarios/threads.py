"""Public threads about stacks: addresses and reported behaviour.

Scenes of ``scenarios/examples`` reproduce the stacks.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_suffix(".toml")


@dataclass(frozen=True, slots=True)
class Thread:
    """A thread on a public issue tracker."""

    name: str
    """Repository and number, such as ``bulletphysics/bullet3#3049``."""
    url: str
    reported: str
    """Behaviour that the thread reports."""


@cache
def threads() -> Mapping[str, Thread]:
    """Return the threads by file stem of the example that reproduces the thread's stack."""
    content = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {stem: Thread(one["thread"], one["url"], one["reported"]) for stem, one in content.items()}


def thread_of(parameters: Mapping[str, object]) -> Thread | None:
    """Return the thread about the stack of a scene with ``parameters``; None for a scene without a thread.

    A scene with a changed size, mass or yaw has no thread.
    """
    changed = [parameters.get(name, usual) != usual for name, usual in (("size", 1.0), ("mass", 1.0), ("yaw", 0.0))]
    file = parameters.get("file")
    return threads().get(Path(str(file)).stem) if file is not None and not any(changed) else None
