"""Refusal of bodies and joints that an adapter cannot build; a trial that needs them ends as ``unsupported``."""

from __future__ import annotations

from collections.abc import Iterable

from adapters.profile import Capabilities
from scenarios.lookup import one_of
from scenarios.model import Brick, World
from scenarios.shapes import name_of
from scenarios.solids import friction_of, restitution_of


def check_capable(engine: str, can: Capabilities, world: World, bricks: Iterable[Brick]) -> None:
    """Raise ``NotImplementedError``, which gives the reason and the fix, if an engine cannot build one of ``bricks``.

    Args:
        engine: name of the engine.
        can: its capabilities.
        world: the world of the bricks.
        bricks: the bricks.
    """
    if world.restitution > 0 and not can.restitution:
        raise NotImplementedError(
            f"{engine}: the adapter has restitution 0 only, got {world.restitution} in the world: set the world's "
            "restitution to 0, or use another engine"
        )
    for brick in bricks:
        shape = name_of(brick.shape)
        if shape not in can.shapes:
            raise NotImplementedError(
                f"{engine}: the adapter builds no {shape}, because {can.other_shapes}: use {one_of(can.shapes)}, or "
                "another engine"
            )
        if not can.own_friction and friction_of(brick, world) != world.friction:
            raise NotImplementedError(
                f"{engine}: the adapter gives no body a friction of its own, got {brick.friction} in a world with "
                f"the coefficient {world.friction}: use one friction for all, or another engine"
            )
        if not can.restitution and restitution_of(brick, world) > 0:
            raise NotImplementedError(
                f"{engine}: the adapter has restitution 0 only, got {brick.restitution}: use 0, or another engine"
            )
        if brick.moments is not None and not can.own_moments:
            raise NotImplementedError(
                f"{engine}: the adapter builds homogeneous bodies only, got moments of inertia {brick.moments} kg m2: "
                "leave out the moments, or use another engine"
            )


def check_weldable(engine: str, can: Capabilities) -> None:
    """Raise ``NotImplementedError``, which gives the reason and the fix, if an engine joins no bodies."""
    if can.weld is None:
        raise NotImplementedError(
            f"{engine}: the adapter joins no bodies, as the policies 'weld' and 'weld_own' do: use another policy, or "
            "an engine whose capabilities state a weld"
        )
