"""Reader of a user's own scene in a TOML file: see ``scenarios.scenes.from_file`` for the fields."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from scenarios.lookup import look_up
from scenarios.model import Pull, Push, Remove, World
from scenarios.parameters import Real
from scenarios.planks import MU
from scenarios.scenes.shared.brick_tables import (
    LARGEST,
    read_brick,
    read_fixed_body,
    read_number,
    read_numbers,
    read_tables,
)
from scenarios.scenes.shared.own_content import WATCH_S, OwnContent, levelled, set_down

FIELDS = ("name", "friction", "gravity", "watch_s", "brick", "fixed", "push", "pull")
MOST = 5000
"""Greatest number of bricks, and of fixed bodies, in a file."""
MOST_ACTIONS = 1000
"""Greatest number of pushes, and of pulls, in a file."""
MOST_WATCH_S = 100 * 3600.0
"""Greatest duration [s] of the trial after the last action."""
FASTEST = 100.0
"""Greatest component of the velocity of a pull [m/s]."""
STRONGEST = 1e6
"""Greatest component of an impulse [N s]."""
MOST_GRAVITY = 1000.0
"""Greatest component of gravity [m/s2]."""

_Laid: TypeAlias = Sequence[tuple[float, int, Mapping[str, Any]]]


def read_toml(text: str) -> OwnContent:
    """Return the content of a TOML file.

    Raises:
        ValueError: if the text is not valid TOML, a field is missing or out of range, bricks overlap, or a brick
            floats; the message names the fix.
        UnknownNameError: if a field does not exist.
    """
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not valid TOML: {error}; correct the file at this place") from error
    for field in content:
        look_up("field", field, dict.fromkeys(FIELDS))
    tables = read_tables(content, "brick", least=1, most=MOST)
    fixed = tuple(
        read_fixed_body(f"fixed[{n}]", one) for n, one in enumerate(read_tables(content, "fixed", least=0, most=MOST))
    )
    laid = sorted(
        (
            (read_number(f"brick[{n}].time", table.get("time"), 0, LARGEST, "s"), n, table)
            for n, table in enumerate(tables)
        ),
        key=lambda entry: entry[:2],
    )
    times, names = [time for time, _, _ in laid], [f"brick[{n}]" for _, n, _ in laid]
    bricks = set_down([read_brick(f"brick[{n}]", one) for _, n, one in laid], times, fixed)
    world = World(friction=Real(0, 10).check("friction", content.get("friction", MU)), fixed=fixed)
    if "gravity" in content:
        x, y, z = read_numbers("gravity", content["gravity"], 3, -MOST_GRAVITY, MOST_GRAVITY, "m/s2")
        world = replace(world, gravity=(x, y, z))
    return OwnContent(
        world,
        levelled(bricks, times, names, fixed),
        tuple(times),
        (*_removals(laid), *_pushes(content, laid), *_pulls(content, laid)),
        Real(WATCH_S, MOST_WATCH_S, "s").check("watch_s", content.get("watch_s", WATCH_S)),
        _name(content.get("name", "")),
    )


def _name(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"name must be a text, got {value!r}: write the name in quotes")
    return value


def _removals(laid: _Laid) -> Iterator[Remove]:
    for index, (time, n, table) in enumerate(laid):
        if "removed" in table:
            removed = read_number(f"brick[{n}].removed", table["removed"], 0, LARGEST, "s")
            if removed <= time:
                raise ValueError(
                    f"brick[{n}].removed must be later than brick[{n}].time, which is {time:g} s, got {removed:g} s: "
                    "give a later time"
                )
            yield Remove(removed, index)


def _pushes(content: Mapping[str, Any], laid: _Laid) -> Iterator[Push]:
    for n, table in enumerate(read_tables(content, "push", least=0, most=MOST_ACTIONS)):
        time, brick = _handled(f"push[{n}]", table, ("impulse",), laid)
        x, y, z = read_numbers(f"push[{n}].impulse", table.get("impulse"), 3, -STRONGEST, STRONGEST, "N s")
        yield Push(time, brick, (x, y, z))


def _pulls(content: Mapping[str, Any], laid: _Laid) -> Iterator[Pull]:
    for n, table in enumerate(read_tables(content, "pull", least=0, most=MOST_ACTIONS)):
        time, brick = _handled(f"pull[{n}]", table, ("velocity", "seconds", "carried"), laid)
        x, y = read_numbers(f"pull[{n}].velocity", table.get("velocity"), 2, -FASTEST, FASTEST, "m/s")
        seconds = read_number(f"pull[{n}].seconds", table.get("seconds"), 1e-3, LARGEST, "s")
        is_carried = table.get("carried", False)
        if not isinstance(is_carried, bool):
            raise ValueError(
                f"pull[{n}].carried must be true or false, got {is_carried!r}: write true or false, without quotes"
            )
        yield Pull(time, brick, (x, y), seconds, is_carried)


def _handled(name: str, table: Mapping[str, Any], fields: Sequence[str], laid: _Laid) -> tuple[float, int]:
    """Return the time [s] of an action, and the index of its brick in the order of placement, from 0."""
    for field in table:
        look_up(f"field of {name}", field, dict.fromkeys(("brick", "time", *fields)))
    number = read_number(f"{name}.brick", table.get("brick"), 0, len(laid) - 1)
    time = read_number(f"{name}.time", table.get("time"), 0, LARGEST, "s")
    places = [index for index, (_, n, _) in enumerate(laid) if n == number]
    if not places:
        raise ValueError(
            f"{name}.brick must be the number of a [[brick]] of the file, got {number:g}: give a whole number from 0 "
            f"to {len(laid) - 1}"
        )
    placed, _, of_brick = laid[places[0]]
    removed = of_brick.get("removed", float("inf"))
    if not placed < time < removed:
        before = f", and before brick[{number:g}].removed, which is {removed:g} s" if "removed" in of_brick else ""
        raise ValueError(
            f"{name}.time must be after brick[{number:g}].time, which is {placed:g} s{before}, got {time:g} s: give a "
            f"time {'between both times' if before else 'after the placement'}"
        )
    return time, places[0]
