"""Sparse factors in an envelope against numpy.linalg."""

import numpy as np
import pytest

from stability_core.equilibrium.envelope import (
    envelope_of,
    factorize,
    factorize_general,
    numbering,
    substitute,
    substitute_general,
)
from stability_core.port import GROUND

WIDTH = 3
"""Rows of a block; factors are made in tiles of three."""
CHAIN = [(i, i + 1) for i in range(11)]
WALL = [(i, j) for i in range(12) for j in (i + 3, i + 4) if j < 12]
STAR = [(0, i) for i in range(1, 12)]
APART = [(0, 5), (5, 9), (2, 7), (7, 1)]
ON_GROUND = [(GROUND, 0), (GROUND, 1), (0, 2), (2, 0), (1, 2)]
GRAPHS = {"chain": CHAIN, "wall": WALL, "star": STAR, "apart": APART, "on_ground": ON_GROUND, "alone": []}
N = 12
every_graph = pytest.mark.parametrize("pairs", GRAPHS.values(), ids=GRAPHS)


def ends(pairs):
    return tuple(np.array([pair[k] for pair in pairs], np.int64) for k in (0, 1))


def ordered(pairs, width=WIDTH):
    """The place of each body and the envelope."""
    place = numbering(*ends(pairs), N)
    return place, envelope_of(*ends(pairs), place, width)


def random_matrix(pairs, place, generator):
    """A matrix of the pattern of ``pairs``, numbered by ``place``, whose diagonal dominates."""
    dense = np.zeros((N * WIDTH, N * WIDTH))
    blocks = [(i, i) for i in range(N)] + [pair for a, b in pairs if min(a, b) >= 0 for pair in ((a, b), (b, a))]
    for a, b in blocks:
        i, j = place[a] * WIDTH, place[b] * WIDTH
        dense[i : i + WIDTH, j : j + WIDTH] = generator.normal(size=(WIDTH, WIDTH))
    return dense + N * WIDTH * np.eye(N * WIDTH)


def stored(dense, envelope):
    """The lower triangle as it is kept in the envelope."""
    values = np.zeros(envelope.size)
    for i, first in enumerate(envelope.first):
        values[envelope.offset[i] + first : envelope.offset[i] + i + 1] = dense[i, first : i + 1]
    return values


@every_graph
def test_the_numbering_gives_each_body_a_place_of_its_own(pairs):
    place, _ = ordered(pairs)
    assert sorted(place) == list(range(N))


@every_graph
def test_every_entry_of_the_pattern_has_a_place_and_no_two_share_one(pairs):
    place, envelope = ordered(pairs)
    dense = random_matrix(pairs, place, np.random.default_rng(1))
    rows, columns = np.nonzero(np.tril(dense))
    assert (envelope.first[rows] <= columns).all()
    places = [envelope.offset[i] + j for i in range(N * WIDTH) for j in range(envelope.first[i], i + 1)]
    assert sorted(places) == list(range(envelope.size))


def test_a_column_numbered_at_random_still_has_short_rows():
    """In reverse Cuthill-McKee order a row of a chain reaches to the body before it and no farther."""
    shuffled = np.random.default_rng(2).permutation(N)
    _, envelope = ordered([(shuffled[a], shuffled[b]) for a, b in CHAIN])
    assert (np.arange(N * WIDTH) - envelope.first < 2 * WIDTH).all()


@every_graph
def test_a_symmetric_system_is_solved_as_numpy_solves_it(pairs):
    generator = np.random.default_rng(3)
    place, envelope = ordered(pairs)
    half = random_matrix(pairs, place, generator)
    dense = (half + half.T) / 2
    factor, x = stored(dense, envelope), generator.normal(size=N * WIDTH)
    expected = np.linalg.solve(dense, x)
    factorize(factor, envelope)
    substitute(factor, envelope, x)
    assert x == pytest.approx(expected, rel=1e-12, abs=1e-14)


def test_the_factor_is_choleskys_with_its_diagonal_inverted():
    place, envelope = ordered(WALL)
    half = random_matrix(WALL, place, np.random.default_rng(4))
    dense = (half + half.T) / 2
    factor = stored(dense, envelope)
    factorize(factor, envelope)
    expected = np.linalg.cholesky(dense)
    np.fill_diagonal(expected, 1 / np.diag(expected))
    assert factor == pytest.approx(stored(expected, envelope), rel=1e-12, abs=1e-14)


@every_graph
def test_a_general_system_is_solved_as_numpy_solves_it(pairs):
    generator = np.random.default_rng(5)
    place, envelope = ordered(pairs)
    dense = random_matrix(pairs, place, generator)
    lower, upper, x = stored(dense, envelope), stored(dense.T, envelope), generator.normal(size=N * WIDTH)
    expected = np.linalg.solve(dense, x)
    factorize_general(lower, upper, envelope)
    substitute_general(lower, upper, envelope, x)
    assert x == pytest.approx(expected, rel=1e-12, abs=1e-14)
