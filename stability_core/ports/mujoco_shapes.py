"""Convex shapes of MuJoCo's bodies."""

from __future__ import annotations

import mujoco
import numpy as np

from stability_core.port import FloatArray
from stability_core.ports.mujoco_calls import Model
from stability_core.ports.mujoco_ghosts import geoms_of
from stability_core.ports.shared.shapes import HALF_SPACE, NO_AXIS, Solid, box_vertices, cylinder_vertices
from stability_core.ports.shared.vectors import rotate


def solid_of(model: Model, body: int) -> Solid | None:
    """Return the shape of a body in its frame.

    Returns:
        None unless the body has exactly one colliding geom, and this geom is a plane, a box, a cylinder or a mesh. The
        port then adds no corners.
    """
    geoms = [geom for geom in geoms_of(model, body).tolist() if model.geom_contype[geom] | model.geom_conaffinity[geom]]
    if len(geoms) != 1:
        return None
    geom = geoms[0]
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return Solid(HALF_SPACE)
    axis = NO_AXIS
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        vertices = box_vertices(size)
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        vertices, axis = cylinder_vertices(size[0], 2 * size[1]), np.array([0.0, 0.0, 1.0])
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:
        vertices = _hull_of(model, model.geom_dataid[geom])
    else:
        return None
    turn = model.geom_quat[None, geom]
    turned = rotate(np.tile(turn, (len(vertices), 1)), vertices)
    return Solid(model.geom_pos[geom] + turned, rotate(turn, axis[None])[0])


def _hull_of(model: Model, mesh: int) -> FloatArray:
    """Return the vertices (n, 3) [m] of a mesh's convex hull, or all its vertices if MuJoCo keeps no hull."""
    first, count, graph = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh], model.mesh_graphadr[mesh]
    vertices: FloatArray = model.mesh_vert[first : first + count].astype(np.float64)
    if graph < 0:
        return vertices
    corners = model.mesh_graph[graph]
    return np.asarray(vertices[model.mesh_graph[graph + 2 + corners : graph + 2 + 2 * corners]])
