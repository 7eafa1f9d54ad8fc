"""Conversion of a recording to an animated glTF 2.0 file (GLB), for viewers and 3-D programs.

Each brick is a node with an animated pose. The node has a child mesh for each state of the brick. The animation shows
one of these meshes at a time, and scales all other meshes to 0. The mesh of a box is a unit cube, whose scale is the
size of the brick. Other shapes have meshes in metres. Fixed bodies are static nodes. The root node turns the z axis
into the y axis, because the y axis of glTF points up.
"""

from __future__ import annotations

import json
import math
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.records.recording import LENGTH_STEP, QUATERNION_STEP, STATES, Recording
from scenarios.model import Brick, Vector
from scenarios.shapes import Shape
from scenarios.surfaces import surface_of

COLOURS = {"live": (0.74, 0.35, 0.03), "frozen": (0.10, 0.35, 0.58)}
"""Colours by state: linear red, green and blue from 0 to 1. The animation does not show removed bricks."""
_FIXED = "fixed"
_MATERIALS = {**COLOURS, _FIXED: (0.30, 0.32, 0.34)}
"""Colours by state, and the colour of fixed bodies."""
_FLOAT, _SHORT = 5126, 5123
"""Component types of glTF."""
_VERTICES, _INDICES = 34962, 34963
"""Targets of buffer views of glTF."""
_JSON, _BINARY = 0x4E4F534A, 0x004E4942
"""Types of chunks of GLB."""
_ALIGNMENT = 4
"""Alignment of arrays and chunks [bytes]."""


class _Buffer:
    """The binary buffer of the file, with a view and an accessor for each array."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: npt.NDArray[Any], kind: str, target: int | None = None) -> int:
        """Append an array and return the index of its accessor.

        Args:
            values: the array, shape (n,) or (n, k).
            kind: type of the accessor: SCALAR, VEC3 or VEC4.
            target: target of the buffer view; None for animation data.
        """
        self.content += bytes(-len(self.content) % _ALIGNMENT)
        view = {"buffer": 0, "byteOffset": len(self.content), "byteLength": values.nbytes}
        self.content += values.tobytes()
        self.views.append(view if target is None else {**view, "target": target})
        accessor = {
            "bufferView": len(self.views) - 1,
            "componentType": _SHORT if values.dtype == np.uint16 else _FLOAT,
            "count": len(values),
            "type": kind,
            "min": np.atleast_1d(values.min(axis=0)).tolist(),
            "max": np.atleast_1d(values.max(axis=0)).tolist(),
        }
        self.accessors.append(accessor)
        return len(self.accessors) - 1


class _Meshes:
    """The meshes of the file: a unit cube of each material, and a mesh for each other shape and material in use."""

    def __init__(self, buffer: _Buffer) -> None:
        self._buffer = buffer
        self.all = _boxes(buffer)
        self._others: dict[tuple[Shape, Vector, str], int] = {}

    def of(self, shape: Shape, size: Vector, material: str) -> tuple[int, Vector]:
        """Return the index of a mesh, and the scale at which it shows a brick of this shape and size [m]."""
        if shape == "box":
            return list(_MATERIALS).index(material), size
        key = shape, size, material
        if key not in self._others:
            self._others[key] = len(self.all)
            self.all.append(_surface(self._buffer, shape, size, material))
        return self._others[key], (1.0, 1.0, 1.0)


def to_glb(recording: Recording) -> bytes:
    """Return the content of the GLB file of a recording."""
    buffer = _Buffer()
    meshes = _Meshes(buffer)
    turn = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]  # by -90 degrees about x, so that z points up
    nodes: list[dict[str, Any]] = [{"name": "stack", "rotation": turn, "children": []}]
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []

    def animate(node: int, path: str, times: int, values: int, how: str) -> None:
        samplers.append({"input": times, "output": values, "interpolation": how})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})

    for box in recording.fixed:
        nodes[0]["children"].append(len(nodes))
        nodes.append(_fixed_node(box, meshes))
    starts = np.flatnonzero(np.diff(recording.body, prepend=-1))
    for rows in np.split(np.arange(len(recording.body)), starts[1:]) if len(starts) else ():
        body = int(recording.body[rows[0]])
        index = len(nodes)
        frames, chosen = _keyframes(recording, rows)
        times = buffer.add(((frames + 1) * recording.frame_s).astype(np.float32), "SCALAR")
        position = (recording.position[chosen] * LENGTH_STEP).astype(np.float32)
        quaternion = recording.quaternion[chosen][:, [1, 2, 3, 0]] * QUATERNION_STEP
        quaternion = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).astype(np.float32)
        states = [state for state in COLOURS if (recording.state[rows] == STATES.index(state)).any()]
        children = list(range(index + 1, index + 1 + len(states)))
        nodes[0]["children"].append(index)
        nodes.append({"name": f"brick {body}", "children": children})
        animate(index, "translation", times, buffer.add(position, "VEC3"), "LINEAR")
        animate(index, "rotation", times, buffer.add(quaternion, "VEC4"), "LINEAR")
        changes = rows[np.flatnonzero(np.diff(recording.state[rows], prepend=-1))]
        begun = np.concatenate([[0], recording.frame[changes] + 1]) * recording.frame_s  # no brick before the first row
        steps = buffer.add(begun.astype(np.float32), "SCALAR")
        for child, state in zip(children, states, strict=True):
            mesh, full = meshes.of(recording.shape(body), recording.sizes[body], state)
            nodes.append({"name": state, "mesh": mesh, "scale": [0.0, 0.0, 0.0]})
            shown = np.concatenate([[False], recording.state[changes] == STATES.index(state)])
            scale = (shown[:, None] * np.array(full)).astype(np.float32)
            animate(child, "scale", steps, buffer.add(scale, "VEC3"), "STEP")
    return _packed(
        {
            "asset": {"version": "2.0", "generator": "Stillstack"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": nodes,
            "meshes": meshes.all,
            "materials": _materials(),
            "animations": [{"name": "trial", "channels": channels, "samplers": samplers}],
            "accessors": buffer.accessors,
            "bufferViews": buffer.views,
            "buffers": [{"byteLength": len(buffer.content)}],
        },
        bytes(buffer.content),
    )


def _fixed_node(body: Brick, meshes: _Meshes) -> dict[str, Any]:
    w, x, y, z = body.quaternion
    mesh, scale = meshes.of(body.shape, body.size, _FIXED)
    pose = {"translation": list(body.position), "rotation": [x, y, z, w], "scale": list(scale)}
    return {"name": _FIXED, "mesh": mesh, **pose}


def _keyframes(
    recording: Recording, rows: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the frames and the rows of a brick's keyframes.

    A row that holds for more than one kept frame has a second keyframe just before the next row, because glTF
    interpolates between keyframes.

    Args:
        recording: the recording.
        rows: rows of the brick in the recording, shape (n,).
    """
    frames = recording.frame[rows].astype(np.int64)
    held = np.flatnonzero(np.diff(frames) > recording.every)
    every_frame = np.concatenate([frames, frames[held + 1] - recording.every])
    order = np.argsort(every_frame, kind="stable")
    return every_frame[order], np.concatenate([rows, rows[held]])[order]


def _boxes(buffer: _Buffer) -> list[dict[str, Any]]:
    """Return a mesh for each material: a unit cube with 24 vertices, four per face, so that edges are sharp."""
    corners: list[npt.NDArray[np.float64]] = []
    normals: list[npt.NDArray[np.float64]] = []
    triangles: list[int] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            normal = np.eye(3)[axis] * side
            first, second = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3] * side
            begin = len(corners)
            corners += [(normal + u * first + v * second) / 2 for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            normals += [normal] * 4
            triangles += [begin, begin + 1, begin + 2, begin, begin + 2, begin + 3]
    attributes = {
        "POSITION": buffer.add(np.array(corners, np.float32), "VEC3", _VERTICES),
        "NORMAL": buffer.add(np.array(normals, np.float32), "VEC3", _VERTICES),
    }
    indices = buffer.add(np.array(triangles, np.uint16), "SCALAR", _INDICES)
    return [
        {"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": number}]}
        for number, name in enumerate(_MATERIALS)
    ]


def _surface(buffer: _Buffer, shape: Shape, size: Vector, material: str) -> dict[str, Any]:
    """Return the mesh [m] of a shape other than a box, with the normal of each face."""
    surface = surface_of(shape, size)
    corners = surface.corners[np.array(surface.triangles)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    attributes = {
        "POSITION": buffer.add(corners.reshape(-1, 3).astype(np.float32), "VEC3", _VERTICES),
        "NORMAL": buffer.add(np.repeat(normals, 3, axis=0).astype(np.float32), "VEC3", _VERTICES),
    }
    return {"name": material, "primitives": [{"attributes": attributes, "material": list(_MATERIALS).index(material)}]}


def _materials() -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8},
        }
        for name, colour in _MATERIALS.items()
    ]


def _packed(content: dict[str, Any], binary: bytes) -> bytes:
    """Return the GLB container: a header, and chunks of JSON and binary data, padded to multiples of four bytes."""
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % _ALIGNMENT)
    binary += bytes(-len(binary) % _ALIGNMENT)
    chunks = struct.pack("<II", len(text), _JSON) + text + struct.pack("<II", len(binary), _BINARY) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
