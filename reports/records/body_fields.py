"""Fields of fixed bodies, and shapes of all bodies, in the header of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenarios.model import Brick
from scenarios.shapes import Polyhedron, Shape

FIXED_FIELDS = ("size", "position", "quaternion")
"""Fields of a fixed body that are never absent."""


def fixed_body(box: Mapping[str, Any]) -> Brick:
    """Return a fixed body from the fields of ``fixed_fields``, with a mass of 1 kg, which has no effect."""
    (length, width, height), (x, y, z), (w, i, j, k) = (box[name] for name in FIXED_FIELDS)
    return Brick((length, width, height), 1.0, (x, y, z), (w, i, j, k), shape=read_shape(box.get("shape", "box")))


def read_shape(said: Any) -> Shape:
    """Return a shape from its name, or from the vertices [m] of a polyhedron."""
    if isinstance(said, list):
        return Polyhedron(tuple((x, y, z) for x, y, z in said))
    shape: Shape = said
    return shape


def shape_field(shape: Shape) -> str | list[list[float]]:
    """Return a shape as JSON: its name, or the vertices [m] of a polyhedron."""
    return [list(vertex) for vertex in shape.vertices] if isinstance(shape, Polyhedron) else shape


def fixed_fields(body: Brick) -> dict[str, Any]:
    """Return the fields of a fixed body as JSON; ``shape`` is absent for a box."""
    fields = {name: getattr(body, name) for name in FIXED_FIELDS}
    return fields if body.shape == "box" else {**fields, "shape": shape_field(body.shape)}
