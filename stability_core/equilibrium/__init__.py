"""Exact statics of a snapshot of the world: contact forces that hold the bodies, or a motion in which bodies fall."""

from stability_core.equilibrium.snapshot import Equilibrium, solve_equilibrium

__all__ = ["Equilibrium", "solve_equilibrium"]
