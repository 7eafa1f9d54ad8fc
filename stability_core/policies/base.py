"""What the loop asks of a policy."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np

from stability_core.frame_buffers import FrameBuffers
from stability_core.port import IntArray
from stability_core.settings import Settings
from stability_core.stack import Graph

NOBODY: IntArray = np.empty(0, np.int64)


class Decision(NamedTuple):
    """What a policy says of one frame."""

    frozen: dict[int, str]
    """The bodies that join the stack, each with the reason; they are marked as FROZEN."""
    unbalanced: IntArray
    """The frozen bodies that no longer balance, shape (k,)."""
    deferred: IntArray = NOBODY
    """The live bodies that there was no budget left to judge, shape (m,): they are asked again in the next frame."""


class Policy(ABC):
    """Decides which bodies at rest join the stack, and which frozen ones no longer belong to it."""

    name: ClassVar[str]
    judges_statics: ClassVar[bool] = True
    """Whether what it freezes is stable by some test, so that bodies may be judged before they were seen at rest."""

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Args: gravity: gravitational acceleration [m/s2], positive; settings: the tolerances."""
        self.gravity = gravity
        self.settings = settings
        self.limits = settings.limits(gravity)
        self.budget = math.inf
        """For each call of ``settle``: after statics was solved for so many bodies, further candidates are deferred.
        Only freezing is: whether what is frozen still balances is judged in any case."""

    def set_gravity(self, gravity: float) -> None:
        """Judge by another strength of gravity [m/s2], or another direction: nothing proven before holds any more.

        The graph is turned so that z is up, and lists every frozen body as changed. A policy that remembers proofs or
        forces forgets them here.
        """
        self.gravity = gravity
        self.limits = self.settings.limits(gravity)

    @abstractmethod
    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Bring the stack up to date with one frame.

        The same steps for every policy: lay the patches of what is due (``lay_due``); freeze those candidates that
        the policy accepts, lowest first; lay their patches anew (``lay_frozen``); and of all that was changed by this
        (``take_changed``) find what no longer balances. A policy that takes them in one compiled call costs
        microseconds.

        Args:
            graph: the stack, with spare patches enough; what changed since the last call is listed in it.
            buffers: what is due in this frame, and the contacts of the dwell frames.
        """
