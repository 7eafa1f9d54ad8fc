"""What each engine's interface shows, from the descriptors that a run keeps in its environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.tables.table import NOTHING, Table

_PROPERTIES = (
    ("version", "version"),
    ("plays", "planar"),
    ("contact points", "contact_points"),
    ("points that nearly touch", "near_contacts"),
    ("separation", "separation"),
    ("contact forces", "forces"),
    ("relative velocity", "relative_velocity"),
    ("freezes by", "freeze"),
    ("bodies moved by the host", "moved"),
    ("contacts of frozen pairs", "frozen_contacts"),
    ("friction", "friction_law"),
    ("normal at a ridge", "ridge_normal"),
    ("repeats bit for bit", "deterministic"),
)
"""Rows of the table, and the descriptor's field of each."""
_WORDS = {
    "near_contacts": {True: "listed", False: "added by geometry"},
    "planar": {True: "planar scenes", False: "all scenes"},
}


def capability_table(engines: Mapping[str, Mapping[str, Any]]) -> Table:
    """Engines side by side.

    Args:
        engines: by name, the ``version`` and the ``capabilities`` of each, as an environment.json keeps them.
    """
    rows = [
        (name, *(_told(field, {**engine["capabilities"], "version": engine["version"]}) for engine in engines.values()))
        for name, field in _PROPERTIES
    ]
    note = (
        "What the extension has to work with, as each adapter describes it. The conformance checks (`bench check`) "
        "measure what can be measured: points that nearly touch, separation, contact forces, the normal at a ridge, "
        "planar or not, and repetition in one process."
    )
    return Table("What the engines show", ("", *engines), tuple(rows), (note,), folds=True, id="capabilities")


def capability_tables(engines: Mapping[str, Mapping[str, Any]]) -> list[Table]:
    """The same as a list: empty if no engine is described."""
    return [capability_table(engines)] if engines else []


def _told(field: str, descriptor: dict[str, Any]) -> str:
    value = descriptor.get(field, NOTHING)
    if isinstance(value, bool):
        return _WORDS.get(field, {True: "yes", False: "no"})[value]
    return str(value)
