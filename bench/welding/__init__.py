"""The policies that join bodies (Hsu and Keyser 2012): ``weld`` and ``weld_own``, outside the core (ADR-0030).

S.-W. Hsu, J. Keyser, "Automated constraint placement to maintain pile shape", ACM Transactions on Graphics 31(6), 2012.
Their abstract names two stages: a local analysis of equilibrium finds stable objects, and constraints then restrict the
degrees of freedom of some of them. Thomsen and Kraus add that the method revises groups periodically. An object leaves
its group when it is no longer in equilibrium, or when something fast hits it. All other details are choices of this
suite.
"""

from bench.welding.extension import Load, WeldChange, WeldExtension, WeldPort
from bench.welding.joints import Pair

__all__ = ["Load", "Pair", "WeldChange", "WeldExtension", "WeldPort"]
