"""Notes of the page on the uncertainty of its numbers, with the command that plays more builds."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from reports.statistics.groups import ALONE, Group

_MORE = 20
"""Number of seeds that the notes propose. With 20 builds of a scene, the 95 % interval of a share of one half is about
0.44 wide."""


def share_note(groups: Sequence[Group], in_pairs: bool, again: str) -> str:
    """Return the note on the shares of each engine: their base, their intervals, and the command for more builds.

    Args:
        groups: all groups of the study.
        in_pairs: True for shares of pairs, False for shares of stacks.
        again: the command that runs the study; backticks mark the command in the note.
    """
    seeds = max(len(group.draws) for group in groups)
    what = "pairs of stacks of which one must stand and one must fall" if in_pairs else "stacks with a known answer"
    if seeds == 1:
        more = f"Builds with placement noise give intervals: `{again} --seeds {_MORE}`."
        return f"Shares are of {what}. n = 1 build of each: no intervals. {more}"
    return (
        f"Shares are of {what}, and have 95 % intervals by bootstrap over {'pairs' if in_pairs else 'scenes'} and "
        f"their seeds (up to {seeds}). A share of 0 or 100 % has an interval of no width, because the bootstrap cannot "
        f"estimate an event that never happened. More builds narrow the intervals: "
        f"`{again} --seeds {max(_MORE, 4 * seeds)}`."
    )


def difference_note(groups: Sequence[Group], policies: Collection[str], again: str) -> str:
    """Return the note on the column “against none”, with the command that plays enough builds for a significant p.

    Args:
        groups: all groups of the study.
        policies: the policies of the study.
        again: the command that runs the study; backticks mark the command in the note.
    """
    seeds = max(_MORE, 2 * max(len(group.draws) for group in groups))
    other = next((policy for policy in policies if policy != ALONE), "equilibrium")
    both = "" if ALONE in policies and len(policies) > 1 else f" --policy {ALONE} --policy {other}"
    return (
        "Whether a difference from the engine alone is significant takes six seeds or more, because the least p of "
        f"one comparison is 0.03 with six, and of several comparisons greater: `{again}{both} --seeds {seeds}`."
    )
