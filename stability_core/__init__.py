"""The stability extension: makes rigid bodies stack in any engine through contacts, sleep and mass."""

from stability_core.equilibrium import Equilibrium, solve_equilibrium
from stability_core.extension import Change, StabilityExtension, warm_up
from stability_core.policies import POLICIES, Policy
from stability_core.port import GROUND, Contacts, Masses, StabilityPort
from stability_core.settings import Settings

__all__ = [
    "GROUND",
    "POLICIES",
    "Change",
    "Contacts",
    "Equilibrium",
    "Masses",
    "Policy",
    "Settings",
    "StabilityExtension",
    "StabilityPort",
    "solve_equilibrium",
    "warm_up",
]
