"""A compiled MuJoCo model, with methods that add, remove and freeze bricks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from adapters.profile import KnobValue, Profile
from adapters.shared.vectors import half_edges, rotate
from scenarios.model import UPRIGHT, Brick, Quaternion, Vector, World
from scenarios.shapes import Polyhedron
from scenarios.solids import moments_of
from stability_core.port import FloatArray
from stability_core.ports import mujoco_calls
from stability_core.ports.mujoco_ghosts import FreeBody
from stability_core.ports.mujoco_release import HAS_SLEEP, SLEEP_ALLOWED, SLEEP_NEVER, detection_attributes

CONTACT_STEPS = "contact_steps"
"""Knob for the time constant of contacts [steps]. MuJoCo's ``solref`` has this constant in seconds."""

_COLLIDES = 'contype="1" conaffinity="1"'
HEAVY = 1e3
"""Mass [kg] of a moved body. The body is a heavy free body, because MuJoCo's mocap bodies have no velocity in contacts.
With 1e6 kg a tower of planks on the body sank at one step per frame. The adapter sets the body's pose before each step,
so that no load shifts the body."""

_STILL, _LIVE, _MOVED = (np.array(masks)[:, None] for masks in ((1, 1), (3, 1), (0, 2)))
"""Collision masks (``contype``, ``conaffinity``) of a ghost, a live brick and a moved body, for one geom.

Two geoms collide if the type of one geom and the affinity of the other share a bit. Therefore moved bodies collide with
live bricks only."""


def pattern_of(brick: Brick) -> Brick:
    """Return the pattern of the slots that fit a brick: shape and material of the brick, and the mass of the slot."""
    mass = HEAVY if brick.moved else brick.mass
    return replace(brick, mass=mass, position=(0.0, 0.0, 0.0), quaternion=UPRIGHT, level=1, moved=False)


class SlotModel:
    """Compiled model of the ground, a slot per pattern, the fixed bodies and, with ``ghosts``, a ghost per slot.

    A slot is a free body, parked until ``unpark``. A ghost is a mocap body with the same shape, and no force moves a
    mocap body. MuJoCo's geom and body ids coincide: 0 is the ground, followed by slots, their ghosts and the fixed
    bodies.
    """

    def __init__(
        self, patterns: Sequence[Brick], world: World, profile: Profile, *, ghosts: bool, welds: int = 0
    ) -> None:
        self.slots = len(patterns)
        self.welds = welds
        self.first_fixed = 1 + self.slots * (2 if ghosts else 1)
        self.geoms = self.first_fixed + len(world.fixed)
        self.has_ghosts = ghosts
        self.model = mujoco.MjModel.from_xml_string(_mjcf(patterns, world, profile, ghosts=ghosts, welds=welds))
        self.data = mujoco.MjData(self.model)
        # Views of MuJoCo's memory, one row per slot.
        self.poses: FloatArray = self.data.qpos.reshape(-1, 7)
        self.velocities: FloatArray = self.data.qvel.reshape(-1, 6)
        self._warm_starts: FloatArray = self.data.qacc_warmstart.reshape(-1, 6)
        self._bodies = [
            FreeBody(self.model, self.data, 1 + slot, 1 + self.slots + slot if ghosts else None)
            for slot in range(self.slots)
        ]
        light = [1 + slot for slot, pattern in enumerate(patterns) if pattern.mass < HEAVY]
        if len(light) < self.slots and light:  # mean inertia scales the solver's tolerance: exclude heavy bodies
            inertia = self.model.body_inertia[light].mean()
            self.model.stat.meaninertia = (self.model.body_mass[light].mean() + inertia) / 2
        self._knobs = profile.values
        self._live_policy = SLEEP_ALLOWED if "sleep" in profile.knobs else SLEEP_NEVER

    def read_knobs(self) -> dict[str, KnobValue]:
        """Return the present values of the numeric options, and the time constant of contacts in steps."""
        options = {name: name.removeprefix("option.") for name in self._knobs if name.startswith("option.")}
        read: dict[str, KnobValue] = {
            name: float(getattr(self.model.opt, option))
            for name, option in options.items()
            if not isinstance(self._knobs[name], str)
        }
        if CONTACT_STEPS in self._knobs:
            read[CONTACT_STEPS] = float(self.model.geom_solref[-1, 0] / self.model.opt.timestep)
        return read

    def copy_state(self, smaller: SlotModel) -> None:
        """Copy the poses, velocities and warm starts of a model with at most as many slots into the first slots."""
        self.poses[: smaller.slots] = smaller.poses
        self.velocities[: smaller.slots] = smaller.velocities
        self._warm_starts[: smaller.slots] = smaller._warm_starts

    def copy_welds(self, smaller: SlotModel) -> None:
        """Copy the welds of a model with at most as many welds into the first welds."""
        for name in ("eq_obj1id", "eq_obj2id", "eq_data"):
            getattr(self.model, name)[: smaller.welds] = getattr(smaller.model, name)
        self.data.eq_active[: smaller.welds] = smaller.data.eq_active

    def set_pose(self, slot: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a brick ([m], quaternion w, x, y, z), at rest."""
        self.poses[slot, :3] = position
        self.poses[slot, 3:] = quaternion
        self._bodies[slot].stop()

    def set_motion(
        self, slot: int, position: FloatArray, quaternion: FloatArray, linear: Vector, angular: Vector
    ) -> None:
        """Set the pose of a brick and its velocities [m/s], [rad/s], in the world's frame."""
        self.poses[slot, :3], self.poses[slot, 3:] = position, quaternion
        self.velocities[slot, :3] = linear
        inverse = self.poses[slot : slot + 1, 3:] * (1, -1, -1, -1)
        self.velocities[slot, 3:] = rotate(inverse, np.array([angular]))[0]

    def unpark(self, slot: int) -> None:
        """Activate the parked brick of a slot: collisions, weight, and sleeping if the profile has the knob "sleep"."""
        self._bodies[slot].collide(*_LIVE)
        self._bodies[slot].unpark(0.0, self._live_policy)

    def unpark_moved(self, slot: int) -> None:
        """Activate the parked body of a slot as a moved body: no weight, and collisions with live bricks only."""
        self._bodies[slot].collide(*_MOVED)
        self._bodies[slot].unpark(1.0, SLEEP_NEVER)

    def park(self, slot: int) -> None:
        """Deactivate a brick: no collisions, no weight and, from MuJoCo 3.4 on, asleep, so that it costs no time."""
        self._bodies[slot].park()

    def wake(self, slot: int) -> None:
        """Wake a brick, and the island in which the brick sleeps, from the engine's own sleep."""
        self._bodies[slot].wake()

    def show_ghost(self, slot: int) -> None:
        """Place the ghost at the brick's pose, and make the ghost collide."""
        self._bodies[slot].show_ghost(*_STILL)

    def hide_ghost(self, slot: int) -> None:
        """Stop the ghost's collisions, and place the brick exactly at the ghost's pose."""
        self._bodies[slot].return_from_ghost()
        self._bodies[slot].hide_ghost()

    def join(self, weld: int, first: int, second: int) -> None:
        """Let a weld hold the bricks of two slots in their present relative pose.

        The anchor is the centre of the second brick. MuJoCo's frames of bodies are at the centres of mass.
        """
        model, (pose, other) = self.model, self.poses[[first, second]]
        inverse = pose[3:] * (1, -1, -1, -1)
        turn = np.empty(4)
        mujoco.mju_mulQuat(turn, inverse, other[3:])
        model.eq_obj1id[weld], model.eq_obj2id[weld] = 1 + first, 1 + second
        model.eq_data[weld, :3] = 0.0
        model.eq_data[weld, 3:6] = rotate(inverse[None], (other[:3] - pose[:3])[None])[0]
        model.eq_data[weld, 6:10] = turn
        self.data.eq_active[weld] = 1

    def part(self, weld: int) -> None:
        """Let a weld hold nothing."""
        self.data.eq_active[weld] = 0

    def collided_copy(self) -> mujoco.MjData:
        """Return a copy of the state with the contacts at the present poses."""
        return mujoco_calls.collided_copy(self.model, self.data)


def _mjcf(patterns: Sequence[Brick], world: World, profile: Profile, *, ghosts: bool, welds: int) -> str:
    """Return the world as MuJoCo's XML.

    A knob ``element.attribute`` sets an attribute of the element ``option``, ``flag`` or ``geom``.
    """
    timestep = profile.frame_s / profile.substeps
    settings: dict[str, dict[str, object]] = {
        "option": {"timestep": timestep, "gravity": _numbers(world.gravity)},
        "flag": {"sleep": "enable"}
        if HAS_SLEEP
        else {},  # parked bricks sleep in every profile, live bricks by their sleep policy
        "geom": {"friction": world.friction, "contype": 0, "conaffinity": 0},
    }
    if CONTACT_STEPS in profile.knobs:
        settings["geom"]["solref"] = _numbers((float(profile.knobs[CONTACT_STEPS].value) * timestep, 1))
    for name, knob in profile.knobs.items():
        element, _, attribute = name.partition(".")
        if name == "geom.gap":
            settings[element] |= detection_attributes(float(knob.value))
        elif attribute:
            settings[element][attribute] = knob.value
    option, flag, geom = (
        " ".join(f'{name}="{value}"' for name, value in settings[element].items())
        for element in ("option", "flag", "geom")
    )
    meshes = dict.fromkeys(brick.shape for brick in (*patterns, *world.fixed) if isinstance(brick.shape, Polyhedron))
    names = {mesh: f"mesh{number}" for number, mesh in enumerate(meshes)}
    bodies = [_inertial(pattern) + _geom(pattern, names) for pattern in patterns]
    asleep = 'sleep="init"' if HAS_SLEEP else ""
    fixed = [
        f'<body pos="{_numbers(body.position)}" quat="{_numbers(body.quaternion)}">'
        f"{_geom(replace(body, mass=1.0), names, _COLLIDES)}</body>"
        for body in world.fixed
    ]
    return f"""
        <mujoco>
            <option {option}><flag {flag}/></option>
            <default><geom {geom}/></default>
            {_assets(names)}
            <worldbody>
                <geom type="plane" size="0 0 1" {_COLLIDES}/>
                {
        "".join(
            f'<body name="slot {slot}" {asleep} gravcomp="1"><freejoint/>{body}</body>'
            for slot, body in enumerate(bodies)
        )
    }
                {"".join(f'<body mocap="true">{body}</body>' for body in bodies) if ghosts else ""}
                {"".join(fixed)}
            </worldbody>
            <equality>{_idle_weld(timestep) * welds}</equality>
        </mujoco>"""


def _idle_weld(timestep: float) -> str:
    """Return the XML of a stiff weld that holds nothing until ``SlotModel.join`` assigns both bodies.

    The weld is stiff, because an overhanging plank tilted by 1.6 deg with the shipped stiffness. The XML names slot 0,
    because a weld must name a body.
    """
    stiff = f'solref="{2 * timestep!r} 1" solimp="0.9999 0.9999 0.001"'
    return f'<weld body1="slot 0" active="false" {stiff}/>'


def _assets(names: Mapping[Polyhedron, str]) -> str:
    meshes = (f'<mesh name="{name}" vertex="{_numbers(mesh.array.ravel())}"/>' for mesh, name in names.items())
    return f"<asset>{''.join(meshes)}</asset>" if names else ""


def _geom(brick: Brick, names: Mapping[Polyhedron, str], attributes: str = "") -> str:
    if isinstance(brick.shape, Polyhedron):
        return f'<geom type="mesh" mesh="{names[brick.shape]}" mass="{brick.mass!r}" {attributes}/>'
    x, y, z = half_edges(brick.size)
    sizes = {"box": (x, y, z), "cylinder": (x, z), "capsule": (x, z - x), "sphere": (x,)}[brick.shape]
    return f'<geom type="{brick.shape}" size="{_numbers(sizes)}" mass="{brick.mass!r}" {attributes}/>'


def _inertial(brick: Brick) -> str:
    """Return the inertia of a mesh, or of given moments, because MuJoCo would compute an inexact inertia."""
    if brick.moments is None and not isinstance(brick.shape, Polyhedron):
        return ""
    return f'<inertial pos="0 0 0" mass="{brick.mass!r}" diaginertia="{_numbers(moments_of(brick))}"/>'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
