"""The stacking tree of Zhao et al. 2022, a descendant of the paper for online packing: a policy for flat bodies.

H. Zhao, C. Zhu, X. Xu, H. Huang, K. Xu, "Learning practically feasible policies for online 3D bin packing", Science
China Information Sciences 65, 112105 (2022), https://doi.org/10.1007/s11432-021-3348-6. The test is the flat test of
Thomsen and Kraus. A body is stable if its centre of mass, with all loads, lies in the hull of its contact points. The
shares F_i of a load m g at c = C_stack on supports with contact areas centred at p_i are:

- A support whose own contact area contains c bears the whole load, as in Thomsen and Kraus.
- Two supports share the load by their levers: |F_0| = m g |(c - p_1) . (p_0 - p_1)| / |p_0 - p_1|^2.
- More than two supports take the least-squares solution of two kinds of equations. The lever equations of all pairs are
  F_i d_ij = F_j d_ji. The sum of all F_i is m g. Here d_ij = |(c - p_i) . (p_i - p_j)| / |p_i - p_j|^2. Thomsen and
  Kraus take equal shares.

The article gives the lever equations without a scale. This policy divides each lever by the distance of the two
supports, so that the equations have no dimension. As in the article, the least-squares equations include the sum.
Therefore the shares of more than two supports may sum to less than the load. Bodies that lean stay live, because the
article's test covers flat boxes only.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_buffers import AT_REST, FrameBuffers, listed
from stability_core.policies.base import Decision, Policy
from stability_core.policies.paper import fail_overall_test, pass_flat_test
from stability_core.polygon import lies_on
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.settle import lay_due, lay_frozen, lowest_first
from stability_core.stack import NONE, SUPPORT, Graph, count_patches, hull_of, take_changed

RIDGE = 1e-9
"""Weight of the squared shares in the least-squares solution of the lever equations. The ridge gives equal shares to
supports whose levers are all zero, and changes other shares by about 1e-9 of their values."""


@compiled
def _lever(center: FloatArray, own: FloatArray, other: FloatArray) -> float:
    """Return |(center - own) . (own - other)| / |own - other|^2 in plan, or zero if own and other coincide."""
    along_x, along_y = own[0] - other[0], own[1] - other[1]
    squared = along_x**2 + along_y**2
    if squared == 0.0:
        return 0.0
    return float(abs((center[0] - own[0]) * along_x + (center[1] - own[1]) * along_y) / squared)


@compiled
def lever_shares(center: FloatArray, contacts: FloatArray) -> FloatArray:
    """Return the shares (k,) of a load at ``center`` (3,) on supports with contact centres ``contacts`` (k, 3).

    One support bears the whole load, and two supports bear the load by their levers. For more supports, the shares s
    are the least-squares solution of the lever equations L s = 0 and of the sum 1^T s = 1. Here 1 is the vector of
    ones. The normal equations are (L^T L + 1 1^T) s = 1, besides the ridge ``RIDGE``. Gaussian elimination needs no
    pivoting, because the matrix is positive definite. The shares are not negative, because the off-diagonal entries of
    L^T L are not positive.
    """
    k = len(contacts)
    if k < 2:
        return np.ones(k)
    if k == 2:
        first, second = _lever(center, contacts[1], contacts[0]), _lever(center, contacts[0], contacts[1])
        return np.array([first, second])
    matrix, shares = np.ones((k, k)), np.ones(k)
    for i in range(k):
        matrix[i, i] += RIDGE
        for j in range(k):
            if j != i:
                own = _lever(center, contacts[i], contacts[j])
                matrix[i, i] += own**2
                matrix[i, j] -= own * _lever(center, contacts[j], contacts[i])
    for i in range(k):
        for j in range(i + 1, k):
            factor = matrix[j, i] / matrix[i, i]
            matrix[j] -= factor * matrix[i]
            shares[j] -= factor * shares[i]
    for i in range(k - 1, -1, -1):
        for j in range(i + 1, k):
            shares[i] -= matrix[i, j] * shares[j]
        shares[i] /= matrix[i, i]
    return shares


@compiled
def _add_shares(graph: Graph, upper: int, borne: FloatArray) -> None:
    """Add the load of ``upper`` to its supports' rows of ``borne`` (bodies, 4): mass [kg], mass times place [kg m].

    The load acts at C_stack if one support bears the whole load, else at the centre of each contact area.
    """
    bodies, patches = graph.bodies, graph.patches
    center, most = bodies[upper].stack_center, count_patches(graph, upper)
    lowers, contacts = np.empty(most, np.int64), np.empty((most, 3))
    supports, bearer = 0, NONE
    at = bodies[upper].first_support
    while at != NONE:
        if patches[at].kind == SUPPORT:
            lowers[supports], contacts[supports] = patches[at].lower, patches[at].center
            if bearer == NONE and lies_on(hull_of(patches[at]), center[0], center[1]):
                bearer = supports
            supports += 1
        at = patches[at].next_support
    if bearer == NONE and supports == 1:
        bearer = 0
    if bearer != NONE:
        lowers[0], contacts[0], supports = lowers[bearer], center, 1
    shares = lever_shares(center, contacts[:supports])
    for i in range(supports):
        if lowers[i] != GROUND:
            mass = bodies[upper].stack_mass * shares[i]
            borne[lowers[i], 0] += mass
            for k in range(3):
                borne[lowers[i], 1 + k] += mass * contacts[i, k]


@compiled
def _downward(graph: Graph, changed: IntArray) -> IntArray:
    """Return the ``changed`` bodies and all lower bodies, each body before its supports, shape (k,).

    The order is the reverse postorder of a depth-first search from each changed body.
    """
    bodies, patches = graph.bodies, graph.patches
    reached, ordered, path = np.zeros(len(bodies), np.bool_), np.empty(len(bodies), np.int64), [0 for _ in range(0)]
    following = bodies["first_support"].copy()
    place = len(bodies)
    for root in changed:
        if not reached[root]:
            reached[root] = True
            path.append(root)
        while len(path) > 0:
            body = path[-1]
            at = following[body]
            if at == NONE:
                place -= 1
                ordered[place] = path.pop()
                continue
            following[body] = patches[at].next_support
            lower = patches[at].lower
            if lower != GROUND and not reached[lower]:
                reached[lower] = True
                path.append(lower)
    return ordered[place:]


@compiled
def carry_down_by_levers(graph: Graph, changed: IntArray) -> IntArray:
    """Carry mass and centre down from the ``changed`` bodies, and return all affected bodies, shape (k,).

    A body takes the shares of all bodies on it, including unchanged bodies. The cost is O(k) for the k affected bodies
    and the loads on them, besides arrays with an entry for each row of the table.
    """
    bodies, patches = graph.bodies, graph.patches
    affected = _downward(graph, changed)
    borne = np.zeros((len(bodies), 4))
    is_affected = np.zeros(len(bodies), np.bool_)
    is_counted = np.zeros(len(bodies), np.bool_)
    is_affected[affected] = True
    for body in affected:
        at = bodies[body].first_load
        while at != NONE:
            upper = patches[at].upper
            if not is_affected[upper] and not is_counted[upper]:
                is_counted[upper] = True
                _add_shares(graph, upper, borne)
            at = patches[at].next_load
    for body in affected:
        row = bodies[body]
        mass = row.mass + borne[body, 0]
        row.stack_mass = mass
        for k in range(3):
            row.stack_center[k] = (row.mass * row.center[k] + borne[body, 1 + k]) / mass
        _add_shares(graph, body, borne)
    return affected


@compiled
def _settle(graph: Graph, buffers: FrameBuffers, limits: Limits) -> tuple[IntArray, IntArray]:
    """Settle one frame, and return the bodies that passed the flat test and the bodies that failed the overall test."""
    lay_due(graph, buffers, limits)
    affected = carry_down_by_levers(graph, take_changed(graph))
    flat = pass_flat_test(graph, lowest_first(graph, listed(buffers, AT_REST)))
    lay_frozen(graph, buffers, limits)
    affected = np.concatenate((affected, carry_down_by_levers(graph, take_changed(graph))))
    return flat, fail_overall_test(graph, np.unique(affected), 0.0, limits[0].wake_margin)


class StackingTree(Policy):
    """Policy that freezes bodies by the flat test, with shares of loads by lever equations (Zhao et al. 2022)."""

    name = "stacking_tree"

    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Run the flat test, update the stack data, and run the overall test: O(k log k) for k affected bodies."""
        flat, unbalanced = _settle(graph, buffers, self.limits)
        return Decision(dict.fromkeys(flat.tolist(), "flat"), unbalanced)
