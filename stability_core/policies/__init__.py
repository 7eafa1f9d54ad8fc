"""The policies: rules that decide which bodies freeze and unfreeze."""

from __future__ import annotations

from collections.abc import Mapping

from stability_core.policies.at_rest import AtRest
from stability_core.policies.base import Decision, Policy
from stability_core.policies.equilibrium import Equilibrium
from stability_core.policies.paper import Paper
from stability_core.policies.pile import Pile
from stability_core.policies.stacking_tree import StackingTree

POLICIES: Mapping[str, type[Policy]] = {
    policy.name: policy for policy in (Paper, AtRest, Equilibrium, Pile, StackingTree)
}
"""All policies by name."""

__all__ = ["POLICIES", "AtRest", "Decision", "Equilibrium", "Paper", "Pile", "Policy", "StackingTree"]
