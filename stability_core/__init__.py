"""The stability extension for stacks of rigid bodies, for any engine that provides contacts, sleep and mass."""

from stability_core.batch import Change
from stability_core.equilibrium import Equilibrium, solve_equilibrium
from stability_core.extension import StabilityExtension, warm_up
from stability_core.policies import POLICIES, Policy
from stability_core.port import GROUND, Contacts, Masses, StabilityPort
from stability_core.port_check import PortError, check_port
from stability_core.settings import Settings

__all__ = [
    "GROUND",
    "POLICIES",
    "Change",
    "Contacts",
    "Equilibrium",
    "Masses",
    "Policy",
    "PortError",
    "Settings",
    "StabilityExtension",
    "StabilityPort",
    "check_port",
    "solve_equilibrium",
    "warm_up",
]
