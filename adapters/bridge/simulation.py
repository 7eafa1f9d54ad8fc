"""A world of an engine in a separate process, with one message per frame.

The simulation collects the host's changes between two frames (spawned, frozen or pushed bodies, for example) and sends
these changes with the next step. Until then the simulation predicts the states: a pushed body has its new velocity, a
moved body its new pose. A frozen body keeps the latest pose before its freeze, at rest, and no message requests its
state until its unfreeze.

The first ``find_contacts`` starts a second process. Each call opens a world in this process with the same bodies,
weightless and at rest. The contacts of one very short step in this world are the result, so that the first world does
not change.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import ClassVar

import numpy as np

from adapters.base import Simulation
from adapters.bridge.carried import carried
from adapters.bridge.description import Detection, described
from adapters.bridge.errors import ProtocolError
from adapters.bridge.messages import (
    ANGULAR,
    LINEAR,
    POSITION,
    PROTOCOL,
    QUATERNION,
    STATE_WIDTH,
    Code,
    Command,
    Kind,
    StepReply,
    json_body,
    json_content,
    step_body,
    step_reply,
)
from adapters.bridge.peer import SILENCE_S, Peer
from adapters.shared.box_contacts import NEAR
from adapters.shared.contact_forces import SubstepForces, mean_force
from adapters.shared.live_pairs import of_live
from adapters.shared.vectors import half_edges
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.shared.approach import Motions, fastest_approach

_INSTANT_S = 1e-6
"""Step [s] in which ``find_contacts`` detects contacts. The step is short, so that no body moves."""
_CLOCK_S = 1e-3
"""Time [s] by which the reported time of the engine's steps may exceed the frame's wall time, because the clocks of
engine and suite differ."""


class BridgeSimulation(Simulation):
    """One world of an engine in a separate process. A subclass defines ``command``, the engine's command line."""

    folder: ClassVar[Path] = Path()
    """Working directory of the engine's process."""
    timeout_s: ClassVar[float] = SILENCE_S
    contacts_at: ClassVar[Detection] = "start"
    solver_noise: ClassVar[float] = 0.0

    def _open(self) -> None:
        self._commands: list[Command] = []
        self._states = np.full((64, STATE_WIDTH), np.nan)  # by the body's id
        self._reply: StepReply | None = None  # answer of the latest frame, a view of it, if its contacts were read
        self._replied: IntArray = np.empty(0, np.int64)
        self._finder: Peer | None = None  # process of find_contacts; None until the first call
        self._peer = self._started()
        self._peer.ask(Kind.OPEN, json_body(self._opening()))

    @classmethod
    @abstractmethod
    def command(cls) -> Sequence[str]:
        """Return the engine's program and its arguments."""

    # -- bodies ------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._insert(Code.SPAWN, body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._insert(Code.SPAWN_MOVED, body, brick)

    def _remove(self, body: int) -> None:
        self._commands.append((Code.REMOVE, body))

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._commands.append((Code.MOVE, body, *position, *quaternion))
        self._place(body, position, quaternion)

    # -- actions -----------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        self._commands.append((Code.PUSH, body, *impulse))
        self._states[body, LINEAR] += np.array(impulse) / self.bricks[body].mass

    def _press(self, body: int, force: Vector) -> None:
        self._commands.append((Code.PRESS, body, *force))

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        self._commands.append((Code.DRIVE, body, *linear, *angular))

    def _set_gravity(self, gravity: Vector) -> None:
        self._commands.append((Code.GRAVITY, 0.0, *gravity))

    # -- time --------------------------------------------------------------------------------------

    def _step(self, seconds: float) -> None:
        begin = perf_counter()
        substeps = self.info.profile.substeps
        self._act_on_bodies(seconds / substeps)
        is_read = self.is_observed and bool(self.bodies.live)
        bodies = self.bodies.moving()
        reply = self._exchange(seconds / substeps, substeps, is_read, bodies)
        self._reply, self._replied = reply if is_read else None, bodies
        if is_read and self.bodies.moved:
            for state in reply.states[:-1]:
                self.as_driven(bodies, state[:, LINEAR], state[:, ANGULAR])
        elapsed = perf_counter() - begin
        if reply.engine_s > elapsed + _CLOCK_S:
            raise ProtocolError(
                f"the reported duration of the engine's steps must be at most the duration of the frame, {elapsed:g} "
                f"s, got {reply.engine_s:g} s: report the duration in seconds"
            )
        self.own_step_s = min(reply.engine_s, elapsed)

    # -- state -------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._states[bodies]
        return rows[:, POSITION], rows[:, QUATERNION]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._states[bodies]
        return rows[:, LINEAR], rows[:, ANGULAR]

    # -- called by the port ------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._commands.append((Code.FREEZE, body))
        self._states[body, QUATERNION.stop :] = 0.0

    def _unfreeze(self, body: int) -> None:
        self._commands.append((Code.UNFREEZE, body))

    def _contacts(self) -> Contacts:
        reply = self._reply
        if reply is None or not reply.is_finite:
            return Contacts.empty()
        before = reply.states[-2 if self.contacts_at == "start" else -1]
        contacts = self._as_contacts(reply.contacts, self._replied, before, reply.states[-1])
        pairs, normal = (contacts.body_a, contacts.body_b), contacts.normal
        velocity = fastest_approach(self._motions_before(), *pairs, contacts.point, normal, self.solver_noise)
        force = None
        if self.reads_forces and contacts.force is not None:
            force = mean_force(SubstepForces(*pairs, contacts.force), normal, self._earlier_forces(reply))
        return of_live(
            Contacts(*pairs, contacts.point, normal, contacts.separation, velocity, contacts.friction, force),
            self.bodies,
        )

    def _motions_before(self) -> Motions | None:
        if self._reply is None:
            return None
        before = self._reply.states[:-1]
        return Motions(self._replied, before[:, :, POSITION], before[:, :, LINEAR], before[:, :, ANGULAR])

    def _find_contacts(self) -> Contacts:
        if self._finder is None:
            self._finder = self._started()
        weightless = {**self._opening(), "gravity": (0.0, 0.0, 0.0), "sleeping": "off"}
        self._finder.ask(Kind.OPEN, json_body(weightless))
        bodies = self.bodies.moving()
        question = step_body(_INSTANT_S, 1, True, self._copies())
        reply = step_reply(self._finder.ask(Kind.STEP, question), bodies, 2, self._states.copy())
        return self._as_contacts(reply.contacts, bodies, reply.states[0], reply.states[0])

    # -- the end -----------------------------------------------------------------------------------

    def _close(self) -> None:
        self._peer.close()
        if self._finder is not None:
            self._finder.close()

    # -- helpers -----------------------------------------------------------------------------------

    def _started(self) -> Peer:
        """Start a process of the engine, and return it.

        Raises:
            ProtocolError: if the engine's version differs from the recorded version, or the hello message is not valid.
            PeerError: if the engine does not start, or reports an error.
        """
        peer = Peer(self.command(), self.folder, self.timeout_s)
        said = described(json_content(peer.ask(Kind.HELLO, json_body({"protocol": PROTOCOL}))))
        if said.version != self.info.version:
            raise ProtocolError(
                f"{self.engine} must report the recorded version {self.info.version}, got {said.version}: restart this "
                "program after a change of the engine"
            )
        return peer

    def _copies(self) -> Iterator[Command]:
        """Yield the commands that spawn all bodies at their present poses, at rest, and freeze the frozen bodies."""
        for body, brick in self.bricks.items():
            code = Code.SPAWN_MOVED if body in self.bodies.moved else Code.SPAWN
            yield (code, body, *brick.size, brick.mass, *self._states[body, : LINEAR.start].tolist())
            if body in self.frozen:
                yield (Code.FREEZE, body)

    def _opening(self) -> Mapping[str, object]:
        """Return the content of the message that opens the world."""
        ground, *fixed = (box for _, box in self._fixed_boxes())
        half_x, half_y, half_z = half_edges(ground.size)
        return {
            "gravity": self.world.gravity,
            "friction": self.world.friction,
            "scale": self.scale,
            "ground_half_edges": (half_x + abs(ground.position[0]), half_y, half_z),  # a ground centred at x = 0
            "fixed": [_box(box) for box in fixed],
            "sleeping": self.info.sleeping,
            "knobs": self.info.profile.values,
            "expected": len(self.expected),
        }

    def _insert(self, code: Code, body: int, brick: Brick) -> None:
        self._commands.append((code, body, *brick.size, brick.mass, *brick.position, *brick.quaternion))
        if body >= len(self._states):
            self._states = np.concatenate([self._states, np.full_like(self._states, np.nan)])
        self._place(body, brick.position, brick.quaternion)

    def _place(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Record the pose of a body ([m], quaternion w, x, y, z), at rest."""
        self._states[body] = (*position, *quaternion, *(0.0,) * 6)

    def _exchange(self, substep_s: float, substeps: int, is_read: bool, bodies: IntArray) -> StepReply:
        """Send the collected commands with a step, and return the answer.

        Raises:
            PeerError: if the engine fails, or breaks the protocol.
        """
        question = step_body(substep_s, substeps, is_read, self._commands)
        self._commands.clear()
        answer = self._peer.ask(Kind.STEP, question)
        return step_reply(answer, bodies, substeps + 1 if is_read else 1, self._states)

    def _as_contacts(self, rows: FloatArray, bodies: IntArray, before: FloatArray, after: FloatArray) -> Contacts:
        """Return the contacts of the engine's points that touch or nearly touch at the end of a substep.

        The arguments have the same meaning as in ``carried``.
        """
        points, normals, separations = carried(rows, bodies, before, after)
        near = np.flatnonzero(separations <= NEAR * self.scale)
        a, b = rows[near, :2].astype(np.int64).T
        friction = np.full(len(near), self.world.friction)
        unknown = np.full((len(near), 3), np.nan)
        return Contacts(a, b, points[near], normals[near], separations[near], unknown, friction, rows[near, 11:])

    def _earlier_forces(self, reply: StepReply) -> list[SubstepForces]:
        """Return the forces of each substep of the frame except the last."""
        substep, body_a, body_b = reply.forces[:, :3].astype(np.int64).T
        earlier = []
        for number in range(self.info.profile.substeps - 1):
            rows = substep == number
            earlier.append(SubstepForces(body_a[rows], body_b[rows], reply.forces[rows, 3:]))
        return earlier


def _box(box: Brick) -> Mapping[str, object]:
    fields = asdict(box)
    return {name: fields[name] for name in ("size", "position", "quaternion")}
