"""The contract of every adapter: a list of physical checks, the same list for all engines.

``check.run("bullet", "game")`` raises ``ConformanceError`` if the engine breaks the requirement of the check. An engine
must pass each check of ``CHECKS`` for which ``Check.applies`` returns True. The scenes of planar engines lie in the x-z
plane. Two checks of other engines leave this plane.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from adapters import registry
from adapters.conformance import (
    approaching,
    contacts,
    driven,
    finding,
    fixed_boxes,
    forces,
    freezing,
    housekeeping,
    motion,
    shapes,
    welds,
)
from adapters.conformance.rig import ConformanceError, Rig
from adapters.profile import Capabilities
from adapters.profile_variants import base_name

__all__ = ["CHECKS", "Check", "ConformanceError", "Rig"]


@dataclass(frozen=True, slots=True)
class Check:
    """One requirement of the contract, and the function that checks it."""

    measure: Callable[[Rig], None]
    """Function that raises ``ConformanceError`` if the engine breaks the requirement in the function's docstring."""
    capable: Callable[[Capabilities], bool] = lambda _: True
    """Function that returns whether the check applies to an engine with these capabilities."""
    as_shipped: bool = True
    """False for a check that the profile ``default``, the engine as shipped, need not pass."""

    @property
    def name(self) -> str:
        """Return the name of ``measure``, a short form of the requirement."""
        return self.measure.__name__

    def applies(self, engine: str, profile: str) -> bool:
        """Return whether this engine under this profile must pass the check.

        Raises:
            UnknownNameError: if no engine has this name.
        """
        return self.capable(registry.capabilities(engine)) and (self.as_shipped or base_name(profile) != "default")

    def run(self, engine: str, profile: str) -> None:
        """Run the check on an engine, without regard to ``applies``.

        Raises:
            ConformanceError: if the check fails; the message states the measured and the required value.
            UnknownNameError: if no engine or no profile has this name.
            EngineNotInstalledError: if the engine's package is missing.
        """
        rig = Rig(lambda world: registry.open_engine(engine, profile, world=world), registry.capabilities(engine))
        self.run_in(rig)

    def run_in(self, rig: Rig) -> None:
        """Run the check on the worlds of a rig, and close the rig.

        Raises:
            ConformanceError: if the check fails; the message states the measured and the required value.
        """
        try:
            self.measure(rig)
        finally:
            rig.close()


def _has_shapes(capabilities: Capabilities) -> bool:
    """Return whether an adapter builds other shapes than boxes."""
    return len(capabilities.shapes) > 1


def _joins(capabilities: Capabilities) -> bool:
    """Return whether an adapter joins bodies."""
    return capabilities.weld is not None


CHECKS: tuple[Check, ...] = (
    Check(housekeeping.refuses_bad_input),
    Check(housekeeping.refuses_what_leaves_its_plane, capable=lambda capabilities: capabilities.planar),
    Check(housekeeping.has_the_settings_of_its_profile),
    Check(housekeeping.keeps_poses_and_ids),
    Check(housekeeping.moves_a_live_brick),
    Check(housekeeping.repeats_bit_for_bit, capable=lambda capabilities: capabilities.deterministic != "no"),
    Check(housekeeping.moves_alike_unread_and_read, capable=lambda capabilities: capabilities.deterministic != "no"),
    Check(motion.falls_freely, as_shipped=False),
    Check(motion.moves_by_impulse_over_mass, as_shipped=False),
    Check(motion.accelerates_by_force_over_mass, as_shipped=False),
    Check(motion.falls_along_gravity_that_changes, as_shipped=False),
    Check(motion.slides_on_the_ground_above_the_friction_angle),
    Check(motion.slides_on_a_frozen_brick_above_the_friction_angle),
    Check(motion.slides_sideways_above_the_friction_angle, capable=lambda capabilities: not capabilities.planar),
    Check(motion.is_braked_by_friction_between_live_bricks),
    Check(motion.does_not_bounce),
    Check(motion.seats_on_the_ground, as_shipped=False),
    Check(motion.seats_on_frozen_bricks, as_shipped=False),
    Check(motion.holds_an_inverted_v, as_shipped=False),
    Check(motion.falls_when_its_support_is_removed),
    Check(contacts.reports_a_resting_brick, as_shipped=False),
    Check(contacts.reports_a_resting_brick_in_every_frame, as_shipped=False),
    Check(contacts.reports_whole_faces_on_uneven_supports, as_shipped=False),
    Check(contacts.reports_a_support_a_hair_below, as_shipped=False),
    Check(contacts.reports_every_pair),
    Check(contacts.reports_the_speed_of_impact),
    Check(contacts.reports_the_overlap, capable=lambda capabilities: capabilities.separation),
    Check(contacts.reports_the_normal_at_a_ridge, as_shipped=False),
    Check(contacts.forgets_a_removed_brick),
    Check(contacts.reports_masses),
    Check(forces.carries_a_resting_brick, capable=lambda capabilities: capabilities.forces != "no"),
    Check(forces.carries_each_level, capable=lambda capabilities: capabilities.forces != "no"),
    Check(forces.resists_a_steady_push, capable=lambda capabilities: capabilities.forces != "no"),
    Check(forces.keeps_forces_within_the_laws_of_contact, capable=lambda capabilities: capabilities.forces != "no"),
    Check(forces.reports_no_forces, capable=lambda capabilities: capabilities.forces == "no"),
    Check(forces.forgets_forces_without_a_step),
    Check(freezing.stays_frozen),
    Check(freezing.freezes_in_flight),
    Check(freezing.freezes_before_its_first_step),
    Check(freezing.carries_a_live_brick),
    Check(freezing.tumbles_as_if_never_frozen),
    Check(freezing.wakes_to_live_again),
    Check(freezing.moves_a_frozen_brick),
    Check(freezing.removes_a_frozen_brick),
    Check(fixed_boxes.rests_on_a_fixed_box, as_shipped=False),
    Check(fixed_boxes.slides_on_a_fixed_slope_above_the_friction_angle),
    Check(fixed_boxes.leans_on_a_fixed_wall, as_shipped=False),
    Check(fixed_boxes.stops_at_a_fixed_ceiling, as_shipped=False),
    Check(fixed_boxes.freezes_on_a_fixed_box),
    Check(approaching.lists_what_is_about_to_strike, as_shipped=False),
    Check(approaching.does_not_list_what_passes_by, as_shipped=False),
    Check(approaching.shows_pushes_against_a_frozen_brick, as_shipped=False),
    Check(driven.goes_where_it_is_driven),
    Check(driven.carries_what_lies_on_it, as_shipped=False),
    Check(driven.slides_on_a_tilted_platform_above_the_friction_angle, as_shipped=False),
    Check(driven.reports_moved_bodies, as_shipped=False),
    Check(driven.shows_what_it_moves_below_frozen_bricks, as_shipped=False),
    Check(finding.finds_the_contacts_of_a_tower),
    Check(finding.finds_the_contacts_of_an_inverted_v),
    Check(finding.finds_an_overlap),
    Check(finding.finds_contacts_among_moving_and_frozen_bricks),
    Check(finding.finds_contacts_with_fixed_boxes),
    Check(finding.forgets_found_contacts_with_the_next_step),
    Check(finding.stands_as_if_never_asked),
    Check(shapes.seats_every_shape, capable=_has_shapes, as_shipped=False),
    Check(shapes.carries_every_shape_on_every_shape, capable=_has_shapes, as_shipped=False),
    Check(shapes.reports_where_every_shape_stands, capable=_has_shapes, as_shipped=False),
    Check(shapes.slides_on_every_flat_face, capable=_has_shapes, as_shipped=False),
    Check(shapes.rolls_down_a_slope, capable=_has_shapes, as_shipped=False),
    Check(shapes.freezes_every_shape, capable=_has_shapes),
    Check(shapes.has_the_friction_of_a_pair, capable=lambda capabilities: capabilities.own_friction, as_shipped=False),
    Check(
        shapes.bounces_with_the_restitution_of_a_pair,
        capable=lambda capabilities: capabilities.restitution,
        as_shipped=False,
    ),
    Check(welds.holds_an_overhanging_plank, capable=_joins),
    Check(
        welds.keeps_the_turn_of_a_joined_plank,
        capable=lambda capabilities: _joins(capabilities) and not capabilities.planar,
        as_shipped=False,
    ),
    Check(welds.moves_as_one_body, capable=_joins, as_shipped=False),
    Check(welds.holds_a_chain_of_ten, capable=_joins, as_shipped=False),
    Check(welds.joins_once, capable=_joins),
    Check(welds.keeps_the_contacts_of_joined_planks, capable=_joins),
    Check(welds.ends_joints_with_their_bodies, capable=_joins, as_shipped=False),
    Check(welds.refuses_to_join_what_is_not_live, capable=_joins),
    Check(welds.refuses_to_join, capable=lambda capabilities: not _joins(capabilities)),
)
