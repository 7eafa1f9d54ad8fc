"""How the kernels are compiled: by Numba, once, into its cache on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit
from numba.core.errors import TypingError as WrongTypeError

__all__ = ["WrongTypeError", "compiled"]

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def compiled(function: Kernel) -> Kernel:
    """Compile ``function`` on its first call. NumPy's rules for division: x / 0 is inf, not an exception."""
    return cast("Kernel", njit(cache=True, error_model="numpy")(function))
