"""What holds edges of surfaces, as equations at their nodes."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.errors import ModelError
from pliant.joints import EdgeJoint
from pliant.rigid import RigidBodyData
from pliant.surfaces import Edge, SurfaceBody
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["EdgeEquations", "is_held"]

SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=np.float64)
SMOOTH = np.cos(np.radians(30.0))  # of the angle between sides of an edge that is smooth there
IMPLIED = 0.05  # part of an equation that others leave, below which it follows from them
NodeKey = tuple[str, str | None, int]  # surface, what holds it, node
Equation = tuple[FloatArray, FloatArray, FloatArray]  # weights at a, weights at b, direction


def directions(body: SurfaceBody, edge: Edge) -> dict[int, list[FloatArray]]:
    """Directions of the edge in the parameters (u, v) at each of its nodes, of unit length.

    Where it is smooth, sides that meet at a small angle have one direction, their mean; at a corner two.
    """
    found: dict[int, list[FloatArray]] = defaultdict(list)
    for face, side in edge.sides:
        corners, chart = body.corners(face), body.chart(face)
        n = len(corners)
        step = chart[(side + 1) % n] - chart[side]
        for corner in (side, (side + 1) % n):
            way = body.way(face, corner, step)
            found[int(corners[corner])].append(way / np.linalg.norm(way))
    for node, ways in found.items():
        if len(ways) == 2:
            first, second = ways
            second = second if first @ second > 0 else -second
            if first @ second > SMOOTH:
                found[node] = [(first + second) / np.linalg.norm(first + second)]
    return found


def along_and_across(body: SurfaceBody, way: FloatArray) -> tuple[list[FloatArray], list[FloatArray]]:
    """Weights of the slope along the edge and of what crosses it, slope and twist."""
    s = body.vectors
    unit = np.eye(s)
    if s == 1:
        return [], []
    if s == 2:
        # Linear along v: an edge along v has no slope of its own, one along u nothing across.
        return ([unit[1]], []) if abs(way[0]) > abs(way[1]) else ([], [unit[1]])
    along = way[0] * unit[1] + way[1] * unit[2]
    across = -way[1] * unit[1] + way[0] * unit[2]
    return [along], [across] + ([unit[3]] if s == 4 else [])


def normals(direction: FloatArray) -> list[FloatArray]:
    """Two unit vectors normal to a direction."""
    t = direction / np.linalg.norm(direction)
    e = np.eye(3)[int(np.argmin(np.abs(t)))]
    first = e - t * (e @ t)
    first /= np.linalg.norm(first)
    return [first, np.cross(t, first)]


class EdgeEquations:
    """Equations of edge joints, node by node; those that others imply are left out."""

    def __init__(self, model: Model, rigid: dict[str, int]) -> None:
        self.model, self.rigid = model, rigid
        self._known: dict[NodeKey, list[FloatArray]] = defaultdict(list)

    def of(self, joint: EdgeJoint, numbers: dict[str, int]) -> list[Json]:
        """Documents of a joint, one for each node that it holds."""
        documents = []
        body = self._surface(joint.edge)
        ways = directions(body, joint.edge)
        partners = joint.other.nodes if joint.other is not None else (None,) * len(joint.edge.nodes)
        for node, partner in dict(zip(joint.edge.nodes, partners, strict=True)).items():
            equations = self._at_node(joint, body, node, partner, ways.get(node, []))
            if joint.other is None:
                equations = [e for e in equations if self._is_new((body.name, joint.body, node), e)]
            if not equations:
                continue
            b = None
            if joint.other is not None and partner is not None:
                b = {"surface": numbers[joint.other.body], "node": int(partner)}
            documents.append(
                {
                    "kind": "hold",
                    "name": joint.name,
                    "a": {"surface": numbers[body.name], "node": int(node)},
                    "b": b,
                    "rigid": None if joint.body is None else self._on_body(joint.body, body.r[node]),
                    "equations": [
                        {"a": a.tolist(), "b": other.tolist(), "direction": d.tolist()}
                        for a, other, d in equations
                    ],
                }
            )
        return documents

    def _on_body(self, name: str, place: FloatArray) -> Json:
        """Document of the point of a rigid body at a place."""
        body = self.model._bodies[name]
        assert isinstance(body, RigidBodyData)
        return {"rigid": self.rigid[name], "local": (body.axes @ (place - body.position)).tolist()}

    def _surface(self, edge: Edge) -> SurfaceBody:
        body = self.model._bodies[edge.body]
        assert isinstance(body, SurfaceBody)
        return body

    def _is_new(self, key: NodeKey, equation: Equation) -> bool:
        """Whether no equations before imply this one."""
        row: Any = np.kron(equation[0], equation[2])
        row = np.asarray(row / np.linalg.norm(row), dtype=np.float64)
        for known in self._known[key]:
            row = np.asarray(row - known * (known @ row), dtype=np.float64)
        left = float(np.linalg.norm(row))
        if left < IMPLIED:
            return False
        known_row: FloatArray = np.asarray(row / left)
        self._known[key].append(known_row)
        return True

    def _at_node(
        self,
        joint: EdgeJoint,
        body: SurfaceBody,
        node: int,
        partner: int | None,
        ways: list[FloatArray],
    ) -> list[Equation]:
        s, none = body.vectors, np.empty(0)
        unit, axes = np.eye(s), np.eye(3)
        q = body.q[node]
        if joint.kind == "weld":
            assert joint.other is not None
            assert partner is not None
            return self._weld(body, node, self._surface(joint.other), partner)
        if joint.kind == "symmetry":
            n = np.array(joint.axes[0])
            equations = [(unit[0], none, n)]
            for way in ways:
                along, across = along_and_across(body, way)
                equations += [(w, none, n) for w in along]
                equations += [(w, none, d) for w in across for d in normals(n)]
            return equations
        if joint.axes:
            axes = np.array(joint.axes)
        equations = [(unit[0], none, d) for d in axes]
        if joint.kind == "clamp" and not joint.edge.sides:
            # Faces: everything.
            return equations + [(w, none, d) for w in unit[1:] for d in axes]
        for way in ways:
            along, across = along_and_across(body, way)
            equations += [(w, none, d) for w in along for d in axes]
            if joint.kind == "clamp" and across:
                reference = across[0] @ q
                equations += [(w, none, d) for w in across for d in normals(reference)]
        return equations

    def _weld(self, a: SurfaceBody, i: int, b: SurfaceBody, j: int) -> list[Equation]:
        """Positions and slopes alike: the slopes of b in terms of those of a at the start."""
        equations: list[Equation] = []
        s_a, s_b = a.vectors, b.vectors
        e_a, e_b, axes = np.eye(s_a), np.eye(s_b), np.eye(3)
        equations += [(e_a[0], -e_b[0], d) for d in axes]
        if min(s_a, s_b) == 1:
            return equations
        if s_a != s_b:
            raise ModelError("weld: edges of the same kind of element can be welded, or of membranes")
        slopes = min(s_a, 3)
        p, q = a.q[i, 1:slopes], b.q[j, 1:slopes]
        # q = turn p, in the common tangent plane.
        turn = np.linalg.lstsq(p.T, q.T, rcond=None)[0].T
        if np.abs(turn @ p - q).max() > 1e-6 * np.abs(q).max():
            raise ModelError(
                f"weld: '{a.name}' and '{b.name}' meet at an angle at node {i}; pin the nodes instead"
            )
        for row, weights in enumerate(turn):
            w = np.zeros(s_a)
            w[1:slopes] = weights
            equations += [(w, -e_b[1 + row], d) for d in axes]
        if s_a == 4:
            u, v = turn
            if abs(u[0] * v[0]) + abs(u[1] * v[1]) < 1e-6:
                factor = u[0] * v[1] + u[1] * v[0]
                equations += [(factor * e_a[3], -e_b[3], d) for d in axes]
            else:
                raise ModelError(
                    f"weld: the (u, v) directions of '{a.name}' and '{b.name}' neither agree nor cross"
                )
        return equations


def is_held(model: Model, body: SurfaceBody, faces: tuple[int, ...]) -> bool:
    """Whether faces are closed, or their rim is held so that pressure on them has a potential."""
    count: dict[tuple[int, int], int] = defaultdict(int)
    for face in faces:
        nodes = body.corners(face).tolist()
        for a, b in zip(nodes, nodes[1:] + nodes[:1], strict=True):
            count[min(a, b), max(a, b)] += 1
    held: set[tuple[int, int]] = set()
    for joint in model._joints.values():
        if (
            isinstance(joint, EdgeJoint)
            and joint.edge.body == body.name
            and joint.kind not in ("weld", "fold")
        ):
            if (joint.kind == "pin" and joint.axes) or joint.body is not None:
                continue
            nodes = joint.edge.nodes
            if joint.edge.sides:
                held |= {(min(p), max(p)) for p in pairwise(nodes)}
            else:
                fixed = set(nodes)
                held |= {pair for pair in count if pair[0] in fixed and pair[1] in fixed}
    return all(n == 2 or pair in held for pair, n in count.items())
