"""Calls of pymunk for freezing, for the port and for the suite's adapter.

``freeze`` stops a body and makes it static. No step of Chipmunk changes a bit of its pose. A body that becomes dynamic
again has lost its mass and moment of inertia, so that the caller sets both.

Traps:

- A static body keeps the pending correction of its overlap (``v_bias``). This correction would move the body after
  ``unfreeze``. An integration over a time of 0 clears the correction.
- Chipmunk keeps the arbiters (contact records) of two static bodies without end. Other contacts soon reuse the memory
  of their points. ``forget_pairs`` deletes the arbiters.
- A change of the body type in a callback of a step aborts the process.
"""

from __future__ import annotations

import pymunk


def halt(planar: pymunk.Body) -> None:
    """Stop a body, and clear the pending correction of its overlap, because the correction would move the body."""
    planar.velocity = 0.0, 0.0
    planar.angular_velocity = 0.0
    pymunk.Body.update_position(planar, 0.0)


def freeze(planar: pymunk.Body) -> None:
    """Stop a body, and make it static. Call ``forget_pairs`` before the next step."""
    halt(planar)
    planar.body_type = pymunk.Body.STATIC


def unfreeze(planar: pymunk.Body, mass: float, moment: float) -> None:
    """Make a static body dynamic again, with this mass and moment of inertia, in the units of the space."""
    planar.body_type = pymunk.Body.DYNAMIC
    planar.mass, planar.moment = mass, moment


def forget_pairs(space: pymunk.Space, planar: pymunk.Body) -> None:
    """Delete the arbiters of a newly frozen body; the next step detects new contacts with live bodies.

    The function removes and adds the shapes, because Chipmunk deletes the arbiters of a removed shape.
    """
    shapes = [shape for shape in planar.shapes if shape.space is space]
    space.remove(*shapes)
    space.add(*shapes)
