"""Scenarios: the decorator ``scenario`` or ``dynamic_scenario`` turns a builder into a scenario.

    @scenario
    def plank_tower(*, levels: Annotated[int, Whole(1, 500)] = 26) -> Plan: ...

- The builder's name is the scenario's id.
- The builder's signature gives the parameters with their defaults and ranges.
- The first line of the builder's docstring is the description of the scene.

A call of the scenario checks the values that have a range, calls the builder, and adds ids and parameters to the
returned plan.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, ParamSpec, get_type_hints

from scenarios.model import Action, Expectation, MustMove, Place, Scene, World
from scenarios.parameters import Choice, Range, Real, Value, variant_of

ONE_BY_ONE, AT_ONCE, AT_ONCE_BELOW = BUILT = ("one_by_one", "at_once", "at_once_below")
"""Ways to build a scene of statics: see ``scenarios.scenes.shared.prebuilt``."""
SIZE = Real(0.01, 1000.0)
"""Range of the factor on all lengths of a scene of statics: planks from 1.17 mm to 117 m long."""
OF_STATICS: Mapping[str, tuple[Value, Range]] = {"built": (ONE_BY_ONE, Choice(*BUILT)), "size": (1.0, SIZE)}
"""Defaults and ranges of the parameters that all scenes of statics share."""

P = ParamSpec("P")


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A scene without ids and parameters: the return value of a builder. ``Scene`` describes the fields."""

    world: World
    actions: tuple[Action, ...]
    expectation: Expectation
    look_for: str
    partner: Mapping[str, Value] | None = None
    """Values of the parameters in which the two scenes of a pair differ. The variant with these values gives the pair
    its id, ``Scene.pair``. None if the scene has no partner."""
    planar: bool = False
    poured: bool = False
    watch_s: float = 5.0
    must_move: tuple[MustMove, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scenario(Generic[P]):
    """A family of scenes that differ in their parameters. A call with keyword arguments builds a scene."""

    builder: Callable[P, Plan | Scene]
    """Function that returns the plan of a scene. A builder that returns a ``Scene`` sets the ids itself."""
    defaults: Mapping[str, Value]
    """Defaults of the builder's own parameters, in the order of their declaration."""
    declared: Mapping[str, Range]
    """Ranges that the builder declares, by the names of their parameters. The builder itself checks parameters without
    a range."""
    is_static: bool = True
    """True if the scenario has the parameters ``built`` and ``size``, which prebuild and resize its scenes. The scenes
    of this kind only place and remove bricks, and do not pour, push or drop bricks."""

    @property
    def name(self) -> str:
        """Return the id of the scenario."""
        return self.builder.__name__

    @property
    def description(self) -> str:
        """Return the description of the scene, in one line."""
        return (inspect.getdoc(self.builder) or "").partition("\n")[0]

    @property
    def parameters(self) -> Mapping[str, Value]:
        """Return the defaults of all parameters, by name."""
        return {**self.defaults, **{name: default for name, (default, _) in self._shared().items()}}

    @property
    def ranges(self) -> Mapping[str, Range]:
        """Return the ranges of all parameters that have a range, by name."""
        return {**self.declared, **{name: allowed for name, (_, allowed) in self._shared().items()}}

    def variant(self, parameters: Mapping[str, Value]) -> str:
        """Return the id of the variant with the values ``parameters`` of the builder's own parameters."""
        return variant_of(self.name, self.defaults, parameters)

    def __call__(self, *args: P.args, **parameters: P.kwargs) -> Scene:
        """Build the scene with ``parameters``; missing parameters take their defaults.

        Raises:
            TypeError: if the builder has no parameter with a given name.
            ValueError: if a value is not allowed, or a brick of a planar scene leaves the x-z plane; the message names
                the allowed values or the fix.
        """
        checked: dict[str, Any] = {**self.defaults, **parameters}
        for name, allowed in self.declared.items():
            checked[name] = allowed.check(name, checked[name])
        planned = self.builder(*args, **checked)
        if isinstance(planned, Scene):
            return planned
        if planned.planar:
            _check_planar(planned)
        return Scene(
            scenario=self.name,
            variant=self.variant(checked),
            parameters=checked,
            world=planned.world,
            actions=planned.actions,
            expectation=planned.expectation,
            look_for=planned.look_for,
            pair="" if planned.partner is None else self.variant({**checked, **planned.partner}),
            planar=planned.planar,
            poured=planned.poured,
            watch_s=planned.watch_s,
            must_move=planned.must_move,
        )

    def _shared(self) -> Mapping[str, tuple[Value, Range]]:
        return OF_STATICS if self.is_static else {}


def _check_planar(planned: Plan) -> None:
    """Raise ``ValueError`` if a brick of a planar scene leaves the x-z plane, or turns about another axis than y."""
    for action in planned.actions:
        for brick in action.bricks if isinstance(action, Place) else ():
            _, i, _, k = brick.quaternion
            if brick.position[1] != 0.0 or i != 0.0 or k != 0.0:
                raise ValueError(
                    f"planar=True, but a brick at {brick.position} m with quaternion {brick.quaternion} leaves the x-z "
                    "plane: set y = 0 and turn bricks about y only, or leave planar out"
                )


def scenario(builder: Callable[P, Plan | Scene]) -> Scenario[P]:
    """Make a scenario of statics from a builder whose scenes only place and remove bricks."""
    return _scenario(builder, is_static=True)


def dynamic_scenario(builder: Callable[P, Plan | Scene]) -> Scenario[P]:
    """Make a scenario of dynamics from a builder whose scenes do not only place and remove bricks."""
    return _scenario(builder, is_static=False)


def _scenario(builder: Callable[P, Plan | Scene], *, is_static: bool) -> Scenario[P]:
    defaults = {name: parameter.default for name, parameter in inspect.signature(builder).parameters.items()}
    hints = get_type_hints(builder, include_extras=True)
    declared = {name: hints[name].__metadata__[0] for name in defaults if hasattr(hints[name], "__metadata__")}
    return Scenario(builder, defaults, declared, is_static)
