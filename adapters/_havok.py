"""Havok, compiled to WebAssembly, in Node: npm package ``@babylonjs/havok``, single precision.

Freezing: the body is stopped and made static. Made dynamic again it is given its mass and inertia anew, and is kept
active. Static bodies are not collided with one another.

Contacts are events of each step, one a point, with positions and normals of the step's start; they are carried along
with the bodies to the poses after the step. Havok promises no point at a positive gap, so that the port adds the
corners from the bricks' geometry. There are no forces.

Friction: as shipped a pair has the geometric mean of both shapes' coefficients, and all shapes have the world's. The
first step in which bodies touch has no friction: with one step a frame, as shipped, a plank 1 deg above the friction
angle slides 82 mm where it should slide 52, and four conformance checks fail. With four steps all pass. A steady force
is an impulse before each substep: the API has no forces.

Ridges: where two bricks touch edge on edge the normal is that across both edges, as in Jolt.

Traps: a box is rounded by a convex radius of half its thickness, at most 15 mm, so that the contact points of a plank
lie inside its edges; a convex hull of the eight corners is not. ``HP_World_SetIdealStepTime`` is 1/60 s as shipped, and
shorter steps are then solved as softly as one of 1/60 s; 0 switches that off. In a world of scale 1 slow slides stick
(a plank slides 4 mm instead of 52): all profiles have ten times larger ones. Inertia is given for a mass of 1. Events
share one place in memory and can be asked for once. Their fields are read from there, and the layout is compared with
what the functions say whenever the process starts.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from adapters import wasm
from adapters.bridge.description import Detection
from adapters.profile import Capabilities, Profile
from adapters.profile_files import load_settings
from adapters.wasm.simulation import WasmSimulation

_SETTINGS = load_settings("havok")
_SAID = wasm.description("havok")


class HavokSimulation(WasmSimulation):
    """One world of Havok."""

    engine: ClassVar[str] = "havok"
    package: ClassVar[str] = "@babylonjs/havok"
    profiles: ClassVar[Mapping[str, Profile]] = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    iterations: ClassVar[str] = _SAID.iterations
    capabilities: ClassVar[Capabilities] = _SAID.capabilities
    contacts_at: ClassVar[Detection] = _SAID.contacts_at

    def _open(self) -> None:
        if self.info.sleeping == "raised":
            raise NotImplementedError(
                "Havok's threshold of sleeping cannot be set: leave it off, or use policy 'native'"
            )
        super()._open()
