"""Rows of motions of bodies, in the columns of ``COLUMNS``, and checks of these rows."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from stability_core.port import BoolArray, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions

COLUMNS = 13
"""Number of columns of a row, in the world's frame: centre of mass [m] (3), quaternion (x, y, z, w) (4), velocity [m/s]
(3) and spin [rad/s] (3)."""
CENTER, POSE, VELOCITY, SPIN = slice(0, 3), slice(0, 7), slice(7, 10), slice(10, 13)
_TURN = slice(3, 7)
_TURNED = 1e-4
"""Greatest change of a component of an obstacle's quaternion without a turn: about 0.01 degrees."""


def check_finite(ids: IntArray, rows: FloatArray) -> None:
    """Raise ``ValueError`` if a number in the rows (n, 13) of bodies (n,) is not finite."""
    if not np.isfinite(rows).all():
        body = ids[np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]]
        raise ValueError(
            f"body {body} has a pose or a velocity that is not finite, because the simulation has diverged or the "
            "program has set the value: use a smaller step or softer contacts, correct the value, or remove the body"
        )


def turned_bodies(
    bodies: Collection[int], ids: IntArray, rows: FloatArray, earlier_ids: IntArray, earlier_rows: FloatArray
) -> list[int]:
    """Return the bodies that have turned between two frames; skip bodies without a row in each frame.

    Args:
        bodies: ids of the bodies to compare.
        ids: ids of the later frame's rows, shape (n,).
        rows: rows of the later frame, or their first seven columns, shape (n, 13) or (n, 7).
        earlier_ids: ids of the earlier frame's rows, shape (m,).
        earlier_rows: rows of the earlier frame, shape (m, 13) or (m, 7).
    """
    if not bodies:
        return []
    earlier = dict(zip(earlier_ids.tolist(), earlier_rows, strict=True))
    return [
        body
        for body, row in zip(ids.tolist(), rows, strict=True)
        if body in bodies and body in earlier and abs(row[_TURN] - earlier[body][_TURN]).max() > _TURNED
    ]


def rows_of_ids(known: IntArray, ids: IntArray) -> tuple[IntArray, BoolArray]:
    """Return the rows of ids (n,) in ``known`` (m,), and the mask of the known ids; an unknown id has the row 0.

    Args:
        known: ids by rising value, at least one.
        ids: ids to find.
    """
    at = np.minimum(np.searchsorted(known, ids), len(known) - 1)
    is_known: BoolArray = known[at] == ids
    return np.where(is_known, at, 0), is_known


def motions_of(ids: IntArray, rows: FloatArray) -> Motions:
    """Return the motions before a frame of one step, from the rows (n, 13) of bodies (n,)."""
    return Motions(ids, *(np.ascontiguousarray(rows[None, :, part]) for part in (CENTER, VELOCITY, SPIN)))
