"""Kernels that sort Chipmunk's contacts by the bodies' rows and lift them from the plane to three dimensions.

The port and the suite's adapter share the kernels. See ``pymunk_reader`` for the rows.

Numba compiles the functions, because a few dozen NumPy calls take ten times as long as Chipmunk's step of a frozen
stack (some microseconds). Lengths are in engine units unless a docstring states another unit.
"""

from __future__ import annotations

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray

Rows = tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray]


@numba.njit(cache=True)
def lift_contacts(
    engine_ids: IntArray,
    ids: IntArray,
    arbiters: IntArray,
    numbers: FloatArray,
    is_live: np.ndarray[tuple[int], np.dtype[np.bool_]],
    fixed: int,
    state: FloatArray,
    before: FloatArray,
    depths: FloatArray,
    units_per_metre: float,
) -> Rows:
    """Return the contacts that touch a selected body, sorted by the bodies' rows, in three dimensions.

    Each of Chipmunk's points gives two points: the ends of a line along y, as long as the smaller depth of the pair.
    Chipmunk may swap the bodies of a pair from step to step. In the result, body a has the lower row. Between
    coincident corners Chipmunk reports a normal of length zero and no force. The kernel skips this pair.

    Args:
        engine_ids: the engine's ids of all bodies, sorted.
        ids: the row of each engine id. Negative rows (ground -1, fixed boxes below) select the last rows of the arrays
            below.
        arbiters: engine ids of a and b, and the number of points, shape (m, 3).
        numbers: the numbers of each arbiter, shape (m, 12), with the columns of ``pymunk_reader.Arbiters``.
        is_live: mask of the selected bodies, such as the live bodies, by row, shape (n + fixed,).
        fixed: number of bodies with negative rows.
        state: states by row, with the columns of ``SpaceReader.state``, shape (n + fixed, 6).
        before: velocity and spin before each substep, by row, in engine units, shape (substeps, n + fixed, 3).
        depths: extents along y [m] by row, shape (n + fixed,).
        units_per_metre: engine units per metre.

    Returns:
        Five arrays in SI units:

        - rows of bodies a and b, shape (k, 2);
        - points [m], shape (k, 3);
        - normals, shape (k, 3);
        - separations [m], shape (k,);
        - velocities of b relative to a [m/s] in the substep with the fastest approach, shape (k, 3); NaN without
          recorded substeps.
    """
    rows = len(is_live)
    order, keys = np.empty(len(arbiters), np.int64), np.empty(len(arbiters), np.int64)
    live = 0
    size = 0
    for k in range(len(arbiters)):
        a = ids[np.searchsorted(engine_ids, arbiters[k, 0])]
        b = ids[np.searchsorted(engine_ids, arbiters[k, 1])]
        has_normal = numbers[k, 0] != 0.0 or numbers[k, 1] != 0.0
        if has_normal and (is_live[a] or is_live[b]):
            key = (min(a, b) + fixed) * rows + max(a, b) + fixed
            place = live  # insertion sort, because the rows are few and argsort takes seconds to compile
            while place > 0 and keys[place - 1] > key:
                order[place], keys[place] = order[place - 1], keys[place - 1]
                place -= 1
            order[place], keys[place] = k, key
            live += 1
            size += 2 * arbiters[k, 2]

    pairs = np.empty((size, 2), np.int64)
    points, normals, velocities = np.zeros((size, 3)), np.zeros((size, 3)), np.zeros((size, 3))
    separations = np.empty(size)
    row = 0
    for place in range(live):
        k = order[place]
        a, b = keys[place] // rows - fixed, keys[place] % rows - fixed
        turn = 1.0 if ids[np.searchsorted(engine_ids, arbiters[k, 0])] == a else -1.0
        nx, nz = turn * numbers[k, 0], turn * numbers[k, 1]
        depth = min(depths[a], depths[b])
        for slot in range(arbiters[k, 2]):
            on_a_x, on_a_z, on_b_x, on_b_z, distance = numbers[k, 2 + 5 * slot : 7 + 5 * slot]
            x, z = (on_a_x + on_b_x) / 2, (on_a_z + on_b_z) / 2
            vx, vz = _fastest_approach(a, b, x, z, nx, nz, state, before)
            for y in (-depth / 2, depth / 2):
                pairs[row] = a, b
                points[row] = x / units_per_metre, y, z / units_per_metre
                normals[row] = nx, 0.0, nz
                separations[row] = distance / units_per_metre
                velocities[row] = vx / units_per_metre, 0.0, vz / units_per_metre
                row += 1
    return pairs, points, normals, separations, velocities


@numba.njit(cache=True)
def _fastest_approach(
    a: int, b: int, x: float, z: float, nx: float, nz: float, state: FloatArray, before: FloatArray
) -> tuple[float, float]:
    """Return the velocity of b relative to a at (x, z) in the substep with the fastest approach along (nx, nz)."""
    fastest, vx, vz = np.inf, np.nan, np.nan
    for substep in range(len(before)):
        of_a, of_b = before[substep, a], before[substep, b]
        # A body of spin w moves the end of an arm (x, z) at the velocity w (-z, x).
        ux = of_b[0] - of_b[2] * (z - state[b, 1]) - of_a[0] + of_a[2] * (z - state[a, 1])
        uz = of_b[1] + of_b[2] * (x - state[b, 0]) - of_a[1] - of_a[2] * (x - state[a, 0])
        closing = ux * nx + uz * nz
        if closing < fastest:
            fastest, vx, vz = closing, ux, uz
    return vx, vz
