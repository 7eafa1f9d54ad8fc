"""The animated glTF file: read back by the letter of its specification, it has the recording's poses and states."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

from reports.records.recording import Recorder, Recording
from reports.replays.gltf import to_glb
from scenarios.model import Brick

SIZE = (0.117, 0.0234, 0.0078)
FRAME_S = 1 / 60


@pytest.fixture
def recording() -> Recording:
    """A brick that rests, then moves for two frames, is frozen, and is taken away."""
    recorder = Recorder(FRAME_S)
    bricks = {0: Brick(SIZE, 0.0119, (0.0, 0.0, 0.0))}
    for frame in range(10):
        here = np.arange(frame < 9, dtype=np.int64)
        position = np.array([[0.001 * min(max(frame - 4, 0), 2), 0, 0.0039]])[: len(here)]
        recorder.see(here, position, np.tile([1.0, 0, 0, 0], (len(here), 1)), [0] if frame in (7, 8) else [], bricks)
    return recorder.finish()


def parsed(glb: bytes) -> tuple[dict, bytes]:
    magic, version, length = struct.unpack_from("<4sII", glb)
    assert (magic, version, length) == (b"glTF", 2, len(glb))
    size, kind = struct.unpack_from("<I4s", glb, 12)
    assert kind == b"JSON"
    assert size % 4 == 0
    binary_size, kind = struct.unpack_from("<I4s", glb, 20 + size)
    assert kind == b"BIN\0"
    return json.loads(glb[20 : 20 + size]), glb[28 + size : 28 + size + binary_size]


def values(content: dict, binary: bytes, accessor: int) -> np.ndarray:
    output = content["accessors"][accessor]
    view = content["bufferViews"][output["bufferView"]]
    kind = {5126: np.float32, 5123: np.uint16}[output["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[output["type"]]
    found = np.frombuffer(binary, kind, output["count"] * width, view["byteOffset"]).reshape(-1, width)
    assert found.min(axis=0).tolist() == pytest.approx(output["min"])
    assert found.max(axis=0).tolist() == pytest.approx(output["max"])
    return found


def channel(content: dict, binary: bytes, name: str, path: str) -> tuple[np.ndarray, np.ndarray]:
    animation = content["animations"][0]
    for one in animation["channels"]:
        if content["nodes"][one["target"]["node"]]["name"] == name and one["target"]["path"] == path:
            sampler = animation["samplers"][one["sampler"]]
            return values(content, binary, sampler["input"])[:, 0], values(content, binary, sampler["output"])
    raise AssertionError(f"{name} has no {path}")


def test_it_moves_as_the_recording_says(recording) -> None:
    times, places = channel(*parsed(to_glb(recording)), "brick 0", "translation")
    assert (np.diff(times) > 0).all()
    for frame, x in ((0, 0), (4, 0), (5, 0.001), (6, 0.002), (8, 0.002)):
        assert np.interp((frame + 1) * FRAME_S, times, places[:, 0]) == pytest.approx(x, abs=1e-5)


def test_it_shows_one_state_at_a_time_and_none_once_taken_away(recording) -> None:
    content, binary = parsed(to_glb(recording))
    times, live = channel(content, binary, "live", "scale")
    _, frozen = channel(content, binary, "frozen", "scale")
    assert (times * 60).round().tolist() == [0, 1, 8, 10]
    assert live[:, 0].tolist() == pytest.approx([0, SIZE[0], 0, 0])
    assert frozen[:, 0].tolist() == pytest.approx([0, 0, SIZE[0], 0])


def test_faces_look_outward(recording) -> None:
    content, binary = parsed(to_glb(recording))
    primitive = content["meshes"][0]["primitives"][0]
    corners, normals, indices = (
        values(content, binary, accessor)
        for accessor in (primitive["attributes"]["POSITION"], primitive["attributes"]["NORMAL"], primitive["indices"])
    )
    a, b, c = (corners[indices[corner::3, 0]] for corner in range(3))
    np.testing.assert_allclose(np.cross(b - a, c - a), normals[indices[::3, 0]])  # unit faces, counter-clockwise


def test_a_fixed_box_is_a_grey_node_that_stays(recording) -> None:
    table = Brick((0.4, 0.2, 0.1), 1.0, (0.0, 0.0, 0.05), (0.8, 0.0, 0.6, 0.0))
    content, _ = parsed(to_glb(replace(recording, fixed=(table,))))
    (index,) = (index for index, node in enumerate(content["nodes"]) if node["name"] == "fixed")
    node = content["nodes"][index]
    assert index in content["nodes"][0]["children"]
    assert (node["translation"], node["rotation"], node["scale"]) == ([0, 0, 0.05], [0, 0.6, 0, 0.8], [0.4, 0.2, 0.1])
    assert content["materials"][node["mesh"]]["name"] == "fixed"
    assert index not in [one["target"]["node"] for one in content["animations"][0]["channels"]]
