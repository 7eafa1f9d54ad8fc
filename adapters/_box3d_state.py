"""Poses and velocities of many Box3D bodies, read in one call."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from robox3d._ffi import ffi, shim

from stability_core.port import FloatArray

_BATCH: Any = shim
"""Module of the package whose functions read many bodies in one call."""


def raw_handle(handle: Any) -> int:
    """Return a body's handle as a number of 8 bytes, so that an array can hold many handles."""
    return int.from_bytes(ffi.buffer(ffi.addressof(handle)), "little")


def poses_of(raw_handles: npt.NDArray[np.uint64]) -> FloatArray:
    """Return positions [m] and quaternions (x, y, z, w) of bodies (n,), shape (n, 7)."""
    return _batch(_BATCH.rxBodyGetPoses, raw_handles, 7)


def velocities_of(raw_handles: npt.NDArray[np.uint64]) -> FloatArray:
    """Return linear [m/s] and angular [rad/s] velocities of bodies (n,), shape (n, 6)."""
    return _batch(_BATCH.rxBodyGetVelocities, raw_handles, 6)


def _batch(function: Any, raw_handles: npt.NDArray[np.uint64], width: int) -> FloatArray:
    rows = np.empty((len(raw_handles), width), np.float32)
    function(ffi.from_buffer("b3BodyId[]", raw_handles), len(raw_handles), ffi.from_buffer("float[]", rows))
    return rows.astype(np.float64)
