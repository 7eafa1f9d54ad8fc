"""Compile kernels with Numba, and keep the compiled kernels in Numba's cache on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.errors import TypingError as WrongTypeError

__all__ = ["KEPT", "NOT_KEPT", "WrongTypeError", "compiled"]

Kernel = TypeVar("Kernel", bound=Callable[..., object])
NOT_KEPT: list[str] = []
"""Reasons, one per kernel, why compiled kernels cannot be cached for later processes; empty if a cache exists."""
KEPT: list[Any] = []
"""Kernels that are cached on disk."""


def compiled(function: Kernel, **options: Any) -> Kernel:
    """Compile ``function`` on its first call. As in NumPy, a division by zero gives inf or nan, not an exception.

    Args:
        function: a function that Numba can compile.
        options: further options of Numba, such as ``fastmath``.
    """
    try:
        kernel = njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError as error:  # neither the package's folder nor the user's is writable
        NOT_KEPT.append(str(error))
        return cast("Kernel", njit(error_model="numpy", **options)(function))
    KEPT.append(kernel)
    return cast("Kernel", kernel)
