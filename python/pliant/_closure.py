"""How faces enclose a volume: which of their sides form rims, and what closes these."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.errors import ModelError
from pliant.joints import EdgeJoint
from pliant.points import Point
from pliant.surfaces import Faces, SurfaceBody
from pliant.typing import FloatArray, IntArray, Json

if TYPE_CHECKING:
    from pliant._contents import Contents

__all__ = ["Closure", "Side"]


@dataclass(frozen=True)
class Side:
    """A side of a face, from one corner to the next: names of its ends where bodies meet."""

    body: str
    face: int
    side: int
    start: int
    end: int


@dataclass(frozen=True)
class Plane:
    """A plane ``normal . r = distance``."""

    normal: tuple[float, float, float]
    distance: float


@dataclass
class Rim:
    """Sides that are closed together; ``plane`` is that of a plane of symmetry."""

    sides: list[Side]
    held: bool
    plane: Plane | None = None
    touched: list[Plane] = field(default_factory=list)


class Closure:
    """What closes the faces of a chamber, by the joints that the model has."""

    def __init__(self, model: Contents, faces: tuple[Faces, ...], name: str) -> None:
        self.model = model
        self.faces = faces
        self.name = name
        self.size = model._size()
        self.places = self._merged()
        self.pairs: list[tuple[str, str]] = []
        self.rims = self._rims(self._open_sides())
        self.planes = self._planes()
        center = np.mean(
            [self._place(side.start) for rim in self.rims for side in rim.sides if rim.plane is None]
            or self.places,
            axis=0,
        )
        self.origin = nearest(center, self.planes)

    def document(self, numbers: dict[str, int], array: Any) -> Json:
        """Faces, rims and reference point for the core."""
        return {
            "faces": [
                {"surface": numbers[part.body], "faces": array(np.array(part.numbers, dtype=np.float64))}
                for part in self.faces
            ],
            "rims": [
                {"sides": self._sides_document(rim, numbers, array), "closure": self._closure(rim)}
                for rim in self.rims
            ],
            "origin": self.origin.tolist(),
        }

    def _sides_document(self, rim: Rim, numbers: dict[str, int], array: Any) -> list[Json]:
        by_body: dict[str, list[tuple[int, int]]] = defaultdict(list)
        for side in rim.sides:
            by_body[side.body].append((side.face, side.side))
        return [
            {"surface": numbers[body], "sides": array(np.array(rows, dtype=np.float64))}
            for body, rows in by_body.items()
        ]

    def _closure(self, rim: Rim) -> Json:
        if rim.plane is not None:
            others = [p for p in self.planes if abs(np.dot(p.normal, rim.plane.normal)) < 1 - 1e-9]
            apex = nearest(self.origin, [*others, rim.plane])
            return {"kind": "plane", "apex": apex.tolist(), "normal": list(rim.plane.normal)}
        if rim.held:
            middle = np.mean([self._place(side.start) for side in rim.sides], axis=0)
            return {"kind": "held", "apex": nearest(middle, rim.touched).tolist()}
        projection, shift = projector(rim.touched)
        return {"kind": "lid", "projection": projection.tolist(), "shift": shift.tolist()}

    def require_joined(self) -> None:
        """Refuse bodies whose rims meet without a joint between them."""
        joined = set()
        for joint in self.model._joints.values():
            if isinstance(joint, EdgeJoint):
                if joint.other is not None:
                    joined.add(frozenset((joint.edge.body, joint.other.body)))
                continue
            points = [point.body for point in joint.points() if isinstance(point, Point)]
            joined |= {frozenset((a, b)) for a in points for b in points}
        for a, b in self.pairs:
            if frozenset((a, b)) not in joined:
                raise ModelError(
                    f"chamber '{self.name}': the rims of '{a}' and '{b}' meet, but nothing joins them; "
                    "weld the edges, model.weld(a.edge(...), b.edge(...))"
                )

    # The mesh

    def _body(self, name: str) -> SurfaceBody:
        body = self.model._bodies[name]
        assert isinstance(body, SurfaceBody)
        return body

    def _place(self, vertex: int) -> FloatArray:
        place: FloatArray = self.places[vertex]
        return place

    def _merged(self) -> FloatArray:
        """Places of the vertices; nodes at one place are one vertex."""
        from scipy.spatial import cKDTree

        self.vertex: dict[str, IntArray] = {}
        names = list(dict.fromkeys(part.body for part in self.faces))
        nodes = np.concatenate([self._body(name).r for name in names])
        tree = cKDTree(nodes)
        first = np.arange(len(nodes))
        for a, b in sorted(tree.query_pairs(1e-6 * self.size)):
            first[b] = min(first[b], first[a])
        start = 0
        for name in names:
            count = self._body(name).nodes
            self.vertex[name] = first[start : start + count]
            start += count
        return nodes

    def _open_sides(self) -> list[Side]:
        """Sides that no other face continues, within its body or in another whose rim is there."""
        rest: list[Side] = []
        for part in self.faces:
            body, vertex = self._body(part.body), self.vertex[part.body]
            here: dict[tuple[int, int], list[tuple[int, int, int, int]]] = defaultdict(list)
            for face in part.numbers:
                nodes = body.corners(face).tolist()
                for side, (a, b) in enumerate(zip(nodes, nodes[1:] + nodes[:1], strict=True)):
                    if a != b:
                        here[min(a, b), max(a, b)].append((a, b, face, side))
            for sides in here.values():
                if len(sides) == 1:
                    a, b, face, side = sides[0]
                    rest.append(Side(part.body, face, side, int(vertex[a]), int(vertex[b])))
                elif len(sides) > 2 or sides[0][:2] == sides[1][:2]:
                    faces = [face for _, _, face, _ in sides]
                    raise ModelError(
                        f"faces: faces {faces} of '{part.body}' do not continue each other: two of one "
                        "orientation must meet at an edge"
                    )
        found: dict[tuple[int, int], Side] = {}
        rest = [one for one in rest if one.start != one.end]
        for one in rest:
            other = found.get((one.start, one.end))
            if other is not None:
                raise ModelError(
                    f"faces: the normals of '{other.body}' and '{one.body}' point to different sides where "
                    "their rims meet; reverse the order of the corners of one of them"
                )
            found[one.start, one.end] = one
        left = []
        for (start, end), one in found.items():
            other = found.get((end, start))
            if other is None:
                left.append(one)
            elif other.body != one.body:
                self.pairs.append((one.body, other.body))
        return left

    # What holds the rims

    def _rims(self, sides: list[Side]) -> list[Rim]:
        held, normals = self._holds()
        planes: dict[tuple[int, ...], Rim] = {}
        rest: list[Side] = []
        fixed: set[Side] = set()
        for side in sides:
            nodes = self._nodes(side)
            common = [n for n in normals[side.body].get(nodes[0], []) if self._in_plane(side, nodes, n)]
            if all(node in held[side.body] for node in nodes):
                rest.append(side)
                fixed.add(side)
            elif common:
                normal = np.array(common[0])
                normal = normal * np.sign(normal[np.argmax(np.abs(normal))])
                distance = float(normal @ self._place(side.start))
                key = (*np.round(normal * 1e6).astype(int).tolist(), round(distance / self.size * 1e6))
                unit = (float(normal[0]), float(normal[1]), float(normal[2]))
                rim = planes.setdefault(key, Rim([], False, Plane(unit, distance)))
                rim.sides.append(side)
            else:
                rest.append(side)
        rims = list(planes.values())
        touching: dict[int, list[Plane]] = defaultdict(list)
        for rim in rims:
            for vertex in {v for side in rim.sides for v in (side.start, side.end)}:
                assert rim.plane is not None
                touching[vertex].append(rim.plane)
        for chain in chains(rest):
            ends = {v for side in chain for v in (side.start, side.end)}
            touched = list(dict.fromkeys(plane for v in ends for plane in touching[v]))
            rims.append(Rim(chain, fixed.issuperset(chain), None, touched))
        return rims

    def _nodes(self, side: Side) -> tuple[int, int]:
        corners = self._body(side.body).corners(side.face)
        return int(corners[side.side]), int(corners[(side.side + 1) % len(corners)])

    def _in_plane(self, side: Side, nodes: tuple[int, int], normal: tuple[float, ...]) -> bool:
        body = self._body(side.body)
        known = [np.array(n) for n in self._normals[side.body].get(nodes[1], [])]
        along = float(np.abs((body.r[nodes[1]] - body.r[nodes[0]]) @ np.array(normal)))
        return along <= 1e-6 * self.size and any(abs(n @ np.array(normal)) > 1 - 1e-9 for n in known)

    def _holds(self) -> tuple[dict[str, set[int]], dict[str, dict[int, list[tuple[float, ...]]]]]:
        """Nodes that are held, and directions in which nodes are, by body."""
        held: dict[str, set[int]] = defaultdict(set)
        normals: dict[str, dict[int, list[tuple[float, ...]]]] = defaultdict(lambda: defaultdict(list))
        for name, joint in self.model._joints.items():
            if not isinstance(joint, EdgeJoint) or joint.kind == "weld":
                continue
            if not self.model._latch(name).is_permanent:
                continue
            if joint.kind in ("pin", "clamp") and not joint.axes:
                held[joint.edge.body] |= set(joint.edge.nodes)
            for axis in joint.axes:
                for node in joint.edge.nodes:
                    normals[joint.edge.body][node].append(tuple(axis))
        for body, of_nodes in normals.items():
            for node, axes in of_nodes.items():
                if np.linalg.matrix_rank(np.array(axes), tol=1e-6) == 3:
                    held[body].add(node)
        self._normals = normals
        return held, normals

    def _planes(self) -> list[Plane]:
        """Planes of symmetry that have a point in common."""
        common: list[Plane] = []
        for rim in self.rims:
            if rim.plane is None:
                continue
            normals = np.array([p.normal for p in [*common, rim.plane]])
            if np.linalg.matrix_rank(normals, tol=1e-6) == len(normals):
                common.append(rim.plane)
        return common


def projector(planes: list[Plane]) -> tuple[FloatArray, FloatArray]:
    """Matrix and shift of the projection onto what planes have in common."""
    if not planes:
        return np.eye(3), np.zeros(3)
    normals = np.array([plane.normal for plane in planes])
    inverse = np.linalg.pinv(normals, rcond=1e-9)
    return np.eye(3) - inverse @ normals, inverse @ np.array([plane.distance for plane in planes])


def nearest(point: FloatArray, planes: list[Plane]) -> FloatArray:
    """Point that planes have in common nearest to another."""
    projection, shift = projector(planes)
    place: FloatArray = projection @ point + shift
    return place


def chains(sides: list[Side]) -> list[list[Side]]:
    """Sides that hang together."""
    group: dict[int, int] = {}

    def root(v: int) -> int:
        while group.setdefault(v, v) != v:
            v = group[v]
        return v

    for side in sides:
        group[root(side.start)] = root(side.end)
    found: dict[int, list[Side]] = defaultdict(list)
    for side in sides:
        found[root(side.start)].append(side)
    return list(found.values())
