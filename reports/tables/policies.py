"""Descriptions of the sleeping methods for pages and lists, one sentence each."""

from __future__ import annotations

from collections.abc import Mapping

POLICY_SENTENCES: Mapping[str, str] = {
    "none": "The engine alone, its own sleeping off: every brick is simulated in every frame.",
    "native": "The engine alone, its own sleeping as shipped: slow bricks stop, whether they could stand or not.",
    "raised": "The engine alone, its sleeping threshold raised: bricks stop sooner, whether they could stand or not.",
    "at_rest": "The naive baseline of the core: every brick at rest freezes, even one that is about to fall.",
    "paper": "Thomsen and Kraus 2015: a brick freezes if its centre of mass, with all loads, lies above its contacts.",
    "equilibrium": "Exact statics: a brick freezes if contact forces with friction exist that hold the whole stack.",
    "pile": "After Hsu and Keyser 2010: bricks inside a pile freeze, those on its slope stay live.",
    "stacking_tree": "After Zhao and others 2022: as the paper for flat bricks, but levers share out a load.",
    "weld": "After Hsu and Keyser 2012: bricks in equilibrium under what they carry are joined, nothing freezes.",
    "weld_own": "As weld, but each brick counts its own weight only: an overloaded stack may stay joined.",
}
"""Description of each sleeping method, by its name."""
