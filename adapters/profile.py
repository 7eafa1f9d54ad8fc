"""Descriptions of an engine: its set-up (``Profile``), its API (``Capabilities``), and ``EngineInfo``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from scenarios.model import Brick

PLANK_SIZE = math.hypot(117.0e-3, 23.4e-3, 7.8e-3)
"""Diagonal [m] of the plank for which the profiles' lengths were chosen."""
MAX_SMALL_SIZE = 0.25
"""Size of the largest brick over a plank's up to which a profile's lengths shrink with the bricks; larger bricks keep
those of a plank."""
REACH_OF_SMALL = 0.5
"""Lengths for small bricks over those in proportion. PhysX, which looks for contacts from twice 1 mm on, held planks of
0.78 mm that nothing carried between neighbours 0.2 mm apart; with half of the reach they fall. Found by trial, not
derived: a ``contact_offset`` of 0.105 mm held such a plank, 0.09 mm let it fall."""

AS_SHIPPED = "as shipped"
"""Value of ``tuned_by`` for a profile that nobody tuned."""

Sleeping = Literal["off", "native", "raised"]
"""The engine's own sleeping: off, as shipped, or with its threshold raised."""


KnobValue: TypeAlias = float | int | str | bool


@dataclass(frozen=True, slots=True)
class Knob:
    """One engine setting that differs from the shipped engine, with the reason."""

    value: KnobValue
    reason: str
    follows_world: bool = False
    """True for a length that was chosen for the size of the bricks: in a scaled world it grows with them, and where all
    bricks are small (``MAX_SMALL_SIZE``) it shrinks."""


@dataclass(frozen=True, slots=True)
class Profile:
    """The set-up of an engine: ``default`` as shipped, ``game`` cheap, ``tuned`` the best that an expert reaches."""

    name: str
    description: str
    substeps: int
    """Engine steps per frame."""
    frame_s: float = 1 / 60
    """Length of a frame [s]."""
    knobs: Mapping[str, Knob] = field(default_factory=dict)
    tuned_by: str = AS_SHIPPED
    scale: float = 1.0
    """Lengths in the engine's world over those of the scene: see ``adapters.scaled``."""
    offset: float = 0.0
    """How far [m] along x the scene lies from the origin of the engine's world: see ``adapters.scaled``."""
    forces: bool = True
    """False to report no contact forces (``Contacts.force`` is None), whether or not the engine reports them."""

    @property
    def values(self) -> dict[str, KnobValue]:
        """The values of the knobs, by their names."""
        return {name: knob.value for name, knob in self.knobs.items()}

    def with_knobs(self, knobs: Mapping[str, Knob]) -> Profile:
        """Return the profile with these knobs added or replaced."""
        return replace(self, knobs={**self.knobs, **knobs})

    def with_lengths_times(self, factor: float) -> Profile:
        """Return the profile with every length that follows the world multiplied by ``factor``."""
        lengths = {name: knob for name, knob in self.knobs.items() if knob.follows_world}
        return self.with_knobs(
            {name: replace(knob, value=float(knob.value) * factor) for name, knob in lengths.items()}
        )

    def fitted_to(self, expected: Sequence[Brick]) -> Profile:
        """Return the profile with the lengths that suit small bricks, if all expected bricks are small."""
        plank = PLANK_SIZE * self.scale
        size = max((math.hypot(*brick.size) for brick in expected), default=plank) / plank
        return self if size > MAX_SMALL_SIZE else self.with_lengths_times(REACH_OF_SMALL * size)


@dataclass(frozen=True, slots=True)
class Capabilities:
    """The data that an engine's API provides, as its adapter describes it; the source of the capability table.

    The conformance checks measure ``near_contacts``, ``separation``, ``forces``, ``ridge_normal``, ``planar`` and, in
    one process, ``deterministic``. The other fields describe mechanisms, whose effect is checked instead.
    """

    contact_points: str
    """Number of points reported for one pair, such as "up to 4 points"."""
    near_contacts: bool
    """True if points are listed that nearly touch; for other engines the port adds them from the boxes' geometry."""
    separation: bool
    relative_velocity: str
    """"reported", or how the adapter gets it, such as "from the velocities before the step"."""
    forces: str
    """The reported parts of a contact force: "normal and friction"; "no"; or the origin of friction."""
    freeze: str
    """Mechanism of the exact freeze."""
    frozen_contacts: bool
    """True if contacts between two frozen bodies stay listed by the engine."""
    friction_law: str
    moved: str
    """Mechanism that moves a body at a prescribed velocity, so that friction carries the bodies on it."""
    deterministic: str
    """"across processes", "within a process" or "no"."""
    ridge_normal: str = "face"
    """The normal where two bricks touch edge on edge: "face" for that of a brick's face, "edge" for that across both
    edges, as between ideal bricks. With "face" a V holds only while its planks are steeper than 90 deg - atan(mu)."""
    planar: bool = False
    """True for a 2-D engine: it plays planar scenes only."""


@dataclass(frozen=True, slots=True)
class EngineInfo:
    """Identity of an engine, recorded with every trial."""

    engine: str
    version: str
    profile: Profile
    sleeping: Sleeping
    unit_scale: float = 1.0

    @property
    def frame_s(self) -> float:
        """Length of a frame [s]."""
        return self.profile.frame_s
