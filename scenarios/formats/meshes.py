"""Convexity of triangle meshes, and their decomposition into convex parts by CoACD."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
import trimesh

from scenarios.formats.imported import ImportRefusedError
from scenarios.geometry import FloatArray
from scenarios.polyhedra import MOST_VERTICES

FILLED = 0.98
"""Least ratio of a mesh's volume to its convex hull's from which the mesh counts as convex, because a tessellated
sphere or cylinder with a rounded edge fills 99 % of its hull."""
CONCAVITY = 0.05
"""CoACD's threshold of concavity, relative to the mesh's extent: the least that keeps parts few."""
MOST_PARTS = 64
"""Greatest number of convex parts."""


def is_convex(vertices: FloatArray, faces: Any) -> bool:
    """Return whether a mesh fills at least ``FILLED`` of the volume of its convex hull.

    Args:
        vertices: vertices [m], shape (v, 3).
        faces: triangles, as indices of vertices, shape (t, 3).
    """
    mesh = trimesh.Trimesh(vertices, faces, process=True)
    hull = mesh.convex_hull
    return bool(abs(mesh.volume) >= FILLED * hull.volume)


def convex_parts(name: str, vertices: FloatArray, faces: Any) -> list[FloatArray]:
    """Return the vertices of the convex parts of a mesh, each of shape (v, 3) [m].

    Raises:
        ImportRefusedError: if the package CoACD is missing; the message names the command that installs it.
    """
    if importlib.util.find_spec("coacd") is None:
        raise ImportRefusedError(
            f"mesh of '{name}' is not convex, and the package CoACD, which splits meshes, is not installed: run "
            '"uv sync --group decompose", or replace the mesh by convex parts'
        )
    import coacd

    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=CONCAVITY,
        max_convex_hull=MOST_PARTS,
        decimate=True,
        max_ch_vertex=MOST_VERTICES,
        seed=0,
    )
    return [np.asarray(points, np.float64) for points, _ in parts]
