"""A body that an adapter cannot build is refused with the reason, so that its trial ends as unsupported."""

from __future__ import annotations

from dataclasses import replace

import pytest

from adapters.profile import Capabilities
from adapters.shared.refusals import check_capable, check_weldable
from scenarios.model import Brick, World
from scenarios.solids import sphere

BOX = Brick((0.1, 0.1, 0.1), 1.0, (0.0, 0.0, 0.05))
BALL = sphere(0.1, position=(0.0, 0.0, 0.1), mass=1.0)
BOXES_ONLY = Capabilities(
    contact_points="", near_contacts=False, separation=True, relative_velocity="", forces="no", freeze="",
    frozen_contacts=False, friction_law="", moved="", deterministic="no",
)  # fmt: skip
ALL = replace(BOXES_ONLY, shapes=("box", "sphere"), own_friction=True, restitution=True, own_moments=True)


@pytest.mark.parametrize(
    ("world", "brick", "why"),
    [
        (World(), BALL, "builds no sphere, because .* yet: use box, or another engine"),
        (
            World(friction=0.4),
            replace(BOX, friction=0.2),
            "friction of its own, got 0.2 in a world with the coefficient 0.4",
        ),
        (World(), replace(BOX, restitution=0.3), "restitution 0 only, got 0.3"),
        (World(restitution=0.5), BOX, "set the world's restitution to 0"),
        (World(), replace(BOX, moments=(1.0, 1.0, 1.0)), "homogeneous bodies only"),
    ],
)
def test_what_the_adapter_lacks_is_refused_with_the_reason(world, brick, why):
    with pytest.raises(NotImplementedError, match=f"engine: the adapter .*{why}|engine: .*{why}"):
        check_capable("engine", BOXES_ONLY, world, [brick])
    check_capable("engine", ALL, world, [brick])


def test_a_friction_equal_to_the_worlds_is_no_friction_of_its_own():
    check_capable("engine", BOXES_ONLY, World(friction=0.4), [replace(BOX, friction=0.4, restitution=0.0)])


def test_an_engine_without_joints_names_the_policies_that_need_them():
    with pytest.raises(NotImplementedError, match="engine: the adapter joins no bodies, as the policies 'weld'"):
        check_weldable("engine", BOXES_ONLY)
    check_weldable("engine", replace(BOXES_ONLY, weld="a joint"))
