"""Checks of a scene's parameters, and the id of the variant that they make."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from scenarios.model import Scene

Value: TypeAlias = float | int | str


def whole(name: str, value: object, *, least: int, most: int) -> int:
    """``value`` as an integer from ``least`` to ``most``.

    Raises:
        ValueError: if it is anything else; the message names the range.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool) and least <= value <= most and value % 1 == 0:
        return int(value)
    raise ValueError(f"{name} must be a whole number from {least} to {most}, got {value!r}")


def real(name: str, value: object, *, least: float, most: float) -> float:
    """``value`` as a number from ``least`` to ``most``.

    Raises:
        ValueError: if it is anything else, NaN included; the message names the range.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool) and least <= value <= most:
        return float(value)
    raise ValueError(f"{name} must be a number from {least:g} to {most:g}, got {value!r}")


def choice(name: str, value: object, among: Sequence[str]) -> str:
    """``value`` as one of the words ``among`` which it must be.

    Raises:
        ValueError: if it is anything else; the message names them all.
    """
    for word in among:
        if value == word:
            return word
    raise ValueError(f"{name} must be one of {', '.join(among)}, got {value!r}")


def defaults(builder: Callable[..., Scene]) -> dict[str, Value]:
    """The parameters of a scene's builder and their defaults, in the order in which it declares them."""
    return {name: parameter.default for name, parameter in inspect.signature(builder).parameters.items()}


def variant_of(builder: Callable[..., Scene], parameters: Mapping[str, Value]) -> str:
    """The id of a variant: the scenario's name, then whatever differs from the defaults.

    The first parameter, the one that a scenario is varied by, comes bare: ``card_house-2``; the others follow their
    names: ``card_house-2-theta75``. So no two variants share an id, and an id is fit for a file name.
    """
    parts = [builder.__name__]
    for index, (name, default) in enumerate(defaults(builder).items()):
        if parameters[name] != default:
            parts.append(("" if index == 0 else name) + short(parameters[name]))
    return "-".join(parts)


def short(value: Value) -> str:
    """Return a value in the fewest characters that tell it from any other."""
    if isinstance(value, float) and math.isfinite(value) and value.is_integer():
        return str(int(value))
    return str(value)
