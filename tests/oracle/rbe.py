"""Piles judged by other people's code: the rigid block equilibrium (RBE) of `compas_cra`, kept as a fixture.

    uv run --group oracle python -m tests.oracle.rbe

writes ``tests/fixtures/rbe.json``, which the tests read; `compas_cra` itself they do not need.

RBE (Kao et al., "Coupled Rigid-Block Analysis", 2022, Eq. 6) finds, by an interior-point solver, the forces that hold
all blocks with the least tension at their contacts; a pile stands if it needs none. Its friction pyramid has eight
sides and is circumscribed about Coulomb's cone: what it refuses must fall, and what it accepts must stand with friction
1 / cos(22.5 deg) times as high.
"""

from __future__ import annotations

import contextlib
import importlib.metadata
import io
import json
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.model import Brick, Pull, Remove, Scene
from scenarios.planks import LENGTH, MASS
from scenarios.registry import build
from scenarios.scenes.support_removal import STACKS
from scenarios.statics.contact_patch import GROUND, contact_patches
from tests.stability_core.piles import Pile, laden_pair, leaned_on_tower, level_pile

FIXTURE = Path(__file__).parents[1] / "fixtures" / "rbe.json"
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "four_stack of 3 levels": ("four_stack", {"levels": 3}),
    "leaning tower of 8": ("leaning_tower", {"levels": 8}),
    "leaning tower of 9": ("leaning_tower", {"levels": 9}),
    "inverted V at mu = 0.45": ("card_house", {"storeys": 1}),
    "inverted V at mu = 0.16": ("card_house", {"storeys": 1, "friction": 0.16}),
    "inverted V at mu = 0.1": ("card_house", {"storeys": 1, "friction": 0.1}),
    "card house of 2 storeys at mu = 0.45": ("card_house", {"storeys": 2}),
    "card house of 2 storeys at mu = 0.15": ("card_house", {"storeys": 2, "friction": 0.15}),
    "card house of 3 storeys at mu = 0.45": ("card_house", {"storeys": 3}),
    "card house of 3 storeys at mu = 0.18": ("card_house", {"storeys": 3, "friction": 0.18}),
}
ROBBED = [stack for stack in STACKS if stack != "two_blocks"]
"""Of two blocks the upper one is left without any contact, which the library does not take."""
FAMILIES: tuple[tuple[str, dict[str, Any]], ...] = (
    *(("harmonic_overhang", {"bricks": n, "margin": margin}) for n in (3, 5) for margin in (0.15, -0.15)),
    *(("cantilever", {"margin": margin, "scale": 1.0}) for margin in (0.05, -0.05)),
    *(("cantilever", {"taken": taken, "scale": 1.0}) for taken in ("load", "counterweight")),
    *(("table", {"legs": n, "margin": margin, "scale": 1.0}) for n in (2, 3, 4) for margin in (0.05, -0.05)),
    *(("branches", {"columns": n, "margin": margin, "scale": 1.0}) for n in (2, 3, 4) for margin in (0.05, -0.05)),
    *(("plank_bridge", {"margin": margin, "scale": 1.0}) for margin in (0.05, -0.05)),
    *(("corbelled_arch", {"courses": n, "margin": margin}) for n in (4, 5) for margin in (0.1, -0.1)),
    *(("jenga", {"left": left}) for left in ("middle", "side")),
    *(("jenga", {"left": left, "levels": 8, "robbed": 3, "speed": 0.1}) for left in ("middle", "side")),
    *(("robbed_stack", {"stack": stack, "taken": taken}) for stack in ROBBED for taken in ("load", "support")),
    *(("random_tower", {"draw": draw, "levels": n}) for draw, n in ((5, 4), (5, 5), (12, 5), (12, 6), (3, 7), (3, 8))),
    *(("random_tower", {"draw": draw, "levels": n}) for draw, n in ((33, 7), (33, 8), (53, 5), (53, 6))),
    ("brick_wall", {"courses": 5, "width": 2}),
    ("pyramid", {}),
    ("log_cabin", {}),
)
"""Scenes of the study `truth`, one pair or more of each family that tips, as small as statics lets them be: no answer
of statics depends on the size. They are solved as they are at the end, and those that are robbed as they are built."""
SOLIDS: tuple[tuple[str, dict[str, Any]], ...] = (
    *(
        ("leaning_drums", {"shape": s, "drums": n, "margin": m})
        for s in ("cylinder", "hexagon")
        for n in (3, 4)
        for m in (0.2, -0.2)
    ),
    *(("voussoir_arch", {"voussoirs": n, "margin": margin}) for n in (5, 7, 9) for margin in (0.25, -0.25)),
    *(("voussoir_arch", {"margin": 0.5, "friction": friction}) for friction in (0.6, 0.2)),
    *(("dome_ring", {"stones": n, "ring": ring}) for n in (6, 8) for ring in ("whole", "open")),
    *(("log_pile", {"rows": n, "stops": stops}) for n in (2, 3) for stops in ("both", "none")),
    *(("ball_pyramid", {"margin": margin}) for margin in (0.4, -0.4)),
    *(("groove", {"body": body, "margin": margin}) for body in ("wedge", "cylinder") for margin in (0.35, -0.35)),
)
"""Scenes whose bodies are no boxes, two or more of each family: scenes of the study `truth`, and scenes without a known
answer, of which only the existence of forces is compared."""
RANDOM = {"level": partial(level_pile, widest=0.12), "leaning": leaned_on_tower, "roofed": laden_pair}
SEEDS = range(16)


def at_the_end(scene: Scene) -> tuple[Brick, ...]:
    """The bricks that nobody took away or pulled out."""
    taken = {action.brick for action in scene.actions if isinstance(action, Remove | Pull)}
    return tuple(brick for index, brick in enumerate(scene.bricks) if index not in taken)


def of_scene(bricks: tuple[Brick, ...], friction: float, walls: tuple[Brick, ...] = ()) -> dict[str, Any]:
    """A scene's bricks with their ideal contacts."""
    return {
        "friction": friction,
        "mass": [brick.mass for brick in bricks],
        "center": [list(brick.position) for brick in bricks],
        "contacts": [
            [patch.first, patch.second, point.round(9).tolist(), patch.normal.tolist()]
            for patch in contact_patches(bricks, walls)
            for point in patch.points
        ],
    }


def of_solids(scene: Scene) -> dict[str, Any]:
    """A scene's final bricks in the size and weight of planks, because the solver's tolerances are absolute."""
    bricks = at_the_end(scene)
    length = LENGTH / float(np.mean([max(brick.size) for brick in bricks]))
    heavier = MASS / float(np.mean([brick.mass for brick in bricks]))
    problem = of_scene(bricks, scene.world.friction, scene.world.fixed)
    return {
        "friction": problem["friction"],
        "mass": [heavier * mass for mass in problem["mass"]],
        "center": (length * np.array(problem["center"])).tolist(),
        "contacts": [
            [first, second, (length * np.array(point)).round(9).tolist(), normal]
            for first, second, point, normal in problem["contacts"]
        ],
    }


def of_pile(pile: Pile) -> dict[str, Any]:
    """A random pile."""
    contacts, masses = pile.world(np.eye(3))
    point, normal = contacts.point.round(9).tolist(), contacts.normal.tolist()
    return {
        "friction": pile.friction,
        "mass": masses.mass.tolist(),
        "center": masses.center_of_mass.round(9).tolist(),
        "contacts": list(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), point, normal, strict=True)),
    }


def solved(problem: dict[str, Any]) -> dict[str, Any]:
    """The problem with what RBE says: the force on the second body at each contact [N], and the largest tension.

    The tension is in weights of a standard plank; None, as are the forces, if no tension could hold the pile. The
    solver gets planks of unit length and weight, as its tolerances are absolute.
    """
    from compas.geometry import Box, Frame
    from compas_assembly.datastructures import Block
    from compas_cra.datastructures import CRA_Assembly
    from compas_cra.equilibrium import rbe_solve

    assembly = CRA_Assembly()
    side = 0.05
    ground = len(problem["mass"])
    for mass, center in zip([*problem["mass"], MASS], [*problem["center"], [0.0, 0.0, 0.0]], strict=True):
        box = Box(side, side, side, Frame([x / LENGTH for x in center], [1, 0, 0], [0, 1, 0]))
        block = Block.from_shape(box)
        block.attributes["density"] = mass / MASS / side**3
        assembly.add_block(block)
    assembly.set_boundary_condition(ground)
    bodies = []
    for first, second, point, normal in problem["contacts"]:
        aside = np.eye(3)[np.abs(normal).argmin()]
        across = np.cross(aside, normal)
        frame = Frame([x / LENGTH for x in point], across.tolist(), np.cross(normal, across).tolist())
        bodies.append(tuple(ground if body == GROUND else body for body in (first, second)))
        assembly.add_to_interfaces(*bodies[-1], 0.01, [[x / LENGTH for x in point]], frame)
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # the library prints as it goes
            rbe_solve(assembly, mu=problem["friction"])
    except ValueError as error:
        if "infeasible" not in str(error):
            raise
        return {**problem, "forces": None, "tension": None}
    turn = dict.fromkeys(bodies, 0)
    forces, tension = [], 0.0
    for pair in bodies:
        interface = assembly.graph.edge_attribute(pair, "interfaces")[turn[pair]]
        turn[pair] += 1
        parts, frame = interface.forces[0], interface.frame
        axes = np.array([frame.zaxis, frame.xaxis, frame.yaxis], float)
        pressed = np.array([parts["c_np"] - parts["c_nn"], parts["c_u"], parts["c_v"]])
        forces.append((MASS * 9.81 * pressed @ axes).round(9).tolist())
        tension = max(tension, parts["c_nn"])
    return {**problem, "forces": forces, "tension": tension}


def main() -> None:
    """Solve all problems and write them down."""
    problems = {}
    for name, (scenario, parameters) in SCENES.items():
        scene = build(scenario, **parameters)
        problems[name] = of_scene(scene.bricks, scene.world.friction)
    for scenario, parameters in FAMILIES:
        scene = build(scenario, **parameters)
        left = at_the_end(scene)
        stands = {"stands": scene.expectation.outcome == "stand"}
        problems[f"{scene.variant} at the end"] = stands | of_scene(left, scene.world.friction)
        if len(left) < len(scene.bricks):
            problems[f"{scene.variant} as built"] = {"stands": True} | of_scene(scene.bricks, scene.world.friction)
    for kind, make in RANDOM.items():
        for seed in SEEDS:
            problems[f"{kind} pile {seed}"] = of_pile(make(np.random.default_rng([7, seed])))
    for scenario, parameters in SOLIDS:
        scene = build(scenario, **parameters)
        stands = {"stands": scene.expectation.outcome == "stand"}
        problem = of_solids(scene)
        problems[f"{scene.variant} at the end"] = stands | problem
    cases = {}
    for name, problem in problems.items():
        cases[name] = solved(problem)
        sys.stderr.write(f"{name}: tension {cases[name]['tension']}\n")
    by = f"compas_cra {importlib.metadata.version('compas_cra')}, rbe_solve"
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(case)}" for name, case in cases.items())
    FIXTURE.parent.mkdir(exist_ok=True)
    FIXTURE.write_text(f'{{"by": {json.dumps(by)}, "cases": {{\n{lines}\n}}}}\n', encoding="utf-8")


if __name__ == "__main__":
    main()
