"""Look up a name in a table. The error for an unknown name lists the allowed names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import TypeVar

Item = TypeVar("Item")


class UnknownNameError(LookupError):
    """Error for an unknown name. The message suggests a similar name, if any, and lists the allowed names."""


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> UnknownNameError:
    """Return the error for an unknown ``name`` of a ``kind``."""
    names = list(allowed)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"; did you mean '{near[0]}'?" if near else "."
    return UnknownNameError(f"unknown {kind} '{name}'{hint} Use one of: {', '.join(names)}.")


def look_up(kind: str, name: str, table: Mapping[str, Item]) -> Item:
    """Return the entry ``name`` of ``table``.

    Raises:
        UnknownNameError: if ``table`` has no entry ``name``.
    """
    if name not in table:
        raise unknown_name(kind, name, table)
    return table[name]
