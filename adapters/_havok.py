"""Havok, compiled to WebAssembly, in Node: npm package ``@babylonjs/havok``, single precision.

Freezing: the adapter stops the body and makes it static. When the adapter makes the body dynamic again, the adapter
sets the mass and the inertia, and activates the body. Havok does not collide static bodies with one another.

Contacts: each step emits one event per point, with positions and normals at the start of the step. The bridge moves
positions and normals with the bodies to the poses after the step. Havok guarantees no points at a positive gap, so that
the port adds the corners from the bricks' geometry. Havok reports no forces.

Friction: the coefficient of a pair is the geometric mean of both shapes' coefficients (as shipped), and every shape has
the world's coefficient. The first step in which bodies touch has no friction. With one step per frame, as shipped, a
plank 1 deg above the friction angle slides 82 mm instead of 52 mm. Four conformance checks then fail. With four steps
per frame all checks pass. The API has no forces, so that the adapter applies a steady force as an impulse before each
substep.

Ridges: where two bricks touch edge on edge, Havok reports the normal across both edges, as Jolt does.

Traps:

- Havok rounds a box by a convex radius of half its thickness, at most 15 mm. Therefore the contact points of a plank
  lie inside its edges. Havok does not round a convex hull of the eight corners.
- ``HP_World_SetIdealStepTime`` is 1/60 s as shipped: contacts in shorter steps are then as soft as in a step of 1/60 s.
  The value 0 switches this softness off.
- In a world of scale 1 a slowly sliding brick stops (a plank slides 4 mm instead of 52 mm). Therefore the
  profiles have scale 10 or 30.
- With eight substeps at scale 10, Havok also stops slow falls: a cantilever, a table and an incline 5 % beyond their
  limits stand. Scale 30 and 16 substeps show these falls. More substeps stop slow falls again.
- Havok expects the inertia of a body as if its mass were 1 kg.
- All events share one block of memory, and the peer can read an event only once. The peer reads the fields from memory
  and compares the memory layout with the API's functions at each start of the process.
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
                "policy 'raised' needs a sleep threshold that the adapter can raise, but Havok's API cannot set the "
                "threshold: use policy 'none' or 'native', or sleeping='off' or 'native'"
            )
        super()._open()
