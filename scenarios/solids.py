"""Bricks of any convex shape: makers, checks, mass properties, and the coefficients of a pair.

can = cylinder(0.033, 0.12, position=(0.0, 0.0, 0.06), density=700.0)
lying = replace(can, quaternion=(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0), friction=0.2)
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from scenarios import shapes
from scenarios.lookup import one_of
from scenarios.model import UPRIGHT, Brick, Quaternion, Vector, World
from scenarios.shapes import SIMPLE_SHAPES, FloatArray, Polyhedron, Shape

MAX_FRICTION = 10.0
"""Greatest Coulomb coefficient, because a larger number is an error."""
_EXCESS = 1e-9
"""Relative excess of one moment of inertia over the sum of the other two that counts as rounding."""


def cylinder(
    radius: float,
    length: float,
    *,
    position: Vector,
    quaternion: Quaternion = UPRIGHT,
    mass: float | None = None,
    density: float | None = None,
    level: int = 1,
) -> Brick:
    """Return a cylinder with its axis along its own z.

    Args:
        radius: radius [m].
        length: length [m].
        position: centre [m].
        quaternion: orientation (w, x, y, z).
        mass: mass [kg]; give either the mass or the density.
        density: density [kg/m3].
        level: level of the brick, from 1.

    Raises:
        ValueError: if a value is not allowed; the message names the fix.
    """
    return _made("cylinder", (2 * radius, 2 * radius, length), position, quaternion, mass, density, level)


def capsule(
    radius: float,
    length: float,
    *,
    position: Vector,
    quaternion: Quaternion = UPRIGHT,
    mass: float | None = None,
    density: float | None = None,
    level: int = 1,
) -> Brick:
    """Return a capsule with its axis along its own z; ``length`` [m] excludes both caps.

    ``cylinder`` describes all other arguments and the errors.
    """
    return _made("capsule", (2 * radius, 2 * radius, length + 2 * radius), position, quaternion, mass, density, level)


def sphere(
    radius: float,
    *,
    position: Vector,
    quaternion: Quaternion = UPRIGHT,
    mass: float | None = None,
    density: float | None = None,
    level: int = 1,
) -> Brick:
    """Return a sphere; ``cylinder`` describes the arguments and the errors."""
    return _made("sphere", (2 * radius, 2 * radius, 2 * radius), position, quaternion, mass, density, level)


def polyhedron(
    points: npt.ArrayLike,
    *,
    position: Vector,
    quaternion: Quaternion = UPRIGHT,
    mass: float | None = None,
    density: float | None = None,
    level: int = 1,
) -> Brick:
    """Return the convex hull of points as a brick, with its own frame at the centre of mass, along principal axes.

    Args:
        points: points [m] in any frame, shape (n, 3).
        position: origin [m] of the points' frame; the centre of mass may lie elsewhere.
        quaternion: orientation (w, x, y, z) of the points' frame.
        mass: mass [kg]; give either the mass or the density.
        density: density [kg/m3].
        level: level of the brick, from 1.

    Raises:
        ValueError: if the points enclose no volume, the hull has more than ``polyhedra.MOST_VERTICES`` vertices, or a
            value is not allowed; the message names the fix.
    """
    from scenarios.polyhedra import own_frame  # here, because trimesh is slow to import

    frame = own_frame(points)
    center = np.array(position) + _turned(quaternion, frame.center)
    turn = _product(quaternion, quaternion_of(frame.axes))
    x, y, z = center.tolist()
    return _made(frame.polyhedron, frame.polyhedron.extents, (x, y, z), turn, mass, density, level)


def enlarged(brick: Brick, factor: float) -> Brick:
    """Return a brick with all edge lengths times ``factor``; the mass and the pose stay the same.

    The moments of inertia in ``Brick.moments`` grow by the square of the factor.
    """
    shape, size = brick.shape, _times(factor, brick.size)
    if isinstance(shape, Polyhedron):
        shape = shape.scaled(factor)
        size = shape.extents
    moments = None if brick.moments is None else _times(factor**2, brick.moments)
    return replace(brick, size=size, shape=shape, moments=moments)


def reweighted(brick: Brick, factor: float) -> Brick:
    """Return a brick with its mass and its moments of inertia times ``factor``."""
    moments = None if brick.moments is None else _times(factor, brick.moments)
    return replace(brick, mass=brick.mass * factor, moments=moments)


def volume_of(shape: Shape, size: Vector) -> float:
    """Return the volume [m3] of a shape with the edge lengths ``size`` [m]."""
    if isinstance(shape, Polyhedron):
        from scenarios.polyhedra import mass_properties

        return mass_properties(shape).volume
    return shapes.volume(shape, size)


def moments_of(brick: Brick) -> Vector:
    """Return the moments of inertia [kg m2] of a brick about its own axes, which are principal axes."""
    if brick.moments is not None:
        return brick.moments
    if isinstance(brick.shape, Polyhedron):
        from scenarios.polyhedra import mass_properties

        x, y, z = np.diag(mass_properties(brick.shape).gyration).tolist()
    else:
        x, y, z = shapes.gyration(brick.shape, brick.size)
    return brick.mass * x, brick.mass * y, brick.mass * z


def reach_of(brick: Brick) -> float:
    """Return the greatest distance [m] of a point of a brick from the brick's centre of mass."""
    return shapes.reach(brick.shape, brick.size)


def friction_of(brick: Brick, world: World) -> float:
    """Return the Coulomb coefficient of a brick: the brick's own coefficient, else the world's coefficient."""
    return world.friction if brick.friction is None else brick.friction


def restitution_of(brick: Brick, world: World) -> float:
    """Return the coefficient of restitution of a brick: the brick's own, else the world's coefficient."""
    return world.restitution if brick.restitution is None else brick.restitution


def of_pair(first: float, second: float) -> float:
    """Return a pair's coefficient of friction or of restitution: the geometric mean of both bodies' coefficients."""
    return first if first == second else math.sqrt(first * second)


def has_one_friction(bricks: Iterable[Brick], world: World) -> bool:
    """Return whether all bricks, the fixed bodies and the ground have the same coefficient of friction."""
    return all(friction_of(brick, world) == world.friction for brick in (*bricks, *world.fixed))


def check_solid(brick: Brick) -> None:
    """Raise ``ValueError`` unless shape, size, friction, restitution and moments of a brick are valid."""
    if not all(math.isfinite(edge) and edge > 0 for edge in brick.size):
        raise ValueError(
            f"brick size must be three positive lengths, got {brick.size} m for the brick at {brick.position} m: give "
            "lengths above 0 m"
        )
    if brick.shape != "box":
        _check_shape(brick)
    if brick.friction is not None and not 0 <= brick.friction <= MAX_FRICTION:
        raise ValueError(
            f"brick friction must be None or a number from 0 to {MAX_FRICTION:g}, got {brick.friction} for the "
            f"brick at {brick.position} m: give a number in this range, or None for the world's coefficient"
        )
    if brick.restitution is not None and not 0 <= brick.restitution <= 1:
        raise ValueError(
            f"brick restitution must be None or a number from 0 to 1, got {brick.restitution} for the brick at "
            f"{brick.position} m: give a number in this range, or None for the world's coefficient"
        )
    if brick.moments is not None:
        _check_moments(brick.moments, brick.position)


def _check_shape(brick: Brick) -> None:
    shape, (x, y, z) = brick.shape, brick.size
    if isinstance(shape, Polyhedron):
        from scenarios.polyhedra import check_polyhedron

        try:
            check_polyhedron(shape)
        except ValueError as error:
            raise ValueError(f"brick at {brick.position} m: {error}") from error
        if brick.size != shape.extents:
            raise ValueError(
                f"the size of a polyhedron must be the extents of its vertices, {shape.extents} m, got {brick.size} m "
                f"for the brick at {brick.position} m: make the brick with scenarios.solids.polyhedron, and change the "
                "size of the brick with scenarios.solids.enlarged"
            )
    elif shape not in SIMPLE_SHAPES:
        raise ValueError(
            f"brick shape must be a Polyhedron or {one_of(SIMPLE_SHAPES)}, got {shape!r} for the brick at "
            f"{brick.position} m: give one of these shapes"
        )
    elif x != y or (shape == "sphere" and x != z):
        raise ValueError(
            f"the size of a {shape} must have equal edges along x {'and y' if shape != 'sphere' else ', y and z'}, got "
            f"{brick.size} m for the brick at {brick.position} m: make the brick with scenarios.solids.{shape}"
        )
    elif shape == "capsule" and z < x:
        raise ValueError(
            f"a capsule must be at least as long as thick, got {brick.size} m for the brick at {brick.position} m: "
            "give a greater length, or use a sphere"
        )


def _check_moments(moments: Vector, position: Vector) -> None:
    largest = max(moments)
    if not all(math.isfinite(moment) and moment > 0 for moment in moments):
        raise ValueError(
            f"moments of inertia must be three positive numbers, got {moments} kg m2 for the brick at {position} m: "
            "give numbers above 0 kg m2, or None for a homogeneous brick"
        )
    if largest > (sum(moments) - largest) * (1 + _EXCESS):
        raise ValueError(
            f"no body has the moments of inertia {moments} kg m2 of the brick at {position} m, because one moment is "
            "larger than the sum of the two other moments: correct the moments, or give None for a homogeneous brick"
        )


def _made(
    shape: Shape,
    size: Vector,
    position: Vector,
    quaternion: Quaternion,
    mass: float | None,
    density: float | None,
    level: int,
) -> Brick:
    if (mass is None) == (density is None):
        raise ValueError(
            f"a body must have either mass or density, got mass={mass} kg and density={density} kg/m3 for the body at "
            f"{position} m: give the mass alone, or the density alone"
        )
    brick = Brick(size, 1.0, position, quaternion, level, shape=shape)
    check_solid(brick)
    known = mass if density is None else density * volume_of(shape, size)
    if known is None or not (math.isfinite(known) and known > 0):
        raise ValueError(
            f"mass or density must be positive and finite, got mass={mass} kg and density={density} kg/m3 for the body "
            f"at {position} m: give a mass above 0 kg, or a density above 0 kg/m3"
        )
    return replace(brick, mass=known)


def _turned(quaternion: Quaternion, vector: FloatArray) -> FloatArray:
    w, *ijk = quaternion
    axis = np.array(ijk)
    across = np.cross(axis, vector)
    turned: FloatArray = vector + 2 * (w * across + np.cross(axis, across))
    return turned


def _product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the product of two quaternions (w, x, y, z): the rotation ``second``, then the rotation ``first``."""
    if second == UPRIGHT:
        return first
    a, b, c, d = first
    w, x, y, z = second
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def quaternion_of(rotation: FloatArray) -> Quaternion:
    """Return the quaternion (w, x, y, z) of a ``rotation`` matrix (3, 3).

    The function starts from the largest component of the quaternion, because a small component has few exact digits.
    """
    trace = np.trace(rotation)
    squares = np.array([trace, *(2 * np.diag(rotation) - trace)])
    largest = int(squares.argmax())
    if largest == 0:
        parts = [1 + trace, *(rotation[k - 1, k - 2] - rotation[k - 2, k - 1] for k in (3, 1, 2))]
        w, x, y, z = parts
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        xyz = np.zeros(3)
        xyz[i] = 1 + squares[largest]
        xyz[j], xyz[k] = rotation[j, i] + rotation[i, j], rotation[k, i] + rotation[i, k]
        w, (x, y, z) = rotation[k, j] - rotation[j, k], xyz.tolist()
    length = math.sqrt(w * w + x * x + y * y + z * z)
    return float(w / length), float(x / length), float(y / length), float(z / length)


def _times(factor: float, vector: Vector) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z
