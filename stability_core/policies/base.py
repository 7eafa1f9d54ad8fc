"""What the loop asks of a policy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from stability_core.port import IntArray
from stability_core.settings import Settings
from stability_core.stack import Graph


class Policy(ABC):
    """Decides which bodies at rest join the stack, and which frozen ones no longer belong to it."""

    name: ClassVar[str]

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Args: gravity: gravitational acceleration [m/s2], positive; settings: the tolerances."""
        self.gravity = gravity
        self.settings = settings

    @abstractmethod
    def carry(self, graph: Graph, changed: IntArray) -> IntArray:
        """Update what the policy knows of the stack after a change; returns the bodies it concerns, (k,).

        Args:
            graph: the stack.
            changed: bodies whose patches, or what lies on them, changed, shape (n,).
        """

    @abstractmethod
    def accept(self, graph: Graph, at_rest: IntArray, leaning: IntArray) -> dict[int, str]:
        """Mark the candidates that join the stack as FROZEN; returns each with the reason.

        Args:
            graph: the stack; the candidates' patches are laid.
            at_rest: live bodies at rest by the strict rule, shape (n,), lowest first.
            leaning: live bodies at rest by the rule for leaning, shape (m,), lowest first.
        """

    @abstractmethod
    def unbalanced(self, graph: Graph, bodies: IntArray) -> IntArray:
        """The frozen ones among ``bodies`` that no longer balance, shape (k,)."""
