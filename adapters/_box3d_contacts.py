"""Box3D's contacts as arrays, read from its C structures in blocks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from robox3d._ffi import ffi, lib

from stability_core.port import BoolArray, FloatArray, IntArray

_VECTOR = ("<f4", 3)
_POINT = np.dtype(
    {
        "names": ["anchor_a", "anchor_b", "separation", "normal_impulse"],
        "formats": [_VECTOR, _VECTOR, "<f4", "<f4"],
        "offsets": [0, 12, 24, 32],
        "itemsize": 56,
    }
)
_MANIFOLD = np.dtype(
    {
        "names": ["points", "normal", "friction_impulse", "point_count"],
        "formats": [(_POINT, 4), _VECTOR, _VECTOR, "<i4"],
        "offsets": [0, 224, 240, 264],
        "itemsize": 268,
    }
)
_CONTACT = np.dtype(
    {
        "names": ["contact", "shape_a", "shape_b"],
        "formats": ["<i4", "<i4", "<i4"],
        "offsets": [0, 12, 20],
        "itemsize": 48,
    }
)
for _name, _dtype in (("b3ManifoldPoint", _POINT), ("b3Manifold", _MANIFOLD), ("b3ContactData", _CONTACT)):
    if ffi.sizeof(_name) != _dtype.itemsize:
        raise ImportError(
            f"robox3d: the structure {_name} must have {_dtype.itemsize} bytes, got {ffi.sizeof(_name)}: install the "
            "version of robox3d in uv.lock (uv sync --group engines)"
        )


@dataclass(frozen=True, slots=True)
class Manifolds:
    """Contacts of a set of bodies, without duplicates. A contact has up to four points, which share one normal."""

    contact: IntArray
    """Box3D's indices of the contacts, in rising order, shape (n,)."""
    shape_a: IntArray
    """Indices of the first shapes, shape (n,)."""
    shape_b: IntArray
    """Indices of the second shapes, shape (n,)."""
    normal: FloatArray
    """Unit normals from a to b in the world's frame, shape (n, 3)."""
    exists: BoolArray
    """True for each entry that holds a point, shape (n, 4)."""
    anchor_a: FloatArray
    """Points [m] relative to the centre of body a, along the world's axes, shape (n, 4, 3)."""
    anchor_b: FloatArray
    """Points [m] relative to the centre of body b, along the world's axes, shape (n, 4, 3)."""
    separation: FloatArray
    """Distances [m], negative in penetration, shape (n, 4)."""
    pressure: FloatArray
    """Normal impulses [N s] of the solver's latest iteration, shape (n, 4); 0 where there is no point."""
    impulse: FloatArray
    """Impulses [N s] of whole contacts on bodies b in the solver's latest iteration, with friction, shape (n, 3)."""

    def impulses_at(self, fresh: Manifolds, listed: BoolArray) -> FloatArray:
        """Return the impulses (n, 4, 3) [N s] at the points that a later step of length 0 has detected.

        Box3D drops the impulse of a point if other vertices or edges of the boxes meet there. This case occurs at rest
        between planks with flush edges. This method divides the impulse of a contact among its points, in proportion to
        the normal impulse of the nearest solved point.

        Args:
            fresh: contacts of the later detection; a contact that the solver has not solved has no impulse.
            listed: True for each point of ``fresh`` that gets a part of its contact's impulse, shape (n, 4).
        """
        if not len(self.contact):
            return np.zeros((*listed.shape, 3))
        row = np.minimum(np.searchsorted(self.contact, fresh.contact), len(self.contact) - 1)
        same = self.contact[row] == fresh.contact
        same &= (self.shape_a[row] == fresh.shape_a) & (self.shape_b[row] == fresh.shape_b)
        between = fresh.anchor_a[:, :, None] - self.anchor_a[row][:, None]
        distance = np.where(self.exists[row][:, None], np.einsum("npqi,npqi->npq", between, between), np.inf)
        pressure = np.take_along_axis(self.pressure[row], distance.argmin(axis=2), axis=1) + np.finfo(np.float32).tiny
        share = np.where(listed & same[:, None], pressure, 0.0)
        share /= np.maximum(share.sum(axis=1, keepdims=True), np.finfo(np.float32).tiny)
        return share[..., None] * self.impulse[row][:, None]


class ContactReader:
    """Reader of the contacts of bodies. The reader reuses its buffer from call to call."""

    def __init__(self) -> None:
        self._room = 256
        self._buffer = ffi.new("b3ContactData[]", self._room)

    def read(self, handles: Iterable[Any]) -> Manifolds:
        """Return the contacts of bodies, including contacts whose points do not touch yet."""
        data, count = self._collect(list(handles))
        listed = np.frombuffer(ffi.buffer(data, count * _CONTACT.itemsize), _CONTACT)
        _, once = np.unique(listed["contact"], return_index=True)  # a contact of two of the bodies is listed twice
        blocks = [ffi.buffer(data[row].manifolds, _MANIFOLD.itemsize) for row in once.tolist()]
        manifolds = np.frombuffer(b"".join(blocks), _MANIFOLD)
        points, normal = manifolds["points"], manifolds["normal"].astype(np.float64)
        exists = np.arange(4) < manifolds["point_count"][:, None]
        pressure = np.where(exists, points["normal_impulse"], 0.0)
        return Manifolds(
            listed["contact"][once],
            listed["shape_a"][once],
            listed["shape_b"][once],
            normal,
            exists,
            points["anchor_a"].astype(np.float64),
            points["anchor_b"].astype(np.float64),
            points["separation"].astype(np.float64),
            pressure,
            pressure.sum(axis=1, keepdims=True) * normal + manifolds["friction_impulse"],
        )

    def _collect(self, handles: list[Any]) -> tuple[Any, int]:
        """Return Box3D's rows of all contacts of the bodies, and the number of rows."""
        get = lib.b3Body_GetContactData
        while True:
            count = 0
            for handle in handles:
                count += get(handle, self._buffer + count, self._room - count)
            if count < self._room:
                return self._buffer, count
            self._room *= 2  # full: there may be more
            self._buffer = ffi.new("b3ContactData[]", self._room)
