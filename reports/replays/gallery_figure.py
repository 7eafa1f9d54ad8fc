"""A figure that shows stills, the pictures of the final states of stacks, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import matplotlib.image as mpl_image
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from reports.records.folder import still_of
from reports.replays.drawing import COLOURS
from reports.statistics.groups import Group, GroupKey, ordered_policies
from reports.tables.outcomes import outcome

_INCHES, _TITLE_INCHES = 2.1, 0.3
"""Width of a still and height of a title [inch]."""


def gallery_figure(stills: Path, groups: Sequence[Group], engine: str, profile: str, scenes: Sequence[str]) -> Figure:
    """Draw the stills of the first draws of one engine and profile: a row per scene, a column per policy.

    Args:
        stills: folder of the stills.
        groups: groups of trials of the study.
        engine: the engine to show.
        profile: the profile to show.
        scenes: ids of the scenes to show, in this order.

    Raises:
        FileNotFoundError: if a still is missing.
        KeyError: if a scene has no trials of the engine and profile under one of their policies.
    """
    by_key = {group.key: group for group in groups}
    policies = ordered_policies(key.policy for key in by_key if key[1:3] == (engine, profile))
    lines = [[by_key[GroupKey(scene, engine, profile, policy)].draws[0] for policy in policies] for scene in scenes]
    shown = [_without_margins([mpl_image.imread(still_of(stills, trial)) for trial in line]) for line in lines]
    heights = [_INCHES * line[0].shape[0] / line[0].shape[1] + _TITLE_INCHES for line in shown]
    figure = Figure((_INCHES * len(policies), sum(heights) + _TITLE_INCHES), layout="constrained")
    panels = figure.subplots(len(scenes), len(policies), squeeze=False, height_ratios=heights)
    for panel, trial, picture in zip(panels.ravel(), chain(*lines), chain(*shown), strict=True):
        panel.imshow(picture, interpolation="antialiased")
        panel.set_axis_off()
        panel.set_title(f"{trial.policy}: {outcome([trial])}", fontsize=9)
    states = [Patch(color=(r / 255, g / 255, b / 255), label=state) for state, (r, g, b) in COLOURS.items()]
    figure.legend(handles=states, loc="outside lower center", ncols=len(states), frameon=False, fontsize=9)
    return figure


def _without_margins(pictures: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Crop the rows at the top and bottom that are empty in all pictures; return the cropped pictures.

    Args:
        pictures: pictures of the same height, each of shape (height, width, 4).
    """
    drawn = np.flatnonzero(np.any([picture[..., 3].any(axis=1) for picture in pictures], axis=0))
    return [picture[drawn[0] : drawn[-1] + 1] if len(drawn) else picture for picture in pictures]
