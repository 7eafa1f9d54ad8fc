"""Jolt, compiled to WebAssembly, in Node: npm package ``jolt-physics``, single precision, one thread.

Freezing: the body is stopped and made static; made dynamic again it has the mass and inertia it had. Static bodies are
not collided with one another.

Contacts are reported at the start of each step, by a listener that is set only while contacts are read. Points are
carried along with the bodies to the poses after the step. Jolt lists points within its speculative distance as well;
those that are further apart than a tenth of a millimetre are left out. There are no forces.

Friction: as shipped a pair has the geometric mean of both bodies' coefficients, and all bodies have the world's. The
law is a cone: one constraint a point, in the direction of sliding.

Ridges: where two bricks touch edge on edge Jolt reports the normal across both edges, not that of a face. In a V the
planks then press each other straight apart, as they ideally do, and it holds at much flatter angles than elsewhere.

Traps: a box is rounded by a convex radius of 50 mm as shipped, more than a plank has: it is 0. An overlap of less than
the slop, 20 mm as shipped, is never pushed out. Nothing wakes when its support is removed or gravity turns: the peer
wakes all bodies. Fields of Jolt's objects are read from memory, which is ten times as fast as its functions; their
layout is compared with what the functions say whenever the process starts.
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
