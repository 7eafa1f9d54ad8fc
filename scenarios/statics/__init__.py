"""The judge, exact statics: the decision whether a stack can stand, independent of ``stability_core``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenarios.model import Scene
    from scenarios.statics.scene_judge import Judgement


def judge(scene: Scene) -> Judgement:
    """Judge whether a scene stands, with margins and proof: see ``scene_judge``.

    Raises:
        ValueError: if bricks overlap, or a number is out of range; the message names the fault and the fix.
    """
    from scenarios.statics.scene_judge import judge_scene  # here, because most modules need only parts of statics

    return judge_scene(scene)
