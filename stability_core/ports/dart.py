"""A port to a DART world that the user owns.

The port controls skeletons of one body on a free joint. All other bodies are obstacles:

- links of robots, fixed skeletons and immobile skeletons;
- bodies without gravity, and bodies whose joint has an actuator;
- skeletons that the user leaves out.

The port numbers the body nodes, because DART's bodies have names only. The attachment's methods accept skeletons of one
body, and body nodes.

The port returns DART's contacts, which belong to the poses before the latest step. The port adds the missing corners of
contact areas between boxes, standing cylinders and planes. DART's own sleeping (deactivation) may stay on, because DART
lists the contacts of its sleeping bodies. The port changes no setting of the world or of a live body.

Traps:

- DART's list of contacts refers to freed memory once a skeleton has left the world. The port then finds the contacts
  again, until the next step. The port does not detect that you remove the last skeleton of a world and add the same
  skeleton again. Make this change after ``update``, not between a step and ``update``.
- By default, DART keeps at most 1000 contacts. A live body whose contacts DART has dropped does not freeze.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import dartpy

from stability_core.ports.dart_world import DartWorld
from stability_core.ports.shared.free_body_port import FreeBodyPort


def open_port(world: Any, bodies: Collection[Any] | None) -> DartPort:
    """Return a port to a world of DART.

    Args:
        world: the world.
        bodies: the skeletons or body nodes to control; None for all bodies that can freeze.

    Raises:
        TypeError: if the world is no ``dartpy.simulation.World``, or an object in ``bodies`` is neither a skeleton nor
            a body node.
        ValueError: if a body cannot freeze, ``bodies`` lists a body twice, or the world has constraints and ``bodies``
            is None.
        KeyError: if a body is not in the world.
    """
    if not isinstance(world, dartpy.simulation.World):
        raise TypeError(
            f"attach() needs a dartpy.simulation.World, got {type(world).__name__}: pass the world that you step"
        )
    return DartPort(world, bodies)


class DartPort(FreeBodyPort):
    """The core's view of the free bodies of a world of DART."""

    def __init__(self, world: Any, bodies: Collection[Any] | None) -> None:
        self._dart = DartWorld(world, takes_all=bodies is None)
        self._dart.check()
        super().__init__(self._dart, ("dart", id(world)), bodies)

    def add(self, bodies: Iterable[Any]) -> None:
        """Control skeletons of one free body, or the body nodes of these skeletons.

        Raises:
            TypeError: for an object that is neither a skeleton nor a body node.
            ValueError: for a body that cannot freeze, or that the port controls already.
            KeyError: for a body that is not in the world.
        """
        super().add([self.id_of(body) for body in bodies])

    def id_of(self, body: Any) -> int:
        """Return the id of a skeleton of one body, or of a body node.

        Raises:
            TypeError: for an object that is neither a skeleton nor a body node.
            ValueError: for a skeleton of several bodies.
            KeyError: if the body is not in the world.
        """
        node = _node_of(body)
        if node not in self._dart.ids:
            self._bodies.follow()  # find the bodies that came after the latest update
        if node not in self._dart.ids:
            name = node.getSkeleton().getName()
            raise KeyError(f"the skeleton {name!r} is not in this DART world: call world.addSkeleton() first")
        return self._dart.ids[node]

    def body_of(self, body: int) -> Any:
        """Return the body node of an id.

        Raises:
            KeyError: if no body in the world has this id.
        """
        if body not in self._dart.nodes:
            raise KeyError(f"no body of this DART world has the id {body}: pass ids that id_of() or update() returned")
        return self._dart.nodes[body]


def _node_of(body: Any) -> Any:
    """Return a body node, or the only body node of a skeleton; see ``DartPort.id_of`` for the errors."""
    if isinstance(body, dartpy.dynamics.BodyNode):
        return body
    if not isinstance(body, dartpy.dynamics.Skeleton):
        raise TypeError(
            f"the port to DART needs a skeleton or a body node, got {type(body).__name__}: pass a skeleton of one body"
        )
    count = body.getNumBodyNodes()
    if count != 1:
        raise ValueError(
            f"the skeleton {body.getName()!r} has {count} bodies: list free bodies only, because the extension leaves "
            "robots alone; to ask about a link, pass the link's body node"
        )
    return body.getBodyNode(0)
