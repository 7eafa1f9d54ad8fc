"""Jolt, compiled to WebAssembly, in Node: npm package ``jolt-physics``, single precision, one thread.

Freezing: the adapter stops the body and makes it static. A body that becomes dynamic again keeps its mass and inertia.
Jolt does not collide static bodies with one another.

Contacts: while the adapter reads contacts, a listener receives the contacts at the poses before the last step of each
frame. The bridge moves the points with the bodies to the poses after the step. Jolt also lists points within its
speculative distance. The bridge omits points with a gap of more than 0.1 mm. Jolt reports no forces here.

Friction: the coefficient of a pair is the geometric mean of both bodies' coefficients (as shipped), and every body has
the world's coefficient. The law is a cone: one constraint per point, in the direction of sliding.

Ridges: where two bricks touch edge on edge, Jolt reports the normal across both edges, not the normal of a face. The
two planks of an inverted V then press horizontally against each other, as ideal planks do. Therefore the V holds at
much flatter angles than on engines that report the normal of a face.

Traps:

- As shipped Jolt rounds a box by a convex radius of 50 mm, more than a plank's thickness: the adapter sets the radius
  to 0.
- As shipped Jolt does not resolve an overlap of less than the slop, 20 mm.
- No body wakes when the host removes its support or changes gravity. Therefore the peer wakes all bodies.
- The peer reads the fields of Jolt's objects from memory, because calls of Jolt's functions take longer. The peer
  compares the memory layout with the functions at each start of the process.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from adapters import wasm
from adapters.bridge.description import Detection
from adapters.profile import Capabilities, Profile
from adapters.profile_files import load_settings
from adapters.wasm.simulation import WasmSimulation

_SETTINGS = load_settings("jolt")
_SAID = wasm.description("jolt")


class JoltSimulation(WasmSimulation):
    """One world of Jolt."""

    engine: ClassVar[str] = "jolt"
    package: ClassVar[str] = "jolt-physics"
    profiles: ClassVar[Mapping[str, Profile]] = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    iterations: ClassVar[str] = _SAID.iterations
    capabilities: ClassVar[Capabilities] = _SAID.capabilities
    contacts_at: ClassVar[Detection] = _SAID.contacts_at
