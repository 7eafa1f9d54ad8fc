"""The hooks that an adapter fills in; the port, the base class and the substep loop call nothing else of an engine.

For every hook:

- The caller has checked the input: ids are of bodies that exist, lengths, poses and forces are finite. An adapter only
  refuses input that leaves the plane of a planar engine (``ValueError``).
- Positions [m] and quaternions (w, x, y, z) are those of centres of mass, in the scene's frame; all units are SI.
- Arrays of ids rise. A hook that returns arrays returns one row per id, in the order of the ids, as float64. The caller
  may write into them, so that they must be copies, unless the hook's text allows views.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from adapters.profile import Capabilities, EngineInfo, Knob, KnobValue, Profile
from adapters.shared.bodies import Bodies
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import Contacts, FloatArray, IntArray


class EngineHooks(ABC):
    """The suite's interface to an engine, in the order in which every adapter fills it in."""

    engine: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    profiles: ClassVar[Mapping[str, Profile]]
    sleep_knobs: ClassVar[Mapping[str, Mapping[str, Knob]]] = {}
    """Knobs added to every profile while the engine's own sleeping is off, native or raised."""
    iterations: ClassVar[str]
    """Name of the knob for the greatest number of solver iterations per step; empty if there is none."""

    info: EngineInfo
    """Engine, version, profile and sleeping. Its profile is complete: it holds the knobs that its sleeping adds, and
    lengths that suit the expected bricks."""
    world: World
    """Friction, gravity and fixed boxes; gravity is the present one."""
    bodies: Bodies
    expected: tuple[Brick, ...]
    """The bricks that will be spawned, as far as the host knows; others may come as well."""

    @staticmethod
    def knows_knob(name: str, /) -> bool:  # noqa: ARG004 - adapters set it to what their file of profiles is checked by
        """Whether there may be a knob of this name that no profile sets: the name of a profile may vary it."""
        return False

    # -- the world ---------------------------------------------------------------------------------

    @abstractmethod
    def _open(self) -> None:
        """Open the engine's world as ``info`` says, with the ground and the fixed boxes but no body.

        Called once, at the end of the constructor: before it only ``info``, ``world``, ``bodies`` and ``expected`` are
        set. An adapter has no constructor of its own, and creates its attributes here.

        Raises:
            NotImplementedError: if the engine cannot sleep as ``info.sleeping`` says; the message says why.
        """

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        """Return the knobs of the profile as the engine has them, by name; without those that its interface hides."""
        return {}

    # -- bodies ------------------------------------------------------------------------------------

    @abstractmethod
    def _spawn(self, body: int, brick: Brick) -> None:
        """Put in a live body at rest.

        Called at any time between steps. ``body`` is a new id, one above the latest; it is not in ``bodies`` yet.
        """

    @abstractmethod
    def _spawn_moved(self, body: int, brick: Brick) -> None:
        """Put in a body that only ``_drive`` moves. Called as ``_spawn``."""

    @abstractmethod
    def _remove(self, body: int) -> None:
        """Take out a live, frozen or moved body, which is still in ``bodies``.

        Called at any time between steps. ``_contacts`` may be called before the next step and must no longer list it.
        """

    @abstractmethod
    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a live, frozen or moved body, and stop it. A frozen body stays frozen."""

    # -- actions -----------------------------------------------------------------------------------

    @abstractmethod
    def _push(self, body: int, impulse: Vector) -> None:
        """Strike a live body at its centre of mass with an impulse [N s]. Called at any time between steps."""

    @abstractmethod
    def _press(self, body: int, force: Vector) -> None:
        """Let a force [N] act at the centre of mass of a live body in the next substep.

        Called before each substep while the force is not zero, and once with zero when it ends.
        """

    @abstractmethod
    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        """Move a moved body at these velocities [m/s, rad/s] in the next substep of ``seconds``.

        Called before each substep for every moved body, also while its velocities are zero.
        """

    @abstractmethod
    def _set_gravity(self, gravity: Vector) -> None:
        """Let gravity [m/s2] act from the next step on, also on bodies unfrozen later.

        Called at any time between steps; ``world`` still holds the former gravity.
        """

    # -- time --------------------------------------------------------------------------------------

    @abstractmethod
    def _step(self, seconds: float) -> None:
        """Advance the world by one frame. ``SubstepSimulation`` does so in substeps, by hooks of its own."""

    # -- state -------------------------------------------------------------------------------------

    @abstractmethod
    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return positions (k, 3) and quaternions (k, 4) of any bodies, also frozen ones; k may be 0."""

    def _positions(self, bodies: IntArray) -> FloatArray:
        """Return the positions (k, 3) of live or moved bodies alone; overridden where they cost less than poses."""
        return self._poses(bodies)[0]

    @abstractmethod
    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return linear (k, 3) [m/s] and angular (k, 3) [rad/s] velocities of any bodies; k may be 0.

        Frozen bodies have zero velocity. Values for moved bodies are ignored: see ``velocities_now``.
        """

    # -- called by the port ------------------------------------------------------------------------

    @abstractmethod
    def _freeze(self, body: int) -> None:
        """Stop a live body, and let nothing move it by a single bit until ``_unfreeze`` or ``_move``.

        Called at any time between steps, one body at a time; the body is still in ``bodies.live``.
        """

    @abstractmethod
    def _unfreeze(self, body: int) -> None:
        """Let a frozen body move again, from rest, under its own mass and the present gravity.

        Called at any time between steps, one body at a time; the body is still in ``bodies.frozen``.
        """

    @abstractmethod
    def _contacts(self) -> Contacts:
        """Return every contact of the latest step that touches a live body, and none with a removed one.

        Called between steps while a body is live, also before the first step and after bodies were frozen, woken,
        moved or removed. Normals point from a to b; the ground is ``GROUND``, fixed boxes are
        ``contact_completion.fixed_id``; unknown values are NaN. The arrays may be views until the next step.
        """

    @abstractmethod
    def _find_contacts(self) -> Contacts:
        """Return the contacts that the engine finds at the present poses; the simulation must not notice.

        Called between steps while a body is live. Contacts between two frozen bodies may be listed. Relative velocities
        and forces are not read.
        """

    # -- the end -----------------------------------------------------------------------------------

    @abstractmethod
    def _close(self) -> None:
        """Free the engine's memory. Called once; no other hook is called afterwards."""

    # -- for adapters and the port -----------------------------------------------------------------

    def velocities_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return linear and angular velocities (k, 3) of bodies (k,); of moved ones those at which they are driven."""
        return self.as_driven(bodies, *self._velocities(bodies))

    def as_driven(self, bodies: IntArray, linear: FloatArray, angular: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Write into the velocities (k, 3) of bodies (k,) those at which the host moves some of them; return both."""
        if self.bodies.moved:
            for row, body in enumerate(bodies.tolist()):
                if body in self.bodies.moved:
                    linear[row], angular[row] = self.bodies.moved[body]
        return linear, angular
