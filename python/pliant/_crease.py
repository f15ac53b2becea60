"""Creases: edges of two surfaces with one position, and the angle between the surfaces there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pliant import _check
from pliant.surfaces import Edge, SurfaceBody
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant._contents import Contents

__all__ = ["Crease"]

MEET = 1e-6  # largest difference of the slopes along edges of unit length that meet

Sum = dict[int, FloatArray]  # weights of the nodal vectors of some nodes


class Side(NamedTuple):
    """One surface at a node of a crease: sums of nodal vectors."""

    along: Sum
    into: Sum
    slope: FloatArray | None


class Crease:
    """Equations and angles of a fold, node by node."""

    def __init__(self, model: Contents, edge_a: Edge, edge_b: Edge) -> None:
        a, b = model._bodies[edge_a.body], model._bodies[edge_b.body]
        assert isinstance(a, SurfaceBody)
        assert isinstance(b, SurfaceBody)
        self.a, self.b = a, b
        self.edge_a, self.edge_b = edge_a, edge_b
        self.sides_a, self.sense = _sides(self.a, edge_a)
        self.sides_b, _ = _sides(self.b, edge_b)
        for node, (side, other) in enumerate(zip(self.sides_a, self.sides_b, strict=True)):
            if side.slope is None or other.slope is None:
                continue
            p, q = side.slope @ self.a.q[edge_a.nodes[node]], other.slope @ self.b.q[edge_b.nodes[node]]
            if np.linalg.norm(p - q) > MEET * np.linalg.norm(p):
                _check.fail(
                    "edge_b", str(edge_b), f"must run along edge_a, but leaves its direction at node {node}"
                )

    @property
    def lengths(self) -> FloatArray:
        """Stress-free length that each node stands for [m], (nodes,)."""
        r = self.a.reference[list(self.edge_a.nodes), 0]
        halves = 0.5 * np.linalg.norm(np.diff(r, axis=0), axis=1)
        lengths: FloatArray = np.append(halves, 0.0) + np.append(0.0, halves)
        return lengths

    def angles(self, near: float = 0.0, stress_free: bool = False) -> FloatArray:
        """Angle at each node [rad], of those that differ by turns the one nearest to ``near``, (nodes,)."""
        found = np.empty(len(self.sides_a))
        for node, (side, other) in enumerate(zip(self.sides_a, self.sides_b, strict=True)):
            values = []
            for body, sums in ((self.a, side.along), (self.a, side.into), (self.b, other.into)):
                q = body.reference if stress_free else body.q
                values.append(np.sum([w @ q[i] for i, w in sums.items()], axis=0))
            t, u, w = -self.sense * values[0], -values[1], values[2]
            sine = np.linalg.norm(t) * (t @ np.cross(u, w))
            found[node] = np.arctan2(sine, (t @ t) * (u @ w) - (u @ t) * (w @ t))
        turns: FloatArray = found + 2 * np.pi * np.round((near - found) / (2 * np.pi))
        return turns

    def documents(self, name: str, numbers: dict[str, int], near: FloatArray) -> list[Json]:
        """Joint of the core at each node: positions and slopes along the crease held, the angle free."""
        axes, documents = np.eye(3), []
        for k, (side, other) in enumerate(zip(self.sides_a, self.sides_b, strict=True)):
            pairs = [(np.eye(self.a.vectors)[0], np.eye(self.b.vectors)[0])]
            if side.slope is not None and other.slope is not None:
                pairs.append((side.slope, other.slope))
            held = [
                {"a": p.tolist(), "b": (-q).tolist(), "direction": d.tolist()} for p, q in pairs for d in axes
            ]
            a, b = numbers[self.edge_a.body], numbers[self.edge_b.body]
            fold = {
                "along": _terms(a, side.along, -self.sense),
                "out": _terms(a, side.into, -1.0),
                "into": _terms(b, other.into, 1.0),
                "near": float(near[k]),
            }
            documents.append(
                {
                    "kind": "hold",
                    "name": name,
                    "a": {"surface": a, "node": self.edge_a.nodes[k]},
                    "b": {"surface": b, "node": self.edge_b.nodes[k]},
                    "equations": held,
                    "fold": fold,
                }
            )
        return documents


def _terms(surface: int, sums: Sum, factor: float) -> list[Json]:
    return [
        {"at": {"surface": surface, "node": node}, "weights": (factor * weights).tolist()}
        for node, weights in sums.items()
    ]


def _sides(body: SurfaceBody, edge: Edge) -> tuple[list[Side], float]:
    """Find what nodes of an edge have along and across it; and whether its faces lie to the left, 1, or -1.

    Where nodes have a slope that way it is taken, else the differences to neighbours.
    """
    nodes, s = edge.nodes, body.vectors
    first = body.corners(edge.sides[0][0]).tolist()
    sense = 1.0 if first[edge.sides[0][1]] == nodes[0] else -1.0
    sides = []
    for k, node in enumerate(nodes):
        touching = [edge.sides[j] for j in (k - 1, k) if 0 <= j < len(edge.sides)]
        way, left = np.zeros(2), np.zeros(2)
        for face, number in touching:
            chart = body.chart(face)
            step = chart[(number + 1) % len(chart)] - chart[number]
            corner = body.corners(face).tolist().index(node)
            step = sense * body.way(face, corner, step)
            step = step / np.linalg.norm(step)
            way += step
            left += sense * np.array([-step[1], step[0]])
        slope, into = _slope(s, way), _slope(s, left)
        if slope is not None:
            slope = slope / np.linalg.norm(slope @ body.reference[node])
        along: Sum = {node: slope} if slope is not None else _differences(s, nodes, k)
        across: Sum = {node: into} if into is not None else _inwards(body, node, nodes, touching)
        sides.append(Side(along, across, slope))
    return sides, sense


def _slope(vectors: int, way: FloatArray) -> FloatArray | None:
    """Weights of the slope along a direction in the parameters, where nodes have it."""
    weights = np.zeros(vectors)
    if vectors >= 3:
        weights[1:3] = way
        return weights
    if vectors == 2 and abs(way[0]) > abs(way[1]):
        # Linear along v: the slope along u is the only one.
        weights[1] = way[0]
        return weights
    return None


def _differences(vectors: int, nodes: tuple[int, ...], k: int) -> Sum:
    """From the node before to the node behind."""
    unit = np.eye(vectors)[0]
    return {nodes[max(k - 1, 0)]: -unit, nodes[min(k + 1, len(nodes) - 1)]: unit}


def _inwards(body: SurfaceBody, node: int, nodes: tuple[int, ...], touching: list[tuple[int, int]]) -> Sum:
    """From the node to the mean of the corners opposite to the edge."""
    unit, sums = np.eye(body.vectors)[0], {node: np.zeros(body.vectors)}
    for face, _ in touching:
        others = [corner for corner in body.corners(face).tolist() if corner not in nodes]
        for other in others:
            sums[other] = sums.get(other, np.zeros(body.vectors)) + unit / len(others)
            sums[node] = sums[node] - unit / len(others)
    return sums
