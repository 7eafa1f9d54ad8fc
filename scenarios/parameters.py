"""Parameters of scenes: their ranges, and the id of the variant with given values.

A builder is a function that plans a scene. The builder annotates a parameter with its range, as in ``courses:
Annotated[int, Whole(1, 200)] = 8``. A decorator of ``scenarios.scenario`` turns the builder into a scenario. The
scenario checks each value with a range before the builder runs. The builder itself checks all other values.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Protocol, TypeAlias, TypeGuard

from scenarios.lookup import one_of

Value: TypeAlias = float | int | str


class Range(Protocol):
    """The allowed values of a parameter. ``str`` of a range returns the range as text for users."""

    def check(self, name: str, value: object) -> Value:
        """Return ``value``, converted to the parameter's type.

        Raises:
            ValueError: if the range does not contain ``value``; the message names the parameter and the range.
        """


@dataclass(frozen=True, slots=True)
class Whole:
    """Whole numbers from ``least`` to ``most``."""

    least: int
    most: int

    def check(self, name: str, value: object) -> int:
        """Return ``value`` as an integer.

        Raises:
            ValueError: if ``value`` is no whole number in the range; the message names the parameter and the range.
        """
        if _is_number(value) and self.least <= value <= self.most and value % 1 == 0:
            return int(value)
        raise ValueError(f"{name} must be a whole number from {self}, got {value!r}: give a number in this range")

    def __str__(self) -> str:
        return f"{self.least} to {self.most}"


@dataclass(frozen=True, slots=True)
class Real:
    """Numbers from ``least`` to ``most``."""

    least: float
    most: float
    unit: str = ""
    """Unit of the numbers, for the message of an error; empty for a ratio or a coefficient."""

    def check(self, name: str, value: object) -> float:
        """Return ``value`` as a float.

        Raises:
            ValueError: if ``value`` is no number in the range, or NaN; the message names the parameter and the range.
        """
        if _is_number(value) and self.least <= value <= self.most:
            return float(value)
        unit = f" {self.unit}" if self.unit else ""
        raise ValueError(f"{name} must be a number from {self}{unit}, got {value!r}: give a number in this range")

    def __str__(self) -> str:
        return f"{self.least:g} to {self.most:g}"


class Choice:
    """A choice among allowed words."""

    __slots__ = ("words",)

    def __init__(self, *words: str) -> None:
        self.words = words

    def check(self, name: str, value: object) -> str:
        """Return the word that equals ``value``.

        Raises:
            ValueError: if ``value`` is none of the words; the message names the parameter and all words.
        """
        for word in self.words:
            if value == word:
                return word
        raise ValueError(f"{name} must be {one_of(self.words)}, got {value!r}: give one of these words")

    def __str__(self) -> str:
        return ", ".join(self.words)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


Margin: TypeAlias = Annotated[float, Real(-0.5, 0.5)]
"""Distance from the limit, as a share of the limit: see ``scenarios.margins``."""
Scale: TypeAlias = Annotated[float, Real(0.1, 100)]
"""Factor on all lengths, relative to the standard plank."""
Gap: TypeAlias = Annotated[float, Real(0, 20, "mm")]
"""Distance [mm] between neighbours."""
Friction: TypeAlias = Annotated[float, Real(0, 2)]
"""Coulomb coefficient of every pair."""


def variant_of(name: str, defaults: Mapping[str, Value], parameters: Mapping[str, Value]) -> str:
    """Return the id of a variant: the scenario's name, then every value that differs from its default.

    The id gives the first parameter without its name, as in ``card_house-2``, and every other parameter with its name,
    as in ``card_house-2-theta75``. Different variants have different ids. Every id is a valid file name.
    """
    parts = [name]
    for index, (parameter, default) in enumerate(defaults.items()):
        if parameters[parameter] != default:
            parts.append(("" if index == 0 else parameter) + short(parameters[parameter]))
    return "-".join(parts)


def short(value: Value) -> str:
    """Return the text of a value in an id, without decimals for a whole number."""
    if isinstance(value, float) and math.isfinite(value) and value.is_integer():
        return str(int(value))
    return str(value)
