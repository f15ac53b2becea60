"""Elements with slopes on curved surfaces, and on plane ones whose faces have no common directions.

Every face gets parameters of its own, in which it is flat; every node gets a tangent plane, whose two
directions are its slopes. At each corner a linear map carries the face's parameters into the tangent plane:
the two sides that meet there become tangents of smooth arcs over them. Faces that share a side share its arc.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pliant import _check
from pliant.mesh import Mesh
from pliant.typing import FloatArray, IntArray

__all__ = ["OwnParameters", "is_parallelogram", "own_parameters"]

SKEW = 0.1  # gap by which a parallelogram may fail to close, in units of its shortest side
SHARP = np.cos(np.radians(40.0))  # of the angle between a face and the tangent plane at its corner
FIT = 8  # neighbours that a quadric is fitted to, at least


class OwnParameters(NamedTuple):
    """Faces in parameters of their own.

    ``slopes`` (nodes, 2, 3) are unit tangents at the nodes, ``quad_sizes`` (m, 2) and ``triangle_charts``
    (k, 3, 2) the faces' parameters, ``turns`` (corners of all faces, 2, 2) their slopes at corners in terms
    of the nodal ones.
    """

    slopes: FloatArray
    quad_sizes: FloatArray
    triangle_charts: FloatArray
    turns: FloatArray


def is_parallelogram(points: FloatArray, quads: IntArray) -> IntArray:
    """Which quadrilaterals are nearly parallelograms."""
    p = points[quads]
    gap = np.linalg.norm(p[:, 0] - p[:, 1] + p[:, 2] - p[:, 3], axis=1)
    shortest = np.linalg.norm(np.roll(p, -1, axis=1) - p, axis=2).min(axis=1)
    near: IntArray = gap <= SKEW * shortest
    return near


def own_parameters(mesh: Mesh, quads: IntArray, triangles: IntArray) -> OwnParameters:
    """Parameters and slopes of smooth faces through the points of a mesh."""
    points = mesh.points
    faces = [*quads.tolist(), *triangles.tolist()]
    normals = _normals(mesh, faces)
    axis = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    e_u = axis - normals * np.einsum("ni,ni->n", axis, normals)[:, None]
    e_u /= np.linalg.norm(e_u, axis=1)[:, None]
    slopes = np.stack([e_u, np.cross(normals, e_u)], axis=1)

    def tangent(i: int, j: int) -> FloatArray:
        """Tangent at i, along its slopes, of the arc to j: a circle's where both ends agree."""
        chord = points[j] - points[i]
        along: FloatArray = slopes[i] @ chord
        cosine = np.linalg.norm(along) / np.linalg.norm(chord)
        # Of a circle of which the chord leaves the tangent by phi: cubic with its curvature in the middle.
        arc: FloatArray = along / cosine * (2.0 / (1.0 + cosine))
        return arc

    sizes, charts, turns = [], [], []
    for nodes in faces:
        p, n = points[nodes], len(nodes)
        if n == 4:
            lengths = np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1)
            a, b = 0.5 * (lengths[0] + lengths[2]), 0.5 * (lengths[1] + lengths[3])
            sizes.append((a, b))
            chart = np.array([(0, 0), (a, 0), (a, b), (0, b)])
        else:
            first, second = p[1] - p[0], p[2] - p[0]
            length = np.linalg.norm(first)
            x = first @ second / length
            height = np.sqrt(max(second @ second - x * x, 0.0))
            chart = np.array([(0.0, 0.0), (length, 0.0), (x, height)])
            charts.append(chart)
        for c in range(n):
            ahead, behind = (c + 1) % n, (c - 1) % n
            sides = np.stack([chart[ahead] - chart[c], chart[behind] - chart[c]], axis=1)
            arcs = np.stack([tangent(nodes[c], nodes[ahead]), tangent(nodes[c], nodes[behind])], axis=1)
            turns.append(arcs @ np.linalg.inv(sides))
    return OwnParameters(
        slopes,
        np.array(sizes).reshape(-1, 2),
        np.array(charts).reshape(-1, 3, 2),
        np.array(turns).reshape(-1, 2, 2),
    )


def _normals(mesh: Mesh, faces: list[list[int]]) -> FloatArray:
    """Find normals of the smooth surface at the points: by the mesh's own slopes, or fitted quadrics."""
    points = mesh.points
    rough = np.zeros_like(points)
    neighbours: list[set[int]] = [set() for _ in points]
    corners: list[tuple[int, int, FloatArray]] = []
    for number, nodes in enumerate(faces):
        n = len(nodes)
        for c, node in enumerate(nodes):
            ahead, behind = points[nodes[(c + 1) % n]] - points[node], points[nodes[c - 1]] - points[node]
            normal = np.cross(ahead, behind)
            size = np.linalg.norm(normal)
            lengths = np.linalg.norm(ahead) * np.linalg.norm(behind)
            if not size > 1e-9 * lengths:
                _check.fail(f"faces[{number}]", nodes, "its corners lie on a line")
            rough[node] += normal / size * np.arctan2(size, ahead @ behind)
            neighbours[node] |= {nodes[(c + 1) % n], nodes[c - 1]}
            corners.append((number, node, normal / size))
    length = np.linalg.norm(rough, axis=1)
    if length.min() < 1e-3:
        bad = int(np.argmin(length))
        _check.fail(
            f"points[{bad}]", points[bad], "faces around it must have their corners the same way round"
        )
    rough /= length[:, None]
    if mesh.slopes is not None:
        exact = np.cross(mesh.slopes[:, 0], mesh.slopes[:, 1])
        normals: FloatArray = exact / np.linalg.norm(exact, axis=1)[:, None]
    else:
        normals = np.array([_fitted(points, rough[i], i, neighbours) for i in range(len(points))])
    for number, node, normal in corners:
        if normal @ normals[node] < SHARP:
            _check.fail(
                f"points[{node}]",
                points[node],
                f"the surface has a sharp edge here (face {number}): make a body of each side and join them "
                "by model.fold",
            )
    return normals


def _fitted(points: FloatArray, rough: FloatArray, node: int, neighbours: list[set[int]]) -> FloatArray:
    """Find the normal at a point of the quadric through it that is nearest to its neighbours."""
    ring = set(neighbours[node])
    for _ in range(2):
        if len(ring) < FIT:
            ring |= {other for near in ring for other in neighbours[near]}
    ring.discard(node)
    e_u = np.eye(3)[int(np.argmin(np.abs(rough)))]
    e_u = e_u - rough * (rough @ e_u)
    e_u /= np.linalg.norm(e_u)
    e_v = np.cross(rough, e_u)
    away = points[sorted(ring)] - points[node]
    size = float(np.linalg.norm(away, axis=1).max())
    x, y, z = away @ e_u / size, away @ e_v / size, away @ rough / size
    weights = 1.0 / np.maximum(x * x + y * y, 1e-6)
    rows = np.stack([x, y, x * x, x * y, y * y], axis=1)
    slope = np.linalg.lstsq(rows * weights[:, None], z * weights, rcond=1e-8)[0]
    normal = rough - slope[0] * e_u - slope[1] * e_v
    unit: FloatArray = normal / np.linalg.norm(normal)
    return unit
