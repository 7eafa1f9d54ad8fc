"""The hooks that an adapter implements: the only engine-specific code that the port and the base classes call.

For every hook:

- The caller has checked the arguments: bodies exist, values are finite, and poses and vectors lie in the plane of a
  planar engine.
- Positions [m] are of centres of mass, and quaternions are (w, x, y, z), both in the scene's frame. All units are SI.
- Arrays of ids may be in any order, and may contain an id more than once. A hook returns one row per entry, in the same
  order, as float64. The arrays must be copies, because the caller may write into them, unless the docstring of the
  hook allows views.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, TypeAlias

from adapters.profile import Capabilities, EngineInfo, Knob, KnobValue, Profile
from adapters.shared.bodies import Bodies
from adapters.shared.pair_friction import PairFriction
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions

Pair: TypeAlias = tuple[int, int]
"""Two bodies, the smaller id first."""


class EngineHooks(ABC):
    """The suite's interface to an engine."""

    engine: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    profiles: ClassVar[Mapping[str, Profile]]
    sleep_knobs: ClassVar[Mapping[str, Mapping[str, Knob]]] = {}
    """Knobs added to every profile, by the mode of the engine's own sleeping: off, native or raised."""
    missing_knobs: ClassVar[frozenset[str]] = frozenset()
    """Knobs of the profile file that no profile contains, because the installed release does not have them."""
    iterations: ClassVar[str]
    """Name of the knob for the number of solver iterations per step, or for its limit; empty without such a knob."""

    info: EngineInfo
    """Engine, version, profile and sleeping. The profile is complete: it contains the knobs of the sleeping mode, and
    lengths that suit the expected bricks."""
    world: World
    """Friction, restitution, present gravity and fixed bodies."""
    bodies: Bodies
    pair_friction: PairFriction
    expected: tuple[Brick, ...]
    """The bricks that the host plans to spawn. The host may spawn other bricks as well."""

    @staticmethod
    def knows_knob(name: str, /) -> bool:  # noqa: ARG004 - adapters set it to the check of their profile file
        """Return whether a varied profile may set the knob ``name`` although the profile file does not set it."""
        return False

    # -- the world ---------------------------------------------------------------------------------

    @abstractmethod
    def _open(self) -> None:
        """Open the engine's world with the settings of ``info``, the ground and the fixed bodies only.

        The constructor calls this hook once, at its end, when ``info``, ``world``, ``bodies`` and ``expected`` are set.
        An adapter has no constructor of its own, and creates its attributes here.

        Raises:
            NotImplementedError: if the engine cannot open such a world, for example if it has no sleeping mode
                ``info.sleeping``; the message gives the reason.
        """

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        """Return the engine's present values of the profile's knobs, by name, where its interface reports them."""
        return {}

    # -- bodies ------------------------------------------------------------------------------------

    @abstractmethod
    def _spawn(self, body: int, brick: Brick) -> None:
        """Add a live body at rest.

        The call may come at any time between steps. ``body`` is a new id, higher than all earlier ids.
        """

    @abstractmethod
    def _spawn_moved(self, body: int, brick: Brick) -> None:
        """Add a body at rest that forces and contacts do not move. The conditions of ``_spawn`` apply."""

    @abstractmethod
    def _remove(self, body: int) -> None:
        """Remove a live, frozen or moved body, which is still in ``bodies``.

        The call may come at any time between steps. ``_contacts`` must not list the body from then on, even before the
        next step.
        """

    @abstractmethod
    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a live, frozen or moved body, and stop the body. A frozen body stays frozen."""

    # -- actions -----------------------------------------------------------------------------------

    @abstractmethod
    def _push(self, body: int, impulse: Vector) -> None:
        """Apply an impulse [N s] at the centre of mass of a live body, at any time between steps."""

    @abstractmethod
    def _press(self, body: int, force: Vector) -> None:
        """Apply a force [N] at the centre of mass of a live body in the adapter's next step.

        The call comes before each step while the force is not zero, and once with zero when the force ends or the body
        freezes.
        """

    @abstractmethod
    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        """Give a moved body the velocity [m/s] and the spin [rad/s] for the adapter's next step of ``seconds`` [s].

        The call comes before each step for every moved body, also while the body's velocities are zero.
        """

    @abstractmethod
    def _set_gravity(self, gravity: Vector) -> None:
        """Set gravity [m/s2] from the next step on, also for bodies that become live later.

        The call may come at any time between steps. During the call ``world`` still has the former gravity.
        """

    # -- time --------------------------------------------------------------------------------------

    @abstractmethod
    def _step(self, seconds: float) -> None:
        """Advance the world by one frame of ``seconds`` [s]. ``SubstepSimulation`` implements this hook."""

    def _solver_iterations(self) -> int | None:
        """Return the greatest number of solver iterations of any island in the latest engine step; None if unknown.

        The call comes after a step. Override this hook for an engine that reports its iterations. Many engines run
        a fixed number of iterations.
        """
        return None

    # -- state -------------------------------------------------------------------------------------

    @abstractmethod
    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return positions (k, 3) [m] and quaternions (k, 4) of any bodies, also frozen; k may be 0."""

    def _positions(self, bodies: IntArray) -> FloatArray:
        """Return the positions (k, 3) [m] of live or moved bodies.

        Override this hook if the engine returns positions alone in less time.
        """
        return self._poses(bodies)[0]

    @abstractmethod
    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return linear (k, 3) [m/s] and angular (k, 3) [rad/s] velocities of any bodies; k may be 0.

        Frozen bodies have zero velocity. The values of moved bodies may be arbitrary, because ``velocities_now``
        replaces them.
        """

    # -- called by the port ------------------------------------------------------------------------

    @abstractmethod
    def _freeze(self, body: int) -> None:
        """Stop and hold a live body, so that nothing moves the body by a single bit until ``_unfreeze`` or ``_move``.

        The call may come at any time between steps. During the call ``bodies.live`` still contains the body.
        """

    @abstractmethod
    def _unfreeze(self, body: int) -> None:
        """Make a frozen body live again, at rest, with its own mass and under the present gravity.

        The call may come at any time between steps. During the call ``bodies.frozen`` still contains the body.
        """

    def _join(self, pair: Pair) -> None:
        """Join two live bodies, so that they keep their present pose relative to each other.

        The call may come at any time between steps, for a pair that is not joined. An adapter whose capabilities state
        ``weld`` implements this hook and ``_part``.
        """
        raise NotImplementedError(
            f"{self.engine}: the capabilities state a weld, but the adapter has no method _join; add this method"
        )

    def _part(self, pair: Pair) -> None:
        """End the joint of a joined pair. The call may come at any time between steps."""
        raise NotImplementedError(
            f"{self.engine}: the capabilities state a weld, but the adapter has no method _part; add this method"
        )

    @abstractmethod
    def _contacts(self) -> Contacts:
        """Return every contact of the latest step that touches a live body and no removed body.

        The call comes between steps while a body is live. It may come before the first step, and after a freeze, an
        unfreeze, a move or a removal. Normals point from a to b. The id of the ground is ``GROUND``, and ``fixed_id``
        of ``contact_completion`` returns the id of a fixed body. Unknown values are NaN. The arrays may be views until
        the next step.
        """

    def _motions_before(self) -> Motions | None:
        """Return the motions before each substep of the latest frame; None if nothing has recorded these motions.

        The port calls this hook for engines without ``near_contacts`` only.
        """
        return None

    @abstractmethod
    def _find_contacts(self) -> Contacts:
        """Return the contacts that the engine detects at the present poses, without a change of the simulation.

        The call comes between steps while a body is live. The result may include contacts between two frozen bodies.
        The caller ignores relative velocities and forces.
        """

    # -- the end -----------------------------------------------------------------------------------

    @abstractmethod
    def _close(self) -> None:
        """Free the engine's memory. No hook follows this call."""

    # -- for adapters and the port -----------------------------------------------------------------

    def velocities_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return linear [m/s] and angular [rad/s] velocities (k, 3) of bodies (k,).

        The velocities of moved bodies are the host's values.
        """
        return self.as_driven(bodies, *self._velocities(bodies))

    def as_driven(self, bodies: IntArray, linear: FloatArray, angular: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Overwrite the velocities (k, 3) of moved bodies among ``bodies`` by the host's values; return both arrays."""
        if self.bodies.moved:
            for row, body in enumerate(bodies.tolist()):
                if body in self.bodies.moved:
                    linear[row], angular[row] = self.bodies.moved[body]
        return linear, angular
