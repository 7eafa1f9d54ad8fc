"""An engine that misbehaves as its profile says; under ``game`` bricks just stay where they are let go.

Frames are long, so that a trial is over in some milliseconds.
"""

import ctypes
import faulthandler
import os
import signal
import time
from typing import ClassVar

import numpy as np

from adapters.base import Simulation
from adapters.profile import Capabilities, Profile
from stability_core.port import Contacts

FIRST_MISDEED = 5
"""The frame in which it misbehaves."""


def _hang(_):
    while True:
        ctypes.PyDLL(None).sleep(3600)  # holds the interpreter's lock, as an engine in an endless loop does


def _stall(_):
    ctypes.PyDLL(None).sleep(4)  # as _hang, but it ends


def _alarm(_):
    os.kill(os.getpid(), signal.SIGALRM)


def _leak(simulation):
    simulation.hoard.append(np.ones(2**21))  # 16 MiB a frame
    time.sleep(0.02)


def _raise(_):
    raise RuntimeError("the solver gave up")


def _garbage(_):
    os.write(1, bytes(range(256)) * 64)
    os.write(2, b"\xff\x00\x1b[31m not a record \n" * 64)


def _diverge(simulation):
    simulation.pose[0] = np.full(3, np.nan)


def _exit(_):
    os._exit(3)


def _red_exit(_):
    os.write(1, b"\x1b[1;31mout of contacts\x1b[0m\n\x1b[0m\n")
    os._exit(3)


MISDEEDS = {
    "game": lambda _: None,
    "slow": lambda _: time.sleep(0.05),
    "segfault": lambda _: faulthandler._sigsegv(),
    "abort": lambda _: os.abort(),
    "exit": _exit,
    "red_exit": _red_exit,
    "hang": _hang,
    "stall": _stall,
    "alarm": _alarm,
    "leak": _leak,
    "raise": _raise,
    "nan": _diverge,
    "garbage": _garbage,
}


class RogueSimulation(Simulation):
    engine = "rogue"
    capabilities = Capabilities(
        contact_points="none",
        near_contacts=True,
        separation=True,
        relative_velocity="reported",
        forces="no",
        freeze="exact",
        frozen_contacts=False,
        friction_law="none",
        moved="no",
        deterministic="across processes",
    )
    profiles: ClassVar = {
        name: Profile(name, name, 1, frame_s=0.01 if name == "leak" else 0.25, tuned_by="as shipped")
        for name in MISDEEDS
    }

    def _open(self) -> None:
        self.pose = {}
        self.hoard = []
        self.frames = 0

    def _spawn(self, body, brick) -> None:
        self.pose[body] = np.array(brick.position)

    def _spawn_moved(self, body, brick) -> None:
        self._spawn(body, brick)

    def _drive(self, body, linear, angular, seconds) -> None: ...

    def _remove(self, body) -> None:
        del self.pose[body]

    def _push(self, body, impulse) -> None: ...

    def _press(self, body, force) -> None: ...

    def _set_gravity(self, gravity) -> None: ...

    def _move(self, body, position, quaternion) -> None: ...

    def _step(self, seconds) -> None:
        self.frames += 1
        if self.frames >= FIRST_MISDEED:
            MISDEEDS[self.info.profile.name](self)

    def _poses(self, bodies):
        quaternion = np.zeros((len(bodies), 4))
        quaternion[:, 0] = 1
        return np.array([self.pose[body] for body in bodies.tolist()]).reshape(-1, 3), quaternion

    def _velocities(self, bodies):
        return np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))

    def _contacts(self):
        return Contacts.empty()

    def _find_contacts(self):
        return Contacts.empty()

    def _freeze(self, body) -> None: ...

    def _unfreeze(self, body) -> None: ...

    def _close(self) -> None: ...
