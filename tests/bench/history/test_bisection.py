"""Bisection over versions: it finds the first new version with few runs, and passes by versions that cannot run."""

import math

import pytest

from bench.history.bisection import BisectionError, first_new
from bench.history.figures import Figure

LEVELS = Figure("levels of tower-9", "levels", "levels", None)


@pytest.mark.parametrize("at", range(1, 40))
def test_the_first_new_version_is_found_with_a_logarithm_of_runs(at) -> None:
    asked = []

    def value(index: int) -> float:
        asked.append(index)
        return 9.0 if index < at else 8.0

    found = first_new([f"1.{index}" for index in range(40)], value, LEVELS)
    assert (found.last_old, found.first_new, found.untested) == (at - 1, at, ())
    assert len(asked) <= 2 + math.ceil(math.log2(40))


def test_versions_without_a_value_are_named() -> None:
    values = [9.0, 9.0, None, None, 8.0, 8.0]
    found = first_new(list("abcdef"), values.__getitem__, LEVELS)
    assert (found.last_old, found.first_new, found.untested) == (1, 4, (2, 3))


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (
            [1.0, 1.5],
            "'levels of tower-9' must differ by a step .*, got 1 level in 3.0 and 1.5 levels in 4.0: name other",
        ),
        (
            [None, 9.0],
            "must have a value in the first .*, got no value in 3.0 and 9 levels in 4.0: name other versions",
        ),
    ],
)
def test_ends_must_differ(values, reason) -> None:
    with pytest.raises(BisectionError, match=reason):
        first_new(["3.0", "4.0"], values.__getitem__, LEVELS)
