"""The sleeping rule for piles, after Hsu and Keyser 2010: bodies inside the pile freeze, bodies on its slope stay live.

S.-W. Hsu, J. Keyser, "Piles of Objects", ACM Transactions on Graphics 29(6), 2010 (SIGGRAPH Asia). The method models a
pile by its shape, with an angle of repose as the bound. The method deactivates objects inside the pile, by more
criteria than momentum, and serves random piles, not structures. This policy adapts the method to contacts, sleep and
mass:

- The pile of a body is all frozen bodies that contacts join to the body, directly or indirectly. The base of the pile
  is the convex hull, in plan, of the pile's contact points on the ground.
- The shape of the pile is the shape of sand on this base: a roof that rises from the hull's border inward. As in the
  original method, the user chooses the angle of repose (``Settings.repose``). By default the angle of repose is
  atan(mu), with the friction coefficient mu of the contact on which a body stands.
- A body lies inside the pile if it stands on the ground, or on frozen bodies at points below the roof.
- A body inside the pile freezes once it is at rest, as in every policy, unless the body touches a moving live body.
- A body unfreezes after an impact, as in every policy, when it has lost a support, and when gravity changes.

The policy does not test balance, because inside a pile the neighbours hold bodies that would tip. With the default
angle, at most the lowest planks of a tower freeze, because a tower is steeper than a pile with its friction.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import is_moving
from stability_core.frame_buffers import AT_REST, FrameBuffers, frame_before, listed
from stability_core.policies.base import NOBODY, Decision, Policy
from stability_core.polygon import convex_hull, inside_distance
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits, Settings
from stability_core.settle import lay_due, lay_frozen, lowest_first
from stability_core.stack import FROZEN, LIVE, MAX_VERTICES, NONE, SUPPORT, Graph, is_ground, is_stack, take_changed


@compiled
def _beside_movers(graph: Graph, buffers: FrameBuffers, candidates: IntArray, limits: Limits) -> IntArray:
    """Return the ``candidates`` that touch a live body with a speed above ``moving_speed``, shape (k,).

    The cost is O(contacts of the latest frame).
    """
    for i in range(len(candidates)):
        graph.bodies[candidates[i]].place = i
    found = np.zeros(len(candidates), np.bool_)
    frame, room = frame_before(buffers, 0), len(buffers.contacts) // len(buffers.sizes)
    for row in range(frame * room, frame * room + buffers.sizes[frame]):
        pair = buffers.contacts[row].body_a, buffers.contacts[row].body_b
        for body, other in (pair, pair[::-1]):
            if body == GROUND or other == GROUND:
                continue
            place = graph.bodies[body].place  # the place may belong to another list
            is_candidate = place < len(candidates) and candidates[place] == body
            if is_candidate and graph.bodies[other].state == LIVE and is_moving(graph.bodies[other], limits):
                found[place] = True
    return candidates[found]


@compiled
def _pile_with(graph: Graph, root: int) -> IntArray:
    """Return ``root`` and all frozen bodies that contacts join to ``root``, directly or indirectly, shape (k,)."""
    reached = np.zeros(len(graph.bodies), np.bool_)
    pile = np.empty(len(graph.bodies), np.int64)
    pile[0], size, done = root, 1, 0
    reached[root] = True
    while done < size:
        row = graph.bodies[pile[done]]
        below, above = row.first_support, row.first_load
        while below != NONE or above != NONE:
            if below != NONE:
                other, below = graph.patches[below].lower, graph.patches[below].next_support
            else:
                other, above = graph.patches[above].upper, graph.patches[above].next_load
            if other != GROUND and not reached[other] and graph.bodies[other].state == FROZEN:
                reached[other] = True
                pile[size] = other
                size += 1
        done += 1
    return pile[:size]


@compiled
def _base_of(graph: Graph, pile: IntArray) -> FloatArray:
    """Return the convex hull (k, 3) [m], in plan, of the points at which a pile stands on the ground."""
    points = np.empty((MAX_VERTICES * len(pile), 3))
    n = 0
    for body in pile:
        at = graph.bodies[body].first_support
        while at != NONE:
            patch = graph.patches[at]
            if is_ground(graph.bodies, patch.lower) and patch.kind == SUPPORT:
                points[n : n + patch.vertices] = patch.vertex[: patch.vertices]
                n += patch.vertices
            at = patch.next_support
    return convex_hull(points[:n])


@compiled
def _lies_inside(graph: Graph, body: int, base: FloatArray, repose: float) -> bool:
    """Return True if ``body`` stands only on the ground, or on frozen bodies below the roof over ``base``.

    Args:
        graph: the stack.
        body: the body.
        base: hull of the pile's contact points on the ground [m], shape (k, 3).
        repose: angle of repose [rad], or 0 for the angle of friction of each contact.
    """
    stands = False
    at = graph.bodies[body].first_support
    while at != NONE:
        patch = graph.patches[at]
        at = patch.next_support
        if patch.kind != SUPPORT:
            continue
        if not is_stack(graph.bodies, patch.lower):
            return False
        stands = True
        if not is_ground(graph.bodies, patch.lower):
            slope = np.tan(repose) if repose > 0.0 else patch.friction
            roof = slope * inside_distance(base, patch.center[0], patch.center[1])
            if not patch.center[2] - base[:, 2].mean() <= roof:  # also for a pile without a base (NaN)
                return False
    return stands


@compiled
def _count_supports(graph: Graph, body: int) -> int:
    n, at = 0, graph.bodies[body].first_support
    while at != NONE:
        n += graph.patches[at].kind == SUPPORT
        at = graph.patches[at].next_support
    return n


@compiled
def _settle(graph: Graph, buffers: FrameBuffers, limits: Limits, supports: IntArray) -> tuple[IntArray, IntArray]:
    """Settle one frame, and return the newly frozen bodies, and the frozen bodies that lost a support.

    The cost is O(pile) per candidate.

    Args:
        graph: the stack.
        buffers: the worklist.
        limits: the settings.
        supports: number of load-bearing patches below each body at its freeze, shape (bodies,). The function updates
            the numbers of newly frozen bodies.
    """
    lay_due(graph, buffers, limits)
    candidates = lowest_first(graph, listed(buffers, AT_REST))
    movers = _beside_movers(graph, buffers, candidates, limits[0])
    asleep = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        base = _base_of(graph, _pile_with(graph, body))
        if not (movers == body).any() and _lies_inside(graph, body, base, limits[0].repose):
            graph.bodies[body].state, graph.bodies[body].leans = FROZEN, False
            asleep[n] = body
            n += 1
    lay_frozen(graph, buffers, limits)
    for body in asleep[:n]:
        supports[body] = _count_supports(graph, body)
    changed = take_changed(graph)
    lost = np.zeros(len(changed), np.bool_)
    for i in range(len(changed)):
        body = changed[i]
        lost[i] = graph.bodies[body].state == FROZEN and _count_supports(graph, body) < supports[body]
    return asleep[:n], changed[lost]


class Pile(Policy):
    """Policy that freezes bodies at rest inside the angle of repose of their pile."""

    name = "pile"
    judges_statics = False

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Set gravity and tolerances.

        Args:
            gravity: gravitational acceleration [m/s2], positive.
            settings: the tolerances.
        """
        super().__init__(gravity, settings)
        self._supports = NOBODY

    def set_gravity(self, gravity: float) -> None:
        """Set gravity, and unfreeze every pile in the next frame, because a pile's slope depends on the vertical."""
        super().set_gravity(gravity)
        self._supports[:] = np.iinfo(np.int64).max

    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Freeze bodies inside their piles, and find frozen bodies that lost a support: O(pile) per candidate."""
        if len(graph.bodies) > len(self._supports):
            self._supports = np.concatenate(
                (self._supports, np.zeros(len(graph.bodies) - len(self._supports), np.int64))
            )
        asleep, unsupported = _settle(graph, buffers, self.limits, self._supports)
        return Decision(dict.fromkeys(asleep.tolist(), "inside the pile"), unsupported)
