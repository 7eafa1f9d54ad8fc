"""Exact statics by load-bearing contacts alone: those whose cone of friction contains the vertical.

Where sides touch that nothing presses on, forces that would hold a brick may exist in theory, and do not come about.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from unittest import mock

from scenarios.model import Push, Scene
from scenarios.statics import truth
from scenarios.statics.contact_patch import Patch, contact_patches

UNLOADED = {"neighbour_side", "prop_between_walls"}
"""Families in which only such forces could hold what must fall."""


def still(scene: Scene) -> Scene:
    """The scene without its pushes, of which statics knows nothing."""
    return replace(scene, actions=tuple(action for action in scene.actions if not isinstance(action, Push)))


def first_fall_by_load(scene: Scene) -> int | None:
    """The level at which a scene first falls by its load-bearing contacts; None if it always stands."""
    steepest = 1 / math.hypot(1.0, scene.world.friction) - 1e-12

    def load_bearing(*arguments: Any, **options: Any) -> Sequence[Patch]:
        return [patch for patch in contact_patches(*arguments, **options) if abs(patch.normal[2]) >= steepest]

    with mock.patch.object(truth, "contact_patches", load_bearing):
        return truth.first_fall(scene)
