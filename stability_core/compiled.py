"""Compile kernels with Numba, and keep the compiled kernels in Numba's cache on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.errors import TypingError as WrongTypeError

__all__ = ["KEPT", "NOT_KEPT", "WrongTypeError", "compiled"]

Kernel = TypeVar("Kernel", bound=Callable[..., object])
NOT_KEPT: list[str] = []
"""Reasons, one per kernel, why Numba cannot cache the kernel on disk. The list is empty if the cache is writable."""
KEPT: list[Any] = []
"""Kernels that Numba caches on disk."""


def compiled(function: Kernel, **options: Any) -> Kernel:
    """Return a kernel that Numba compiles from ``function`` on the first call.

    As in NumPy, a floating-point division by zero gives inf or NaN, not an exception.

    Args:
        function: a function that Numba can compile.
        options: further options of Numba, such as ``fastmath``.
    """
    try:
        kernel = njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError as error:  # neither the package's folder nor the user's cache folder is writable
        NOT_KEPT.append(str(error))
        return cast("Kernel", njit(error_model="numpy", **options)(function))
    KEPT.append(kernel)
    return cast("Kernel", kernel)
