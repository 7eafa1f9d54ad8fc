"""Search for contacts that Chipmunk does not list: at the present poses, and ahead of fast bodies."""

from __future__ import annotations

import numpy as np
import pymunk

from stability_core.port import FloatArray, IntArray
from stability_core.ports.pymunk_bodies import PymunkBodies
from stability_core.ports.pymunk_reader import Arbiters, arbiters_of, numbers_of
from stability_core.ports.pymunk_touch import collide, found_contacts, meeting_of, outline_of

FAST = 0.05
"""Path of a body in a frame [reaches of the body], above which the port looks ahead for frozen bodies on this path."""
HORIZON = 2.0
"""Number of frames for which the port looks ahead, because a struck body must be live in the step of the impact."""


def contacts_in_place(space: pymunk.Space, bodies: PymunkBodies) -> Arbiters:
    """Return the contacts of the live bodies at the present poses, up to the gap ``NEAR`` of ``pymunk_touch``."""
    live = [shape for planar in bodies.rows if planar in bodies.live for shape in planar.shapes]
    others = [shape for shape in space.shapes if shape.body not in bodies.live]
    return found_contacts([shape for shape in live if shape.space is space], others)


def fast_rows(bodies: PymunkBodies, state: FloatArray, dt: float) -> IntArray:
    """Return the rows of live bodies and loose obstacles with a path above ``FAST`` in a frame.

    Args:
        bodies: the bodies of the space.
        state: states of the rows, with the columns of ``SpaceReader.state``.
        dt: length of the frame [s].
    """
    rows = np.flatnonzero(bodies.is_live | bodies.is_loose)
    way = np.hypot(state[rows, 3], state[rows, 4]) * dt
    fast: IntArray = rows[way > FAST * bodies.depths[rows]]
    return fast


def contacts_ahead(space: pymunk.Space, bodies: PymunkBodies, rows: IntArray, state: FloatArray, dt: float) -> Arbiters:
    """Return the contacts in which the bodies of ``rows`` will meet frozen bodies within ``HORIZON`` frames.

    The search assumes that the bodies of ``rows`` keep their velocities, and do not turn.

    Args:
        space: the space.
        bodies: the bodies of the space.
        rows: rows of ``bodies``, shape (k,).
        state: states of the rows, with the columns of ``SpaceReader.state``.
        dt: length of the frame [s].
    """
    arbiters, numbers = [], []
    for row in rows.tolist():
        planar = bodies.rows[row]
        x, y = (state[row, 3:5] * (HORIZON * dt)).tolist()
        for shape in planar.shapes:
            outline, box = outline_of(shape), shape.bb
            swept = pymunk.BB(box.left + min(x, 0), box.bottom + min(y, 0), box.right + max(x, 0), box.top + max(y, 0))
            for other in space.bb_query(swept, shape.filter):
                if other.body not in bodies.frozen or not collide(shape, other):
                    continue
                meeting = meeting_of(outline, outline_of(other), (x, y))
                if meeting is not None and meeting.points:
                    arbiters.append((planar.id, other.body.id, len(meeting.points)))
                    numbers.append(numbers_of(meeting.normal, meeting.points))
    return arbiters_of(arbiters, numbers)
