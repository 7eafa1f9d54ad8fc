"""Reader of bricks and fixed bodies in the tables of a TOML file.

Error messages name the field, with its table, and the fix.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from scenarios.lookup import look_up
from scenarios.model import UPRIGHT, Brick, Quaternion, Vector
from scenarios.parameters import Choice, Real
from scenarios.shapes import SIMPLE_SHAPES
from scenarios.solids import MAX_FRICTION, capsule, cylinder, polyhedron, sphere, volume_of

SHAPE = Choice(*SIMPLE_SHAPES, "polyhedron")
DIMENSIONS = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
    "polyhedron": ("vertices",),
}
"""Fields that give the dimensions of each shape."""
FIXED_FIELDS = ("shape", "position", "yaw", "quaternion", "friction", "restitution")
FIELDS = (*FIXED_FIELDS, "mass", "density", "time", "removed")
LARGEST = 1e3
"""Upper limit of a length [m], a coordinate [m] or a time [s] in a file, because a larger number is a typing error."""
_HEAVIEST = 1e6
"""Upper limit [kg] of a mass in a file, because a larger mass is a typing error."""
_DENSEST = 1e5
"""Upper limit [kg/m3] of a density in a file, because no substance is as dense."""
_SMALLEST = 1e-4
"""Lower limit [m] of an edge, a diameter or a length in a file, because a smaller number is an error in units."""
_UNIT = 1e-6
"""Greatest difference between a quaternion's length and 1."""


def read_tables(content: Mapping[str, Any], name: str, *, least: int, most: int) -> list[Mapping[str, Any]]:
    """Return the tables ``[[name]]`` of a file.

    Raises:
        ValueError: if ``name`` is no list of tables, or has fewer than ``least`` or more than ``most`` tables.
    """
    tables = content.get(name, [])
    is_list = isinstance(tables, list) and all(isinstance(table, dict) for table in tables)
    if not is_list:
        raise ValueError(
            f"'{name}' must be a list of tables, got {tables!r}: write each table with a header [[{name}]]"
        )
    if not least <= len(tables) <= most:
        fix = "add" if len(tables) < least else "remove"
        raise ValueError(
            f"the file must contain {least} to {most} tables [[{name}]], got {len(tables)}: {fix} tables [[{name}]]"
        )
    return list(tables)


def read_number(name: str, value: object, least: float, most: float, unit: str = "") -> float:
    """Return the number in the required field ``name``; the message of an error gives the range with its ``unit``.

    Raises:
        ValueError: if ``value`` is None (the field is missing), or no number from ``least`` to ``most``.
    """
    if value is None:
        raise ValueError(f"{name} is missing: add a number from {least:g} to {most:g}{unit and f' {unit}'}")
    return Real(least, most, unit).check(name, value)


def read_numbers(
    name: str, value: object, count: int, least: float, most: float = LARGEST, unit: str = "m"
) -> tuple[float, ...]:
    """Return the list of ``count`` numbers from ``least`` to ``most``, with this ``unit``, in the field ``name``.

    Raises:
        ValueError: if ``value`` is None (the field is missing), or no list of ``count`` numbers in this range.
    """
    wanted = f"a list of {count} numbers from {least:g} to {most:g}{unit and f' {unit}'}"
    if value is None:
        raise ValueError(f"{name} is missing: add {wanted}")
    if not isinstance(value, list) or len(value) != count:
        raise ValueError(f"{name} must be {wanted}, got {value!r}: write {count} numbers in square brackets")
    return tuple(read_number(f"{name}[{k}]", part, least, most, unit) for k, part in enumerate(value))


def read_brick(name: str, table: Mapping[str, Any]) -> Brick:
    """Return the brick of the table ``name``.

    Raises:
        ValueError: if a field is missing or out of range, or two fields exclude each other; the message names the fix.
        UnknownNameError: if a field does not exist.
    """
    brick = _solid(name, table, FIELDS)
    if "density" not in table:
        return replace(brick, mass=read_number(f"{name}.mass", table.get("mass"), 1e-6, _HEAVIEST, "kg"))
    if "mass" in table:
        raise ValueError(f"{name} must have mass or density, got both: delete mass or density")
    density = read_number(f"{name}.density", table["density"], 1e-3, _DENSEST, "kg/m3")
    return replace(brick, mass=density * volume_of(brick.shape, brick.size))


def read_fixed_body(name: str, table: Mapping[str, Any]) -> Brick:
    """Return the fixed body of the table ``name``, with a mass of 1 kg; ``read_brick`` describes the errors."""
    return _solid(name, table, FIXED_FIELDS)


def _solid(name: str, table: Mapping[str, Any], fields: Sequence[str]) -> Brick:
    """Return the body of a table, with a mass of 1 kg."""
    shape = SHAPE.check(f"{name}.shape", table.get("shape", "box"))
    for field in table:
        look_up(f"field of {name}", field, dict.fromkeys((*DIMENSIONS[shape], *fields)))
    x, y, z = read_numbers(f"{name}.position", table.get("position"), 3, -LARGEST)
    brick = _shaped(name, table, shape, (x, y, z), _turn(name, table))
    return replace(
        brick,
        friction=_optional(f"{name}.friction", table.get("friction"), MAX_FRICTION),
        restitution=_optional(f"{name}.restitution", table.get("restitution"), 1.0),
    )


def _shaped(name: str, table: Mapping[str, Any], shape: str, position: Vector, turn: Quaternion) -> Brick:
    """Return a body with the ``shape`` and the dimensions of a table, and a mass of 1 kg."""
    if shape == "box":
        length, width, height = read_numbers(f"{name}.size", table.get("size"), 3, _SMALLEST)
        return Brick((length, width, height), 1.0, position, turn)
    if shape == "polyhedron":
        points = _points(f"{name}.vertices", table.get("vertices"))
        try:
            return polyhedron(points, position=position, quaternion=turn, mass=1.0)
        except ValueError as error:
            raise ValueError(f"{name}.vertices: {error}") from error
    radius = read_number(f"{name}.radius", table.get("radius"), _SMALLEST / 2, LARGEST, "m")
    if shape == "sphere":
        return sphere(radius, position=position, quaternion=turn, mass=1.0)
    make = cylinder if shape == "cylinder" else capsule
    length = read_number(f"{name}.length", table.get("length"), _SMALLEST, LARGEST, "m")
    return make(radius, length, position=position, quaternion=turn, mass=1.0)


def _points(name: str, value: object) -> list[tuple[float, ...]]:
    wanted = "a list of points [m] such as [[0.0, 0.0, 0.1], ...]"
    if value is None:
        raise ValueError(f"{name} is missing: add {wanted}")
    if not isinstance(value, list):
        raise ValueError(
            f"{name} must be {wanted}, got {value!r}: write three numbers in square brackets for each point"
        )
    return [read_numbers(f"{name}[{k}]", point, 3, -LARGEST) for k, point in enumerate(value)]


def _optional(name: str, value: object, most: float) -> float | None:
    return None if value is None else read_number(name, value, 0.0, most)


def _turn(name: str, table: Mapping[str, Any]) -> Quaternion:
    if "yaw" in table and "quaternion" in table:
        raise ValueError(f"{name} must have yaw or quaternion, got both: delete yaw or quaternion")
    if "quaternion" in table:
        w, i, j, k = read_numbers(f"{name}.quaternion", table["quaternion"], 4, -1.0, 1.0, "")
        if abs(math.hypot(w, i, j, k) - 1) > _UNIT:
            raise ValueError(
                f"{name}.quaternion must be of unit length, got the length {math.hypot(w, i, j, k):.9g}: correct "
                "the quaternion, or divide the quaternion by its length"
            )
        return w, i, j, k
    half = math.radians(read_number(f"{name}.yaw", table.get("yaw", 0.0), -360, 360, "deg")) / 2
    return (math.cos(half), 0.0, 0.0, math.sin(half)) if half else UPRIGHT
