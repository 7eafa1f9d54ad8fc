"""Recordings, replays, pictures and glTF files show every shape."""

from __future__ import annotations

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

from reports.records.recording import Recorder, Recording, read_recording, write_recording
from reports.replays.drawing import view_of, visible_space
from reports.replays.gltf import to_glb
from reports.replays.replay import Replayed, write_replay
from reports.replays.timeline import Timeline
from scenarios.model import Brick, World
from scenarios.solids import capsule, cylinder, polyhedron, sphere
from scenarios.surfaces import surface_of
from tests.reports.studies import record

PYRAMID = [(-0.03, -0.03, 0.0), (0.03, -0.03, 0.0), (0.03, 0.03, 0.0), (-0.03, 0.03, 0.0), (0.0, 0.0, 0.06)]
BRICKS = [
    cylinder(0.03, 0.05, position=(0.0, 0.0, 0.025), mass=0.1),
    capsule(0.02, 0.06, position=(0.1, 0.0, 0.05), mass=0.1),
    sphere(0.03, position=(0.2, 0.0, 0.03), mass=0.1),
    polyhedron(PYRAMID, position=(0.3, 0.0, 0.0), mass=0.1),
    Brick((0.04, 0.04, 0.04), 0.1, (0.4, 0.0, 0.02)),
]
POST = cylinder(0.02, 0.15, position=(-0.1, 0.0, 0.075), mass=1.0)


@pytest.fixture
def recording() -> Recording:
    recorder = Recorder(1 / 60, World(fixed=(POST,)))
    bodies = np.arange(len(BRICKS))
    for frame in range(3):
        position = np.add([brick.position for brick in BRICKS], (0.0, 0.001 * frame, 0.0))
        recorder.see(bodies, position, np.array([brick.quaternion for brick in BRICKS]), (), dict(enumerate(BRICKS)))
    return recorder.finish()


def test_a_file_keeps_the_shapes(recording: Recording, tmp_path) -> None:
    path = tmp_path / "r.parquet"
    write_recording(path, recording)
    read = read_recording(path)
    assert read.shapes == {body: brick.shape for body, brick in enumerate(BRICKS) if brick.shape != "box"}
    assert [body.shape for body in read.fixed] == ["cylinder"]
    boxes = replace(recording, shapes={}, fixed=())
    write_recording(path, boxes)
    assert read_recording(path).shapes == {}


def test_a_picture_gets_the_surface_of_every_shape(recording: Recording, tmp_path) -> None:
    space = visible_space([recording])
    assert space is not None
    assert space[0][:2] == pytest.approx((-0.12, -0.03), abs=2e-3)
    order = view_of(Timeline(recording), [0.0], space, (64, 48)).order(tmp_path / "poses.npz")
    assert list(order["surfaces"]) == [0, 1, 2, 3, 5]
    assert order["surfaces"][2]["is_round"]
    assert not order["surfaces"][3]["is_round"]


def test_gltf_has_a_mesh_for_every_shape(recording: Recording) -> None:
    glb = to_glb(recording)
    (length,) = struct.unpack_from("<I", glb, 12)
    content = json.loads(glb[20 : 20 + length])
    accessors = content["accessors"]
    for body, brick in enumerate(BRICKS):
        node = next(node for node in content["nodes"] if node["name"] == f"brick {body}")
        mesh = content["meshes"][content["nodes"][node["children"][0]]["mesh"]]
        corners = accessors[mesh["primitives"][0]["attributes"]["POSITION"]]
        extents = np.subtract(corners["max"], corners["min"])
        assert extents == pytest.approx((1.0, 1.0, 1.0) if brick.shape == "box" else brick.size, rel=1e-6)
    post = next(node for node in content["nodes"] if node["name"] == "fixed")
    assert post["scale"] == [1.0, 1.0, 1.0]


def test_the_page_draws_every_shape(recording: Recording, tmp_path, open_page) -> None:
    opened = open_page(write_replay(tmp_path / "replays", "shapes", [Replayed(record(policy="none"), recording)]))
    opened.wait_for_function("document.body.dataset.time !== undefined")
    surfaces = opened.evaluate("JSON.parse(document.getElementById('trials').textContent)[0].surfaces")
    assert set(surfaces) == {"0", "1", "2", "3", "fixed 0"}
    assert len(surfaces["3"]) == len(surface_of(BRICKS[3].shape, BRICKS[3].size).triangles)
