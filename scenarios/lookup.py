"""Look-up of a name in a table, with an error that gives all allowed names and a near match."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import TypeVar

Item = TypeVar("Item")


class UnknownNameError(LookupError):
    """Error for an unknown name; the message gives all allowed names and, if a name is similar, the nearest match."""


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> UnknownNameError:
    """Return the error for an unknown ``name`` of a ``kind`` with the names ``allowed``."""
    names = list(allowed)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"; did you mean '{near[0]}'?" if near else "."
    return UnknownNameError(f"unknown {kind} '{name}'{hint} Use {one_of(names)}.")


def one_of(names: Iterable[str]) -> str:
    """Return the choice among ``names`` as text: "a", "a or b", or "one of a, b or c"; a text also without names."""
    *before, last = [*names] or ["no name, because none exists"]
    if not before:
        return last
    return f"{'one of ' if len(before) > 1 else ''}{', '.join(before)} or {last}"


def look_up(kind: str, name: str, table: Mapping[str, Item]) -> Item:
    """Return the entry ``name`` of ``table``.

    Raises:
        UnknownNameError: if ``table`` has no entry ``name``.
    """
    if name not in table:
        raise unknown_name(kind, name, table)
    return table[name]
