"""The two divisions of scenes: scenes on which profiles were tuned, and held-out scenes.

Reports show the success rate on held-out scenes beside the rate on tuned scenes, because a tuned profile may be correct
only on the scenes on which it was tuned.
"""

from __future__ import annotations

TUNED_ON = ("four_stack", "card_house", "leaning_tower", "plank_tower")
"""Names of the scenarios on which a profile of some engine was tuned. The key ``tuned_by`` of the profiles in
``adapters/profiles`` describes these scenarios in words: "inverted V" means ``card_house`` with one storey, and
"columns and ladders of planks" means ``plank_tower`` and ``four_stack``."""


def is_held_out(scenario: str) -> bool:
    """Return True if no profile was tuned on ``scenario``."""
    return scenario not in TUNED_ON
