"""Read bricks and fixed boxes from the tables of a TOML file; errors name table, field and allowed values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from scenarios.lookup import look_up
from scenarios.model import UPRIGHT, Brick, Quaternion
from scenarios.parameters import Real

FIELDS = ("size", "position", "mass", "time", "yaw", "quaternion", "removed")
FIXED_FIELDS = ("size", "position", "yaw", "quaternion")
LARGEST = 1e3
"""Upper limit of a length [m], a coordinate [m] or a time [s] in a file, because a larger number is a typing error."""
_HEAVIEST = 1e6
"""Upper limit [kg] of a mass in a file, because a larger mass is a typing error."""
_UNIT = 1e-6
"""Greatest difference between a quaternion's length and 1."""


def read_tables(content: Mapping[str, Any], name: str, *, least: int, most: int) -> list[Mapping[str, Any]]:
    """Return the tables ``[[name]]``; require ``least`` to ``most`` tables."""
    tables = content.get(name, [])
    is_list = isinstance(tables, list) and all(isinstance(table, dict) for table in tables)
    if not is_list or not least <= len(tables) <= most:
        raise ValueError(
            f"the file must contain {least} to {most} tables [[{name}]], got "
            f"{len(tables) if is_list else repr(tables)}: add or remove tables"
        )
    return list(tables)


def read_number(name: str, value: object, least: float, most: float) -> float:
    """Return the number in the required field ``name``.

    Raises:
        ValueError: if ``value`` is None (the field is missing), or no number from ``least`` to ``most``.
    """
    if value is None:
        raise ValueError(f"{name} is missing: add this field")
    return Real(least, most).check(name, value)


def _numbers(name: str, value: object, count: int, least: float) -> tuple[float, ...]:
    if not isinstance(value, list) or len(value) != count:
        raise ValueError(f"{name} must be a list of {count} numbers, got {value!r}")
    return tuple(read_number(f"{name}[{k}]", part, least, LARGEST) for k, part in enumerate(value))


def read_brick(name: str, table: Mapping[str, Any]) -> Brick:
    """Return the brick of the table ``name``."""
    box = _box(name, table, FIELDS)
    return replace(box, mass=read_number(f"{name}.mass", table.get("mass"), 1e-6, _HEAVIEST))


def read_fixed_box(name: str, table: Mapping[str, Any]) -> Brick:
    """Return the fixed box of the table ``name``, with a mass of 1 kg."""
    return _box(name, table, FIXED_FIELDS)


def _box(name: str, table: Mapping[str, Any], fields: Sequence[str]) -> Brick:
    """Return the box of a table, with a mass of 1 kg."""
    for field in table:
        look_up(f"field of {name}", field, dict.fromkeys(fields))
    length, width, height = _numbers(f"{name}.size", table.get("size"), 3, 1e-4)
    x, y, z = _numbers(f"{name}.position", table.get("position"), 3, -LARGEST)
    return Brick((length, width, height), 1.0, (x, y, z), _turn(name, table))


def _turn(name: str, table: Mapping[str, Any]) -> Quaternion:
    if "yaw" in table and "quaternion" in table:
        raise ValueError(f"{name} must have yaw or quaternion, got both: delete yaw or quaternion")
    if "quaternion" in table:
        w, i, j, k = _numbers(f"{name}.quaternion", table["quaternion"], 4, -1.0)
        if abs(math.hypot(w, i, j, k) - 1) > _UNIT:
            raise ValueError(
                f"{name}.quaternion must be of unit length, got {math.hypot(w, i, j, k):g}: divide it by its length"
            )
        return w, i, j, k
    half = math.radians(read_number(f"{name}.yaw", table.get("yaw", 0.0), -360, 360)) / 2
    return (math.cos(half), 0.0, 0.0, math.sin(half)) if half else UPRIGHT
