"""The arrays of one frame in the port's order, as tuples for the kernels.

ADR-0002 gives the reason why loops take the arrays out of the tuple first.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stability_core.port import Contacts, FloatArray, IntArray, Masses

IDS, NUMBERS = np.dtype(np.int64), np.dtype(np.float64)
NO_FORCES = np.zeros((0, 0))
"""Contact forces of an engine that reports no forces. An engine with forces, but without contacts, gives (0, 3)."""


class ContactArrays(NamedTuple):
    """The contacts of one frame, with the fields of ``Contacts``: in upright coordinates, except in ``check_port``."""

    body_a: IntArray
    """First bodies, ids or rows of the table, shape (n,)."""
    body_b: IntArray
    """Second bodies, shape (n,)."""
    point: FloatArray
    """Contact points [m], shape (n, 3)."""
    normal: FloatArray
    """Unit normals from a to b, shape (n, 3)."""
    separation: FloatArray
    """Signed distances [m], shape (n,)."""
    relative_velocity: FloatArray
    """Velocity of b against a [m/s], shape (n, 3)."""
    friction: FloatArray
    """Coulomb coefficients, shape (n,)."""
    force: FloatArray
    """Force on b [N], shape (n, 3), or (0, 0) if the engine reports none."""


class MassArrays(NamedTuple):
    """The listed bodies of one frame, with the fields of ``Masses``."""

    body: IntArray
    """The bodies, ids or rows of the table, shape (m,)."""
    mass: FloatArray
    """Masses [kg], shape (m,)."""
    center: FloatArray
    """Centres of mass [m], shape (m, 3)."""


def laid_out(array: Any, dtype: np.dtype[Any]) -> Any:
    """Return an array in the kernels' layout, and copy the array only if necessary."""
    if type(array) is np.ndarray and array.dtype is dtype and array.flags.carray:
        return array  # the usual case, in which this check takes less time than a conversion
    contiguous = np.ascontiguousarray(array, dtype)
    return contiguous if contiguous.flags.writeable else contiguous.copy()


def contact_arrays(contacts: Contacts) -> ContactArrays:
    """Return the port's contacts for the kernels."""
    return ContactArrays(
        laid_out(contacts.body_a, IDS),
        laid_out(contacts.body_b, IDS),
        laid_out(contacts.point, NUMBERS),
        laid_out(contacts.normal, NUMBERS),
        laid_out(contacts.separation, NUMBERS),
        laid_out(contacts.relative_velocity, NUMBERS),
        laid_out(contacts.friction, NUMBERS),
        NO_FORCES if contacts.force is None else laid_out(contacts.force, NUMBERS),
    )


def mass_arrays(masses: Masses) -> MassArrays:
    """Return the port's masses for the kernels."""
    return MassArrays(
        laid_out(masses.body, IDS), laid_out(masses.mass, NUMBERS), laid_out(masses.center_of_mass, NUMBERS)
    )
