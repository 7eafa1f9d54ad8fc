"""A user's own scene, without code: a file of bricks, for which exact statics gives the expected outcome.

``scenarios.formats`` reads MJCF, URDF and USD files. Their bodies are in place from time 0. A TOML file has times:

    name = "mine"                      # optional, like all fields before the first brick
    friction = 0.45
    gravity = [0.0, 0.0, -9.81]        # m/s2
    watch_s = 5.0                      # duration of the trial after the last action, s
    [[brick]]
    size = [0.117, 0.0234, 0.0078]     # m
    position = [0.0, 0.0, 0.0039]      # of the centre, m; the ground is z = 0
    mass = 0.0119                      # kg
    time = 0.0                         # time of placement, s; the scene places bricks of the same time together
    yaw = 30.0                         # deg, optional; or quaternion = [w, x, y, z]
    removed = 8.0                      # time of removal, s, optional
    friction = 0.3                     # own coefficient, optional; a pair has the geometric mean of both
    [[brick]]
    shape = "cylinder"                 # or "capsule", "sphere" (radius), "polyhedron" (vertices = [[x, y, z], ...])
    radius = 0.03                      # m; the axis is the body's own z
    length = 0.1                       # m; the length of a capsule excludes both caps
    position = [0.2, 0.0, 0.05]
    density = 557.0                    # kg/m3, in place of the mass
    time = 1.0
    [[fixed]]                          # a body that never moves: a wall, a table, a ceiling; optional
    size = [0.02, 0.1, 0.1]
    position = [0.07, 0.0, 0.05]       # and yaw or quaternion, like a brick
    [[push]]                           # a blow at the centre of mass; optional
    brick = 0                          # number of the brick in the file, from 0
    time = 5.0                         # s
    impulse = [0.01, 0.0, 0.0]         # N s
    [[pull]]                           # a pull at a given velocity, then the removal of the brick; optional
    brick = 1
    time = 5.0                         # s
    velocity = [0.1, 0.0]              # m/s
    seconds = 1.0

In a TOML file, bricks must touch their support to within 0.2 mm, and must not overlap. The module shifts the bricks of
one time along z, as one group, so that the group touches its support exactly. The module also finds the level of each
brick (``own_content.levelled``). Bricks of one time that form several levels are a prebuilt stack. The scene places a
prebuilt stack without a gap, and does not drop the stack from ``CLEARANCE``.

Three parameters change the whole scene:

- ``size``: factor on all lengths, including the clearance;
- ``mass``: factor on all masses;
- ``yaw``: turn about z.

The outcome must not depend on these parameters, because statics does not depend on them. For a ``size`` above 1 all
times grow by sqrt(``size``), including ``watch_s``, because falls take longer by this factor.

Theory: ``scenarios.statics.truth.first_fall`` gives the outcome, under both conventions for the normal at a ridge. The
scene is a study

- if the two answers differ;
- if statics finds no proof;
- if the file has a push or a pull;
- if the file has more than ``MOST_JUDGED`` bricks.

Keep the deciding quantity at least 5 % away from its limit, because statics ignores energy.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Annotated

from scenarios.formats.read import SDF, SUFFIXES, read_file
from scenarios.model import (
    CLEARANCE,
    Action,
    Brick,
    Expectation,
    Place,
    Pull,
    Push,
    Remove,
    Scene,
    pace_of,
)
from scenarios.parameters import Real, Value
from scenarios.scenario import dynamic_scenario
from scenarios.scenes.shared.own_content import OwnContent, levelled
from scenarios.scenes.shared.toml_scene import read_toml
from scenarios.scenes.shared.transforms import transformed
from scenarios.statics.truth import UndecidedError, first_fall

EXAMPLES = Path(__file__).parents[1] / "examples"
TOML = ".toml"
MOST_JUDGED = 200
"""Greatest number of bricks that exact statics judges when the scene is built, which takes about a minute for 200. For
larger scenes ``bench list --truth`` gives the judge's answer."""


@dynamic_scenario
def own_scene(
    *,
    file: str = "lintel.toml",
    size: Annotated[float, Real(0.01, 100)] = 1.0,
    mass: Annotated[float, Real(1e-3, 1e3)] = 1.0,
    yaw: Annotated[float, Real(-360, 360, "deg")] = 0.0,
) -> Scene:
    """Build a scene of your own from a TOML, MJCF, URDF or USD file.

    Args:
        file: path of the file, or the name of a file in ``scenarios/examples``.
        size: factor on all lengths, but not on masses. Above 1, the square root of ``size`` is the factor on all times.
        mass: factor on all masses.
        yaw: turn of the whole scene about the z axis [deg].

    Raises:
        ValueError: if the file cannot be read, or a scene cannot hold its content; the message names file and fix.
    """
    suffixes = (TOML, *SUFFIXES)
    if not isinstance(file, str) or Path(file).suffix.lower() not in suffixes:
        known = ", ".join(repr(suffix) for suffix in suffixes if suffix not in SDF)
        raise ValueError(
            f"file must be the name of a scene file, got {file!r}: give a file whose name ends in one of {known}"
        )
    path = Path(file) if Path(file).exists() else EXAMPLES / file
    try:
        is_text = path.suffix.lower() == TOML
        text = path.read_text(encoding="utf-8") if is_text else ""
        content = text.encode() if is_text else path.read_bytes()
    except (OSError, UnicodeDecodeError) as error:
        examples = ", ".join(sorted(example.name for example in EXAMPLES.iterdir() if example.suffix in suffixes))
        raise ValueError(
            f"{file}: cannot read this file ({error}); give the path of a readable file, or an example: {examples}"
        ) from error
    try:
        return _scene(file, path, text, hashlib.blake2b(content).hexdigest()[:8], size, mass, yaw)
    except (ValueError, LookupError) as error:
        raise ValueError(f"{file}: {error}") from error


@lru_cache(maxsize=64)
def _scene(file: str, path: Path, text: str, digest: str, size: float, mass: float, yaw: float) -> Scene:
    """Return the scene of a file.

    The scene's id includes the digest of the content, so that a changed file is another scene. The id of the default
    file has no digest.

    Args:
        file: the path or name that the user gives.
        path: path of the file.
        text: the content of a TOML file; empty for other formats.
        digest: digest of the content.
        size: factor on lengths.
        mass: factor on masses.
        yaw: turn [deg].
    """
    content = read_toml(text) if path.suffix.lower() == TOML else _imported(path)
    bricks = [transformed(brick, size, mass, yaw) for brick in content.bricks]
    fixed = tuple(transformed(wall, size, mass, yaw) for wall in content.world.fixed)
    parameters: dict[str, Value] = {"file": file, "size": size, "mass": mass, "yaw": yaw}
    look_for = "whether the bricks stand or fall as exact statics says, and when"
    scene = Scene(
        scenario="own_scene",
        variant=_variant(content.name or Path(file).stem, digest, parameters),
        parameters=parameters,
        world=replace(content.world, fixed=fixed),
        actions=_actions(content, bricks, size, mass, yaw),
        expectation=Expectation("study", "not yet judged"),
        look_for="; ".join([look_for, *content.notes]),
        planar=all(_is_planar(brick) for brick in (*bricks, *fixed)),
        watch_s=content.watch_s * pace_of(size),
        size=size,
    )
    return replace(scene, expectation=_judged(scene))


def _imported(path: Path) -> OwnContent:
    """Return the content of an MJCF, URDF or USD file, with all bodies in place at time 0.

    Raises:
        ValueError: if a scene cannot hold the content of the file; the message names the fix.
    """
    imported = read_file(path)
    times = (0.0,) * len(imported.bricks)
    bricks = levelled(imported.bricks, times, imported.names, imported.world.fixed)
    return OwnContent(imported.world, bricks, times, notes=imported.notes)


def _variant(name: str, digest: str, parameters: Mapping[str, Value]) -> str:
    """Return the id of the variant: name and digest unless the file is the default, then all changed parameters."""
    default = own_scene.defaults["file"]
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", name)
    content = "" if parameters["file"] == default else f"-{plain}-{digest}"
    changes = own_scene.variant({**parameters, "file": default}).removeprefix("own_scene")
    return f"own_scene{content}{changes}"


def _actions(content: OwnContent, bricks: Sequence[Brick], size: float, mass: float, yaw: float) -> tuple[Action, ...]:
    pace = pace_of(size)
    actions: list[Action] = [
        _placed(time * pace, tuple(brick for _, brick in group), CLEARANCE * size)
        for time, group in groupby(zip(content.times, bricks, strict=True), key=lambda entry: entry[0])
    ]
    actions += [_transformed(action, size, mass, yaw) for action in content.then]
    return tuple(sorted(actions, key=attrgetter("time")))


def _transformed(action: Remove | Push | Pull, size: float, mass: float, yaw: float) -> Action:
    """Return an ``action`` of the changed scene.

    Velocities grow by the factor on lengths over the factor on times.
    """
    pace, turn = pace_of(size), math.radians(yaw)
    cos, sin, factor = math.cos(turn), math.sin(turn), size / pace_of(size)
    if isinstance(action, Push):
        x, y, z = (mass * factor * part for part in action.impulse)
        return Push(action.time * pace, action.brick, (cos * x - sin * y, sin * x + cos * y, z))
    if isinstance(action, Pull):
        x, y = (factor * part for part in action.velocity)
        velocity, seconds = (cos * x - sin * y, sin * x + cos * y), action.seconds * pace
        return replace(action, time=action.time * pace, velocity=velocity, seconds=seconds)
    return replace(action, time=action.time * pace)


def _placed(time: float, group: tuple[Brick, ...], clearance: float) -> Place:
    """Return the action that places a group with a gap of ``clearance`` [m].

    A group of several levels has no gap.
    """
    is_prebuilt = len({brick.level for brick in group}) > 1
    return Place(time, group, 0.0 if is_prebuilt else clearance)


def _judged(scene: Scene) -> Expectation:
    """Return the expectation by exact statics."""
    if any(isinstance(action, Push | Pull) for action in scene.actions):
        return Expectation("study", "statics does not decide what a push or a pull does")
    if len(scene.bricks) > MOST_JUDGED:
        return Expectation("study", f"more than {MOST_JUDGED} bricks: bench list --scenario FILE --truth judges them")
    try:
        falls = {first_fall(scene, ridge=ridge) for ridge in ("bisector", "face")}
    except UndecidedError as error:
        return Expectation("study", f"exact statics finds no proof: {error}")
    if len(falls) > 1:
        return Expectation("study", "the answer depends on the normal at a ridge, which is a convention")
    level = falls.pop()
    if level is None:
        return Expectation("stand", "exact statics finds forces that hold the bricks")
    return Expectation("fall", "exact statics finds no forces that hold the bricks", level, _due_s(scene))


def _due_s(scene: Scene) -> float:
    """Return the time [s] of the removal that first makes the scene fall; 0 if a placement makes the scene fall."""
    for index, action in enumerate(scene.actions):
        if isinstance(action, Remove):
            before, after = (replace(scene, actions=scene.actions[:end]) for end in (index, index + 1))
            if first_fall(before) is None and first_fall(after) is not None:
                return action.time
    return 0.0


def _is_planar(brick: Brick) -> bool:
    _, i, _, k = brick.quaternion
    return brick.position[1] == 0.0 and i == 0.0 and k == 0.0
