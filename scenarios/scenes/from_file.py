"""A user's own scene, without code: a TOML file of bricks, for which exact statics gives the expected outcome.

    friction = 0.45
    watch_s = 5.0                      # duration of the trial after the last brick, s, optional
    [[brick]]
    size = [0.117, 0.0234, 0.0078]     # m
    position = [0.0, 0.0, 0.0039]      # of the centre, m; the ground is z = 0
    mass = 0.0119                      # kg
    time = 0.0                         # time of placement, s; bricks with the same time are placed together
    yaw = 30.0                         # deg, optional; or quaternion = [w, x, y, z]
    removed = 8.0                      # time of removal, s, optional
    friction = 0.3                     # its own coefficient, optional; a pair has the geometric mean of both
    [[brick]]
    shape = "cylinder"                 # or "capsule", "sphere" (radius), "polyhedron" (vertices = [[x, y, z], ...])
    radius = 0.03                      # m; the axis is the body's own z
    length = 0.1                       # m; of a capsule, without both caps
    position = [0.2, 0.0, 0.05]
    density = 557.0                    # kg/m3, in place of the mass
    time = 1.0
    [[fixed]]                          # a body that never moves: a wall, a table, a ceiling; optional
    size = [0.02, 0.1, 0.1]
    position = [0.07, 0.0, 0.05]       # and yaw or quaternion, as of a brick

Bricks must touch their support to within 0.2 mm, and must not overlap. The module shifts bricks with the same time
along z, as one group, so that the group touches its support exactly. The module also finds the level of each brick: a
brick on the ground has level 1, and any other brick is one level above the highest brick that it stands on or leans
against. Bricks with the same time that form several levels are a prebuilt stack: the scene places the stack without a
gap, instead of dropping it from ``CLEARANCE``.

Three parameters change the whole scene:

- ``size``: factor on all lengths, including the clearance;
- ``mass``: factor on all masses;
- ``yaw``: turn about z.

Statics does not depend on these parameters, so the answer must not depend on them either. Falls take sqrt(``size``)
times as long, so for a ``size`` above 1 all times grow by this factor, including ``watch_s``.

Theory: ``scenarios.statics.truth.first_fall``, under both conventions for the normal at a ridge. If the two answers
differ, or no proof is found, the scene is a study. Statics ignores energy: keep the deciding quantity 5 % away from its
limit.
"""

from __future__ import annotations

import hashlib
import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any

from scenarios.geometry import Boxes, height_above_ground, room_above_fixed, vertical_clearance
from scenarios.lookup import look_up
from scenarios.model import (
    CLEARANCE,
    Action,
    Brick,
    Expectation,
    Place,
    Remove,
    Scene,
    World,
    pace_of,
)
from scenarios.parameters import Real, Value
from scenarios.planks import MU
from scenarios.scenario import dynamic_scenario
from scenarios.scenes.shared.brick_tables import LARGEST, read_brick, read_fixed_body, read_number, read_tables
from scenarios.scenes.shared.transforms import transformed
from scenarios.statics.contact_patch import GROUND, contact_patches
from scenarios.statics.truth import UndecidedError, first_fall

EXAMPLES = Path(__file__).parents[1] / "examples"
MOST_FIXED = 200
"""Greatest number of fixed bodies in a file."""
MOST = 200
"""Greatest number of bricks in a file, because each build of the scene solves statics, which takes about a minute for
the largest scenes."""
WATCH_S = 5.0
"""Least and default duration [s] of the trial after the last action, for a scene of size 1."""
MOST_WATCH_S = 100 * 3600.0
"""Greatest duration [s] of the trial after the last action."""
SNAP = 0.2e-3
"""Greatest gap or overlap [m] that counts as rounding in the file."""


@dynamic_scenario
def own_scene(
    *,
    file: str = "lintel.toml",
    size: Annotated[float, Real(0.01, 100)] = 1.0,
    mass: Annotated[float, Real(1e-3, 1e3)] = 1.0,
    yaw: Annotated[float, Real(-360, 360)] = 0.0,
) -> Scene:
    """Build a scene of your own, from the bricks in a TOML file.

    Args:
        file: path of the file, or the name of a file in ``scenarios/examples``.
        size: factor on all lengths, but not on masses; above 1, the square root of ``size`` is the factor on all times.
        mass: factor on all masses.
        yaw: turn of the whole scene about the z axis [deg].
    """
    if not isinstance(file, str) or not file.endswith(".toml"):
        raise ValueError(f"file must be the name of a file that ends in '.toml', got {file!r}")
    path = Path(file) if Path(file).exists() else EXAMPLES / file
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        examples = ", ".join(sorted(example.name for example in EXAMPLES.glob("*.toml")))
        raise ValueError(
            f"{file}: cannot be read ({error}); give the path of a readable file, or the name of an example: {examples}"
        ) from error
    try:
        return _scene(file, text, size, mass, yaw)
    except (ValueError, LookupError) as error:
        raise ValueError(f"{file}: {error}") from error


@lru_cache(maxsize=64)
def _scene(file: str, text: str, size: float, mass: float, yaw: float) -> Scene:
    """Return the scene described by ``text``; its id includes the content, so that a changed file is another scene."""
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not valid TOML, correct the syntax: {error}") from error
    for field in content:
        look_up("field", field, dict.fromkeys(("friction", "watch_s", "brick", "fixed")))
    tables = read_tables(content, "brick", least=1, most=MOST)
    fixed = tuple(
        read_fixed_body(f"fixed[{n}]", one)
        for n, one in enumerate(read_tables(content, "fixed", least=0, most=MOST_FIXED))
    )
    watch_s = Real(WATCH_S, MOST_WATCH_S).check("watch_s", content.get("watch_s", WATCH_S))
    friction = Real(0, 10).check("friction", content.get("friction", MU))
    laid = sorted(
        ((read_number(f"brick[{n}].time", table.get("time"), 0, LARGEST), n, table) for n, table in enumerate(tables)),
        key=lambda entry: entry[:2],
    )
    bricks = [read_brick(f"brick[{n}]", one) for _, n, one in laid]
    times, numbers = [time for time, _, _ in laid], [n for _, n, _ in laid]
    bricks = _levelled(_settled(bricks, times, fixed), times, numbers, fixed)
    bricks = [transformed(brick, size, mass, yaw) for brick in bricks]
    fixed = tuple(transformed(wall, size, mass, yaw) for wall in fixed)
    parameters: dict[str, Value] = {"file": file, "size": size, "mass": mass, "yaw": yaw}
    scene = Scene(
        scenario="own_scene",
        variant=_variant(text, parameters),
        parameters=parameters,
        world=World(friction=friction, fixed=fixed),
        actions=_actions(bricks, laid, size),
        expectation=Expectation("study", "not yet judged"),
        look_for="whether the bricks stand or fall as exact statics says, and when",
        planar=all(_is_planar(brick) for brick in (*bricks, *fixed)),
        watch_s=watch_s * pace_of(size),
        size=size,
    )
    return replace(scene, expectation=_judged(scene))


def _variant(text: str, parameters: Mapping[str, Value]) -> str:
    """Return the id of the variant: name and digest of a file other than the default, then all changed parameters."""
    default = own_scene.defaults["file"]
    file = str(parameters["file"])
    name = re.sub(r"[^A-Za-z0-9_-]", "_", Path(file).stem)
    content = "" if file == default else f"-{name}-{hashlib.blake2b(text.encode()).hexdigest()[:8]}"
    changes = own_scene.variant({**parameters, "file": default}).removeprefix("own_scene")
    return f"own_scene{content}{changes}"


def _settled(bricks: list[Brick], times: list[float], fixed: Sequence[Brick]) -> list[Brick]:
    """Return the bricks, each group shifted along z by at most ``SNAP`` so that it touches the bodies below."""
    settled: list[Brick] = []
    for _, group in groupby(range(len(bricks)), key=times.__getitem__):
        coming = [bricks[index] for index in group]
        boxes = Boxes.of(coming)
        room = _room_below(boxes, settled, fixed)
        drop = room if abs(room) <= SNAP else 0.0
        settled += [replace(brick, position=(*brick.position[:2], brick.position[2] - drop)) for brick in coming]
    return settled


def _room_below(boxes: Boxes, there: Sequence[Brick], fixed: Sequence[Brick]) -> float:
    """Return the distance [m] that boxes can sink together until one meets a placed brick, a fixed box or the ground.

    The distance is negative if the boxes must rise.
    """
    room = min(float(height_above_ground(boxes).min()), room_above_fixed(boxes, Boxes.of(fixed)))
    return min(room, float(vertical_clearance(boxes, Boxes.of(there)).min(initial=math.inf)))


def _levelled(bricks: list[Brick], times: list[float], numbers: list[int], fixed: Sequence[Brick]) -> list[Brick]:
    """Return the bricks, in the order of placement, with their levels.

    Raises:
        ValueError: if two bricks overlap, or a brick touches nothing when it is placed.
    """
    try:
        patches = contact_patches(bricks, fixed)
    except ValueError as error:
        raise ValueError(f"{error} (brick numbers count from 0, in the order of the bricks' times)") from error
    touched: dict[int, set[int]] = {index: set() for index in range(len(bricks))}
    for patch in patches:
        for one, other in ((patch.first, patch.second), (patch.second, patch.first)):
            if one != GROUND:
                touched[one].add(other)
    levels: dict[int, int] = {GROUND: 0}
    for _, group in groupby(range(len(bricks)), key=times.__getitem__):
        coming = list(group)
        while coming:  # lowest first, because a brick of the group may carry another
            carried = [index for index in coming if touched[index] & levels.keys()]
            if not carried:
                there = [bricks[k] for k in levels if k != GROUND]
                raise ValueError(_floats(numbers[coming[0]], bricks[coming[0]], there, fixed))
            found = {index: 1 + max(levels[k] for k in touched[index] & levels.keys()) for index in carried}
            levels |= found
            coming = [index for index in coming if index not in found]
    return [replace(brick, level=levels[index]) for index, brick in enumerate(bricks)]


def _floats(number: int, brick: Brick, there: Sequence[Brick], fixed: Sequence[Brick]) -> str:
    room = _room_below(Boxes.of([brick]), there, fixed)
    return (
        f"brick[{number}] must touch a body or the ground when it is placed, but is {room * 1e3:.3f} mm above the "
        f"nearest body or ground below: set its position z to {brick.position[2] - room:g} m, or place its support "
        "earlier"
    )


def _actions(
    bricks: Iterable[Brick], laid: Iterable[tuple[float, int, Mapping[str, Any]]], size: float
) -> tuple[Action, ...]:
    pace = pace_of(size)
    placed = [(time, brick) for (time, _, _), brick in zip(laid, bricks, strict=True)]
    actions: list[Action] = [
        _placed(time * pace, tuple(brick for _, brick in group), CLEARANCE * size)
        for time, group in groupby(placed, key=lambda entry: entry[0])
    ]
    for index, (time, n, table) in enumerate(laid):
        if "removed" in table:
            removed = read_number(f"brick[{n}].removed", table["removed"], 0, LARGEST)
            if removed <= time:
                raise ValueError(
                    f"brick[{n}].removed must be later than brick[{n}].time, which is {time:g} s, got {removed:g} s"
                )
            actions.append(Remove(removed * pace, index))
    return tuple(sorted(actions, key=attrgetter("time")))


def _placed(time: float, group: tuple[Brick, ...], clearance: float) -> Place:
    """Return the action that places a group: with a gap of ``clearance`` [m], or without a gap for several levels."""
    is_prebuilt = len({brick.level for brick in group}) > 1
    return Place(time, group, 0.0 if is_prebuilt else clearance)


def _judged(scene: Scene) -> Expectation:
    """Return the expectation by exact statics."""
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
    """Return the time [s] of the removal after which a scene first falls; 0 if a placed brick makes the scene fall."""
    for index, action in enumerate(scene.actions):
        if isinstance(action, Remove):
            before, after = (replace(scene, actions=scene.actions[:end]) for end in (index, index + 1))
            if first_fall(before) is None and first_fall(after) is not None:
                return action.time
    return 0.0


def _is_planar(brick: Brick) -> bool:
    _, i, _, k = brick.quaternion
    return brick.position[1] == 0.0 and i == 0.0 and k == 0.0
