"""The two divisions of scenes: tuned scenes, on which maintainers tuned profiles, and held-out scenes.

Reports show the success rate of each division, because a tuned profile may be correct on tuned scenes only.
"""

from __future__ import annotations

TUNED_ON = ("four_stack", "card_house", "leaning_tower", "plank_tower")
"""Names of the scenarios on which maintainers tuned a profile of an engine. The key ``tuned_by`` of the profiles in
``adapters/profiles`` describes these scenarios in words: "inverted V" means ``card_house`` with one storey, and
"columns and ladders of planks" means ``plank_tower`` and ``four_stack``."""


def is_held_out(scenario: str) -> bool:
    """Return True if ``scenario`` is a held-out scene."""
    return scenario not in TUNED_ON
