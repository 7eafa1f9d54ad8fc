"""Exact statics: the forces that hold a snapshot of the world, or the motion in which the snapshot falls."""

from stability_core.equilibrium.snapshot import Equilibrium, solve_equilibrium

__all__ = ["Equilibrium", "solve_equilibrium"]
