"""Description of an engine: settings (``Profile``), API (``Capabilities``) and identity (``EngineInfo``)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from scenarios.model import Brick

PLANK_SIZE = math.hypot(117.0e-3, 23.4e-3, 7.8e-3)
"""Diagonal [m] of the plank that determines the profiles' lengths."""
MAX_SMALL_SIZE = 0.25
"""Greatest ratio of the largest brick's diagonal to a plank's diagonal at which a profile's lengths shrink with the
bricks. At greater ratios the lengths keep their values for a plank."""
REACH_OF_SMALL = 0.5
"""Ratio of a profile's lengths for small bricks to lengths in proportion to the bricks. PhysX detects contacts from a
gap of twice 1 mm. In proportion to planks 0.78 mm thick this gap is 0.2 mm. At this gap PhysX held unsupported planks
between their neighbours. With half of this gap the planks fall. In trials a plank stayed with a ``contact_offset`` of
0.105 mm, and fell with 0.09 mm.
"""

AS_SHIPPED = "as shipped"
"""Value of ``tuned_by`` for a profile without tuning."""

Sleeping = Literal["off", "native", "raised"]
"""Modes of the engine's own sleeping: off, on (native), or on with a raised threshold."""


KnobValue: TypeAlias = float | int | str | bool


@dataclass(frozen=True, slots=True)
class Knob:
    """One setting of an engine in a profile, with the reason for its value."""

    value: KnobValue
    reason: str
    follows_world: bool = False
    """True for a length chosen for the size of the bricks. The length grows with the bricks in a scaled world, and
    shrinks if all bricks are small (``MAX_SMALL_SIZE``)."""


@dataclass(frozen=True, slots=True)
class Profile:
    """Settings of an engine, such as ``default`` as shipped, ``game`` at low cost, ``tuned`` for the best results."""

    name: str
    description: str
    substeps: int
    """Engine steps per frame."""
    frame_s: float = 1 / 60
    """Length of a frame [s]."""
    knobs: Mapping[str, Knob] = field(default_factory=dict)
    tuned_by: str = AS_SHIPPED
    scale: float = 1.0
    """Ratio of lengths in the engine's world to lengths in the scene: see ``adapters.scaled``."""
    offset: float = 0.0
    """Distance [m], in the scene's lengths, along x from the origin of the engine's world to the scene's origin."""
    forces: bool = True
    """True to report the engine's contact forces in ``Contacts.force``, if the engine has forces. If False,
    ``Contacts.force`` is None."""

    @property
    def values(self) -> dict[str, KnobValue]:
        """Return the values of the knobs, by their names."""
        return {name: knob.value for name, knob in self.knobs.items()}

    def with_knobs(self, knobs: Mapping[str, Knob]) -> Profile:
        """Return the profile with these knobs added or replaced."""
        return replace(self, knobs={**self.knobs, **knobs})

    def with_lengths_times(self, factor: float) -> Profile:
        """Return the profile with ``factor`` times every length that follows the world."""
        lengths = {name: knob for name, knob in self.knobs.items() if knob.follows_world}
        return self.with_knobs(
            {name: replace(knob, value=float(knob.value) * factor) for name, knob in lengths.items()}
        )

    def fitted_to(self, expected: Sequence[Brick]) -> Profile:
        """Return the profile with lengths that suit small bricks if all expected bricks are small, else unchanged."""
        plank = PLANK_SIZE * self.scale
        size = max((math.hypot(*brick.size) for brick in expected), default=plank) / plank
        return self if size > MAX_SMALL_SIZE else self.with_lengths_times(REACH_OF_SMALL * size)


@dataclass(frozen=True, slots=True)
class Capabilities:
    """The adapter's description of an engine: its contact data, mechanisms, shapes and coefficients.

    The fields are the source of the table Engine capabilities.
    """

    contact_points: str
    """Number of points that the engine reports for one pair, such as "up to 4 points"."""
    near_contacts: bool
    """True if the engine lists points that nearly touch. If False, the port adds these points and missing corners."""
    separation: bool
    relative_velocity: str
    """Origin of relative velocities: "reported" by the engine, or a text such as "from the velocities before the step".
    """
    forces: str
    """Parts of a contact force that the adapter reports: "no", "normal and friction", or a text with the origin of
    friction."""
    freeze: str
    """Mechanism of the exact freeze."""
    frozen_contacts: bool
    """True if the engine also lists contacts between two frozen bodies."""
    friction_law: str
    moved: str
    """Mechanism that moves a body at a prescribed velocity, so that friction moves the bodies on it as well."""
    deterministic: str
    """Scope in which equal runs give equal bits: "across processes", "within a process" or "no"."""
    ridge_normal: str = "face"
    """Normal where two bricks touch edge on edge: "face" for the normal of a brick's face; "edge" for the normal across
    both edges, as between ideal bricks. With "face" an inverted V of two planks holds only if its planks are steeper
    than 90 deg - atan(coefficient of friction)."""
    planar: bool = False
    """True for a 2-D engine, which runs planar scenes only."""
    shapes: tuple[str, ...] = ("box",)
    """Names of the shapes that the adapter builds: see ``scenarios.shapes.name_of``."""
    other_shapes: str = "its adapter builds no other shapes yet"
    """Reason why the adapter builds no other shapes."""
    own_friction: bool = False
    """True if bodies may have their own coefficients of friction. A pair has the geometric mean of both
    coefficients."""
    restitution: bool = False
    """True if bodies may have coefficients of restitution above 0. A pair has the geometric mean of both."""
    own_moments: bool = False
    """True if a body may have moments of inertia of its own."""
    weld: str | None = None
    """Mechanism that joins two bodies rigidly (``EnginePort.join``); None if the adapter joins no bodies."""
    reference: bool = False
    """True for a reference engine: written in this repository after a published method, and no product. Rankings of
    products leave it out."""


@dataclass(frozen=True, slots=True)
class EngineInfo:
    """Identity of an engine, for the records of trials."""

    engine: str
    version: str
    profile: Profile
    sleeping: Sleeping
    unit_scale: float = 1.0

    @property
    def frame_s(self) -> float:
        """Return the length of a frame [s]."""
        return self.profile.frame_s
