"""ODE's collision detection and its contact joints, in compiled code.

ODE calls a callback for each pair of geometries whose bounding boxes meet, and the callback records the pair. Then a
kernel makes ODE collide the pairs that touch a live body, and a second kernel joins the bodies at each contact point.
Compiled code makes these calls, because in Python they would take longer than the step.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numba import carray, types  # type: ignore[attr-defined]

from adapters._ode_library import CONTACT, FEEDBACK, address_of, c_call, lib
from stability_core.port import BoolArray, FloatArray, IntArray

MOST_POINTS = 8
"""Greatest number of contact points of two boxes. ODE clips one face by the four edges of another face, and each cut
adds at most one corner to the first four corners."""
_APPROX_1 = 0x7000
"""Flag ``dContactApprox1``: the bound of friction is mu times the normal force, not mu [N]."""
_HEAD = 2
"""Count of numbers before the pairs in a list of pairs: the number of pairs, and the greatest number of pairs."""

_data_of = c_call(types.intp(types.intp))
_collide = c_call(types.int32(types.intp, types.intp, types.int32, types.intp, types.int32))
_create = c_call(types.intp(types.intp, types.intp, types.intp))
_attach = c_call(types.void(types.intp, types.intp, types.intp))
_feed_back = c_call(types.void(types.intp, types.intp))
_ADDRESSES = [
    address_of(name)
    for name in ("dGeomGetData", "dCollide", "dJointCreateContact", "dJointAttach", "dJointSetFeedback")
]
_DATA_OF, _COLLIDE, _CREATE, _ATTACH, _FEED_BACK = _ADDRESSES


@numba.cfunc("void(CPointer(int64), intp, intp)", cache=True)
def _note_pair(pairs: Any, first: int, second: int) -> None:
    """Add a pair of geometries to the list, if the list has room; count the pair in any case."""
    head = carray(pairs, _HEAD)
    count = head[0]
    head[0] = count + 1
    if count < head[1]:
        listed = carray(pairs, _HEAD + 2 * head[1])
        listed[_HEAD + 2 * count] = first
        listed[_HEAD + 2 * count + 1] = second


@numba.njit(
    types.int64(
        types.intp,
        types.intp,
        types.int64[::1],
        types.boolean[::1],
        types.int64,
        types.intp,
        types.int64,
        types.int64[::1],
        types.int64[::1],
    ),
    cache=True,
)
def _collide_pairs(
    data_of: int,
    collide: int,
    pairs: IntArray,
    is_live: BoolArray,
    lowest: int,
    address: int,
    stride: int,
    body_a: IntArray,
    body_b: IntArray,
) -> int:
    """Find the contact points of the pairs that touch a live body, sorted by bodies; return the number of points.

    The order of the points follows from the ids of the bodies, not from the order of ODE's space. Therefore an
    additional detection does not change the solver's result.

    Args:
        data_of: address of ``dGeomGetData``, which returns the body of a geometry.
        collide: address of ``dCollide``.
        pairs: list of pairs.
        is_live: True for each live body, by its id.
        lowest: the lowest id, which belongs to the ground or a fixed box.
        address: address of the first contact's geometry.
        stride: size of a contact [bytes].
        body_a: output, the first body of each point, which has the lower id; one row for each possible point.
        body_b: output, the second body of each point; one row for each possible point.
    """
    span = len(is_live) - lowest
    keys, kept = np.empty(pairs[0], np.int64), np.empty((pairs[0], 2), np.int64)
    chosen = 0
    for pair in range(pairs[0]):
        first, second = pairs[_HEAD + 2 * pair], pairs[_HEAD + 2 * pair + 1]
        a, b = _data_of(data_of, (first,)), _data_of(data_of, (second,))
        if (a >= 0 and is_live[a]) or (b >= 0 and is_live[b]):
            low, high = min(a, b) - lowest, max(a, b) - lowest
            keys[chosen] = low * span + high
            kept[chosen, 0] = first if a < b else second
            kept[chosen, 1] = second if a < b else first
            chosen += 1
    count, most = 0, np.int32(MOST_POINTS)
    for row in np.argsort(keys[:chosen]):
        low, high = keys[row] // span + lowest, keys[row] % span + lowest
        points = _collide(collide, (kept[row, 0], kept[row, 1], most, address + count * stride, np.int32(stride)))
        body_a[count : count + points] = low
        body_b[count : count + points] = high
        count += points
    return count


@numba.njit(
    types.void(
        types.intp,
        types.intp,
        types.intp,
        types.intp,
        types.intp,
        types.int64[::1],
        types.int64[::1],
        types.int64[::1],
        types.intp,
        types.int64,
        types.intp,
        types.int64,
    ),
    cache=True,
)
def _join_bodies(
    create: int,
    attach: int,
    feed_back: int,
    world: int,
    group: int,
    handles: IntArray,
    body_a: IntArray,
    body_b: IntArray,
    address: int,
    stride: int,
    feedback: int,
    feedback_stride: int,
) -> None:
    """Create a contact joint at each of n contact points.

    Args:
        create: address of ``dJointCreateContact``.
        attach: address of ``dJointAttach``.
        feed_back: address of ``dJointSetFeedback``.
        world: handle of the world.
        group: handle of the group of all contact joints.
        handles: handles of the bodies, by id; 0 for a frozen body.
        body_a: ids of the first bodies, negative for the ground and fixed boxes, shape (n,).
        body_b: ids of the second bodies, shape (n,).
        address: address of the first contact.
        stride: size of a contact [bytes].
        feedback: address of the first contact's feedback; 0 for no feedback.
        feedback_stride: size of a feedback [bytes].
    """
    for row in range(len(body_a)):
        joint = _create(create, (world, group, address + row * stride))
        a, b = body_a[row], body_b[row]
        _attach(attach, (joint, handles[a] if a >= 0 else 0, handles[b] if b >= 0 else 0))
        if feedback:
            _feed_back(feed_back, (joint, feedback + row * feedback_stride))


class ContactFinder:
    """Detector of contacts, which also joins the bodies in contact. The detector reuses its memory."""

    def __init__(self, friction: float) -> None:
        self._friction = friction
        self._pairs = np.zeros(_HEAD + 2 * 64, np.int64)
        self._make_room(64)
        self._is_b_first = np.empty(0, np.bool_)
        self.count = 0
        """Number of contact points of the latest detection."""

    def find(self, space: int, is_live: BoolArray, lowest: int) -> None:
        """Detect the contacts at the present poses that touch a live body.

        Args:
            space: handle of the space of all geometries.
            is_live: True for each live body, by its id.
            lowest: the lowest id, which belongs to the ground or a fixed box.
        """
        self._pairs[:_HEAD] = 0, len(self._pairs) // 2 - 1
        lib.dSpaceCollide(space, self._pairs.ctypes.data, _note_pair.address)
        if self._pairs[0] > self._pairs[1]:
            self._pairs = np.zeros(_HEAD + 4 * int(self._pairs[0]), np.int64)
            self.find(space, is_live, lowest)
            return
        if MOST_POINTS * self._pairs[0] > len(self._contacts):
            self._make_room(2 * MOST_POINTS * int(self._pairs[0]))
        self.count = _collide_pairs(
            _DATA_OF,
            _COLLIDE,
            self._pairs,
            is_live,
            lowest,
            self._contacts["geom"].ctypes.data,
            CONTACT.itemsize,
            self._body_a,
            self._body_b,
        )

    def join(self, world: int, group: int, handles: IntArray, *, feedback: bool) -> None:
        """Join the bodies at the contacts of the latest detection, for the next step.

        Args:
            world: handle of the world.
            group: handle of the group of all contact joints.
            handles: handles of the bodies, by id; 0 for a frozen body.
            feedback: True if ODE must record forces.
        """
        self._feedback[: self.count] = np.zeros((), FEEDBACK)
        _join_bodies(
            _CREATE,
            _ATTACH,
            _FEED_BACK,
            world,
            group,
            handles,
            self._body_a[: self.count],
            self._body_b[: self.count],
            self._contacts.ctypes.data,
            CONTACT.itemsize,
            self._feedback.ctypes.data if feedback else 0,
            FEEDBACK.itemsize,
        )
        body_a = self._body_a[: self.count]
        self._is_b_first = (body_a < 0) | (handles[body_a] == 0)

    @property
    def pairs(self) -> tuple[IntArray, IntArray]:
        """Return bodies a and b of each contact, each of shape (n,)."""
        return self._body_a[: self.count].copy(), self._body_b[: self.count].copy()

    @property
    def geometry(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return points (n, 3) [m], unit normals (n, 3) from a to b, and separations (n,) [m]."""
        geom = self._contacts[: self.count]["geom"]
        normal = -geom["normal"][:, :3].astype(np.float64)  # ODE's points into the first body
        return geom["position"][:, :3].astype(np.float64), normal, -geom["depth"].astype(np.float64)

    @property
    def forces(self) -> FloatArray:
        """Return the forces (n, 3) [N] on bodies b in the step that followed ``join``."""
        force = self._feedback[: self.count]["force_1"][:, :3].astype(np.float64)
        force[~self._is_b_first] *= -1.0  # ODE's first body is a, or b if nothing moves a
        return force

    def _make_room(self, points: int) -> None:
        self._contacts = np.zeros(points, CONTACT)
        self._contacts["surface"]["mode"], self._contacts["surface"]["mu"] = _APPROX_1, self._friction
        self._feedback = np.zeros(points, FEEDBACK)
        self._body_a, self._body_b = np.empty(points, np.int64), np.empty(points, np.int64)
