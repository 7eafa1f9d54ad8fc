"""The table of engine capabilities, from the engine descriptions in the environment of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.tables.table import NOTHING, Table

_JOINTS = "weld"
"""Field of the row about joints, which the table leaves out if no engine joins bodies, as in older results."""
_PROPERTIES = (
    ("version", "version"),
    ("kind", "reference"),
    ("plays", "planar"),
    ("contact points", "contact_points"),
    ("points that nearly touch", "near_contacts"),
    ("separation", "separation"),
    ("contact forces", "forces"),
    ("relative velocity", "relative_velocity"),
    ("freezes by", "freeze"),
    ("joins bodies by", _JOINTS),
    ("bodies moved by the host", "moved"),
    ("contacts of frozen pairs", "frozen_contacts"),
    ("friction", "friction_law"),
    ("normal at a ridge", "ridge_normal"),
    ("repeats bit for bit", "deterministic"),
)
"""Rows of the table: name, and field of an engine's description."""
_WORDS = {
    "near_contacts": {True: "listed", False: "added by geometry"},
    "reference": {True: "reference engine", False: "product"},
    "planar": {True: "planar scenes", False: "all scenes"},
}


def capability_table(engines: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return the table of capabilities, a column per engine.

    Args:
        engines: ``version`` and ``capabilities`` of each engine, by name, as in an ``environment.json``.
    """
    rows = [
        (
            name,
            *(
                _described(field, {**engine["capabilities"], "version": engine["version"]})
                for engine in engines.values()
            ),
        )
        for name, field in _PROPERTIES
        if field != _JOINTS or any(engine["capabilities"].get(field) for engine in engines.values())
    ]
    note = (
        "The interface that each adapter provides to the extension. The conformance checks (`bench check`) measure "
        "points that nearly touch, separation, contact forces, the normal at a ridge, planar or not, and repetition in "
        "one process; the adapter describes the other rows."
    )
    return Table("Engine capabilities", ("", *engines), tuple(rows), (note,), folds=True, id="capabilities")


def capability_tables(engines: Mapping[str, Mapping[str, Any]]) -> list[Table]:
    """Return the table of capabilities in a list, which is empty without engines."""
    return [capability_table(engines)] if engines else []


def _described(field: str, descriptor: dict[str, Any]) -> str:
    value = descriptor.get(field)
    if value is None:
        return NOTHING
    if isinstance(value, bool):
        return _WORDS.get(field, {True: "yes", False: "no"})[value]
    return str(value)
