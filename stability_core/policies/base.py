"""The interface of a policy."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np

from stability_core.frame_buffers import FrameBuffers
from stability_core.port import IntArray
from stability_core.settings import Settings
from stability_core.stack import Graph, with_all_above

NOBODY: IntArray = np.empty(0, np.int64)


class Decision(NamedTuple):
    """A policy's decision on one frame."""

    frozen: dict[int, str]
    """Rows of the bodies that join the stack, each with the reason. The policy has marked these bodies as FROZEN."""
    unbalanced: IntArray
    """Rows of the frozen bodies that no longer balance, shape (k,)."""
    deferred: IntArray = NOBODY
    """Rows of the live candidates beyond the budget, shape (m,). The next frame lists these bodies again."""


class Policy(ABC):
    """A rule that decides which bodies at rest join the stack, and which frozen bodies leave the stack."""

    name: ClassVar[str]
    judges_statics: ClassVar[bool] = True
    """True if the policy tests the stability of bodies before a freeze. ``adopt`` needs this test,
    because the bodies have not yet been at rest."""

    waits_while_shaken: ClassVar[bool] = False
    """True if a shaken body waits until no blow has shaken the live bodies around it for ``quiet_s``."""

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Set gravity and tolerances.

        Args:
            gravity: gravitational acceleration [m/s2], positive.
            settings: the tolerances.
        """
        self.gravity = gravity
        self.settings = settings
        self.limits = settings.limits(gravity)
        self.budget = math.inf
        """Number of solved bodies in a call of ``settle``, from which the policy defers further candidates. Only
        freezing has a budget: the policy tests frozen bodies for balance without a limit."""

    def set_gravity(self, gravity: float) -> None:
        """Set the strength of gravity [m/s2], after a change of its strength or its direction.

        If gravity changes between updates, the core first turns the graph so that z is up, and lists every frozen body
        as changed. A policy that keeps proofs or forces must delete both here, because they are invalid under the new
        gravity.
        """
        self.gravity = gravity
        self.limits = self.settings.limits(gravity)

    @property
    def is_waiting(self) -> bool:
        """True if ``update`` must call ``settle`` in the next frame, even without a change."""
        return False

    def resting_on(self, graph: Graph, roots: IntArray) -> IntArray:
        """Return the bodies ``roots`` and the frozen bodies that must unfreeze with them, shape (k,)."""
        above: IntArray = with_all_above(graph, roots)
        return above

    @abstractmethod
    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Bring the stack up to date with one frame.

        The policies of the core take these steps:

        1. build the patches of the worklist (``lay_due``);
        2. freeze the accepted candidates, lowest first;
        3. rebuild the patches of these bodies (``lay_frozen``);
        4. find the unbalanced bodies among all affected bodies (``take_changed``).

        The functions in parentheses are kernels, so that a policy can take all steps in one compiled call.

        Args:
            graph: the stack, with enough spare patches, and with a list of the bodies that changed since the last call.
            buffers: the worklist of this frame, and the contacts of the dwell frames.
        """
