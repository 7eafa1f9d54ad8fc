"""The two divisions of scenes: scenes on which profiles were tuned, and held-out scenes.

Reports show the success rate on held-out scenes beside the rate on tuned scenes, because a tuned profile may be correct
only on the scenes on which it was tuned.
"""

from __future__ import annotations

TUNED_ON = ("four_stack", "card_house", "leaning_tower", "plank_tower")
"""Scenarios on which a profile of some engine was tuned, as ``tuned_by`` in ``adapters/profiles`` says. An inverted V
is a card house of one storey. ``plank_tower`` and ``four_stack`` are the columns and ladders of planks."""


def is_held_out(scenario: str) -> bool:
    """Return True if no profile was tuned on a scenario."""
    return scenario not in TUNED_ON
