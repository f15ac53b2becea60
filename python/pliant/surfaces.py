"""Shells and membranes: what a model keeps of them, and their handles."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from pliant import _check
from pliant._curved import is_parallelogram, own_parameters
from pliant.errors import ModelError
from pliant.materials import LinearElastic, NeoHookean, SaintVenantKirchhoff, require_law
from pliant.mesh import PARALLEL, Mesh, as_mesh
from pliant.points import Handle, Point
from pliant.typing import ArrayLike, FloatArray, IntArray

__all__ = ["Edge", "Faces", "Membrane", "Shell", "SurfaceBody"]

VECTORS = {"bicubic": 4, "plate": 3, "triangle": 3, "cylindrical": 2, "membrane": 1}
QUADRATURES = ("standard", "reduced", "full")
BENDINGS = ("exact", "simplified")
INTEGRALS = ("quadrature", "precomputed")
LAWS = ("saint_venant_kirchhoff", "neo_hookean", "tension_field")
Side = tuple[int, int]


@dataclass(frozen=True)
class Edge:
    """An edge of a surface: nodes along it, and sides (face, side) of faces. Made by ``sheet.edge(...)``."""

    identity: str
    body: str
    nodes: tuple[int, ...]
    sides: tuple[Side, ...]

    def __post_init__(self) -> None:
        _check.text(self.body, "body")
        nodes = tuple(_check.count(node, "nodes", at_least=0) for node in self.nodes)
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "sides", tuple((int(a), int(b)) for a, b in self.sides))

    def __str__(self) -> str:
        return f"{self.body}, edge of {len(self.nodes)} nodes from node {self.nodes[0]}"


@dataclass(frozen=True)
class Faces:
    """Faces of a surface, by number. Made by ``sheet.faces(...)``."""

    identity: str
    body: str
    numbers: tuple[int, ...]

    def __post_init__(self) -> None:
        _check.text(self.body, "body")
        numbers = tuple(_check.count(number, "numbers", at_least=0) for number in self.numbers)
        object.__setattr__(self, "numbers", numbers)

    def __str__(self) -> str:
        return f"{self.body}, {len(self.numbers)} faces"


@dataclass(frozen=True, eq=False)
class SurfaceBody:
    """A shell or membrane, discretised; arrays as in the core's document.

    Attributes
    ----------
    reference, q, v : (nodes, vectors, 3)
        Nodal vectors (position, slopes along u and v, twist), stress-free, at the start, and velocities.
    quad_sizes : (m, 2)
        Extent of the quadrilaterals in the parameters.
    triangle_charts : (k, 3, 2)
        Parameters of the triangles' corners.
    turns : (corners of all faces, 2, 2) or (0, 2, 2)
        Where every face has parameters of its own: slopes along them at its corners in terms of nodal ones.
    groups, edges : list of (name, list of int)
        Named faces and edges.
    """

    name: str
    kind: str
    element: str
    material: str
    law: str
    youngs_modulus: float
    poisson_ratio: float
    density: float
    retardation_time: float
    residual_stiffness: float
    quadrature: str
    thickness: FloatArray
    quads: IntArray
    triangles: IntArray
    quad_sizes: FloatArray
    triangle_charts: FloatArray
    reference: FloatArray
    q: FloatArray
    v: FloatArray
    groups: Any = ()
    edges: Any = ()
    turns: FloatArray = field(default_factory=lambda: np.empty((0, 2, 2)))
    bending: str = "exact"
    integrals: str = "quadrature"

    def __post_init__(self) -> None:
        _check.choice(self.kind, "kind", ("shell", "membrane"))
        _check.choice(self.element, "element", VECTORS)
        _check.choice(self.law, "law", LAWS)
        _check.choice(self.quadrature, "quadrature", QUADRATURES)
        _check.choice(self.bending, "bending", BENDINGS)
        _check.choice(self.integrals, "integrals", INTEGRALS)
        for name in ("name", "material"):
            _check.text(getattr(self, name), name)
        for name in ("youngs_modulus", "density"):
            _check.number(getattr(self, name), name, above=0)
        _check.number(self.retardation_time, "retardation_time", at_least=0)
        _check.number(self.residual_stiffness, "residual_stiffness", at_least=0, at_most=1)
        _check.number(self.poisson_ratio, "poisson_ratio", above=-1, at_most=0.5)
        for name, corners in (("quads", 4), ("triangles", 3)):
            given = getattr(self, name)
            rows = (
                _check.integers(given, name, (None, corners))
                if len(given)
                else np.empty((0, corners), dtype=np.int64)
            )
            object.__setattr__(self, name, rows)
        s = VECTORS[self.element]
        m, k = (len(self.quads), len(self.triangles)) if s > 1 else (0, 0)
        shapes: dict[str, tuple[int | None, ...]] = {
            "quad_sizes": (m, 2),
            "triangle_charts": (k, 3, 2),
            "reference": (None, s, 3),
        }
        for name, shape in shapes.items():
            given = getattr(self, name)
            array = _check.array(given, name, shape) if np.size(given) else np.empty([n or 0 for n in shape])
            object.__setattr__(self, name, array)
        own = 4 * m + 3 * k if np.size(self.turns) else 0
        turns = _check.array(self.turns, "turns", (own, 2, 2)) if own else np.empty((0, 2, 2))
        object.__setattr__(self, "turns", turns)
        n = len(self.reference)
        for name in ("q", "v"):
            object.__setattr__(self, name, _check.array(getattr(self, name), name, (n, s, 3)))
        thickness = _check.array(self.thickness, "thickness", (None,))
        if len(thickness) not in (1, self.elements) or thickness.min() <= 0:
            _check.fail("thickness", thickness, "must be above 0, one number or one for each face")
        object.__setattr__(self, "thickness", thickness)
        if max(self.quads.max(initial=-1), self.triangles.max(initial=-1)) >= n or not self.elements:
            _check.fail("quads", self.quads, f"must be numbers of nodes, 0 to {n - 1}")
        for name in ("groups", "edges"):
            pairs = [(str(key), [int(i) for i in rows]) for key, rows in getattr(self, name)]
            object.__setattr__(self, name, pairs)

    @property
    def vectors(self) -> int:
        """Nodal vectors at each node."""
        return VECTORS[self.element]

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.reference)

    @property
    def elements(self) -> int:
        """Number of faces."""
        return len(self.quads) + len(self.triangles)

    @property
    def r(self) -> FloatArray:
        """Positions of the nodes at the start, (nodes, 3)."""
        return self.q[:, 0]

    @property
    def v_r(self) -> FloatArray:
        """Their velocities, (nodes, 3)."""
        return self.v[:, 0]

    def corners(self, face: int) -> IntArray:
        """Nodes of a face."""
        m = len(self.quads)
        nodes: IntArray = self.quads[face] if face < m else self.triangles[face - m]
        return nodes

    def element_kind(self, face: int) -> str:
        """Name of the face's element in the core."""
        quad = face < len(self.quads)
        if self.element == "membrane":
            return "quad_membrane" if quad else "triangle_membrane"
        if self.element in ("plate", "triangle"):
            return "plate" if quad else "triangle"
        return self.element

    def chart(self, face: int) -> FloatArray:
        """Parameters of a face's corners, (corners, 2)."""
        m = len(self.quads)
        if self.element == "membrane":
            unit = [(0, 0), (1, 0), (1, 1), (0, 1)] if face < m else [(0, 0), (1, 0), (0, 1)]
            return np.array(unit, dtype=np.float64)
        if face >= m:
            chart: FloatArray = self.triangle_charts[face - m]
            return chart
        a, b = self.quad_sizes[face]
        return np.array([(0, 0), (a, 0), (a, b), (0, b)])

    def turn(self, face: int) -> FloatArray | None:
        """Slopes along a face's own parameters in terms of the nodal ones, (corners, 2, 2)."""
        if not len(self.turns):
            return None
        m = len(self.quads)
        first = 4 * face if face < m else m + 3 * face
        return self.turns[first : first + len(self.corners(face))]

    def way(self, face: int, corner: int, step: FloatArray) -> FloatArray:
        """Direction in a face's parameters, in those of the nodal slopes at one of its corners, (2,)."""
        turn = self.turn(face)
        return step if turn is None else turn[corner] @ step

    def shape(self, face: int, at: tuple[float, float]) -> tuple[IntArray, FloatArray]:
        """Numbers of the nodal vectors of a face, and their functions with derivatives (k, 6) at a place."""
        from pliant import _core

        rows = _core.surface_shape(self.element_kind(face), self.chart(face), at)
        turn = self.turn(face)
        if turn is not None:
            by_corner = rows.reshape(len(turn), 3, 6)
            by_corner[:, 1:] = turn @ by_corner[:, 1:]
        index = (self.corners(face)[:, None] * self.vectors + np.arange(self.vectors)).ravel()
        return index, rows

    def place(self, point: Point, vectors: FloatArray | None = None) -> FloatArray:
        """Position of a point, at the start or for nodal vectors (nodes, vectors, 3)."""
        q = self.q if vectors is None else vectors
        if point.node is not None:
            node: FloatArray = q[point.node, 0].copy()
            return node
        index, rows = self.shape(point.element, point.at or (0.0, 0.0))
        place: FloatArray = rows[:, 0] @ q.reshape(-1, 3)[index]
        return place

    def triangulation(self, fine: int) -> tuple[Any, IntArray, Any]:
        """Triangles for pictures, ``fine`` pieces along each side of a face.

        Returns sparse weights of the nodal vectors in the points (p, nodes * vectors), triangles (t, 3) and
        sparse shares of the faces in the points (p, faces).
        """
        from scipy.sparse import coo_array

        keys: dict[tuple[int, ...], int] = {}
        rows: list[IntArray] = []
        columns: list[IntArray] = []
        values: list[FloatArray] = []
        triangles: list[tuple[int, int, int]] = []
        owners: list[tuple[int, int]] = []
        for face in range(self.elements):
            quad = face < len(self.quads)
            nodes = self.corners(face).tolist()
            local: dict[tuple[int, int], int] = {}
            for i in range(fine + 1):
                for j in range(fine + 1 if quad else fine + 1 - i):
                    index, functions = self.shape(face, (i / fine, j / fine))
                    key = _shared_key(nodes, i, j, fine) or (face, i, j)
                    if key not in keys:
                        keys[key] = len(keys)
                        rows.append(np.full(len(index), keys[key]))
                        columns.append(index)
                        values.append(functions[:, 0])
                    local[i, j] = keys[key]
                    owners.append((keys[key], face))
            for i in range(fine):
                for j in range(fine if quad else fine - i):
                    triangles.append((local[i, j], local[i + 1, j], local[i, j + 1]))
                    if (i + 1, j + 1) in local:
                        triangles.append((local[i + 1, j], local[i + 1, j + 1], local[i, j + 1]))
        count = len(keys)
        place = (np.concatenate(rows), np.concatenate(columns))
        weights = coo_array((np.concatenate(values), place), (count, self.nodes * self.vectors)).tocsr()
        point, face_of = np.unique(np.array(owners), axis=0).T
        share = 1.0 / np.bincount(point, minlength=count)[point]
        faces = coo_array((share, (point, face_of)), (count, self.elements)).tocsr()
        return weights, np.array(triangles), faces

    def node_point(self, identity: str, node: int) -> Point:
        """Return the node as a material point."""
        face, corner = self._face_of[node]
        square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
        corner_place = square[corner] if face < len(self.quads) else (square[0], square[1], square[3])[corner]
        return Point(identity, self.name, face, 0.0, node, at=corner_place)

    @cached_property
    def _face_of(self) -> dict[int, Side]:
        """A face of each node, with the corner."""
        found: dict[int, Side] = {}
        for face in range(self.elements):
            for corner, node in enumerate(self.corners(face).tolist()):
                found.setdefault(node, (face, corner))
        return found

    @cached_property
    def sides(self) -> dict[tuple[int, int], list[Side]]:
        """Sides (face, side) over each pair of neighbouring nodes, smaller first."""
        found: dict[tuple[int, int], list[Side]] = defaultdict(list)
        for face in range(self.elements):
            nodes = self.corners(face).tolist()
            for side, (a, b) in enumerate(zip(nodes, nodes[1:] + nodes[:1], strict=True)):
                found[min(a, b), max(a, b)].append((face, side))
        return dict(found)

    def nearest(self, target: FloatArray, identity: str, stress_free: bool = False) -> Point:
        """Point of the surface nearest to a place, at the start or stress-free."""
        q = self.reference if stress_free else self.q
        distance = np.linalg.norm(q[:, 0] - target, axis=1)
        node = int(np.argmin(distance))
        size = float(np.ptp(q[:, 0], axis=0).max())
        if distance[node] <= 1e-9 * size:
            return self.node_point(identity, node)
        quads, triangles = (
            np.flatnonzero((rows == node).any(axis=1)) for rows in (self.quads, self.triangles)
        )
        ring = {node, *self.quads[quads].ravel().tolist(), *self.triangles[triangles].ravel().tolist()}
        near = sorted(ring)
        faces = {
            *np.flatnonzero(np.isin(self.quads, near).any(axis=1)).tolist(),
            *(len(self.quads) + np.flatnonzero(np.isin(self.triangles, near).any(axis=1))).tolist(),
        }
        flat = q.reshape(-1, 3)
        best: tuple[float, int, tuple[float, float]] = (np.inf, 0, (0.0, 0.0))
        for face in sorted(faces):
            best = min(best, self._project(face, target, flat))
        _, face, at = best
        for corner, place in enumerate(self._unit(face)):
            if np.abs(np.subtract(at, place)).max() < 1e-9:
                return self.node_point(identity, int(self.corners(face)[corner]))
        return Point(identity, self.name, face, 0.0, at=at)

    def _unit(self, face: int) -> list[tuple[float, float]]:
        quad = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
        return quad if face < len(self.quads) else [quad[0], quad[1], quad[3]]

    def _project(
        self, face: int, target: FloatArray, flat: FloatArray
    ) -> tuple[float, int, tuple[float, float]]:
        """Nearest place of one face by Gauss-Newton, kept inside: distance, face, place."""
        chart, triangle = self.chart(face), face >= len(self.quads)
        span = chart[[1, 2 if triangle else 3]] - chart[0]
        at = np.array([1 / 3, 1 / 3] if triangle else [0.5, 0.5])
        for _ in range(40):
            index, rows = self.shape(face, (float(at[0]), float(at[1])))
            gap = rows[:, 0] @ flat[index] - target
            tangents = span @ (rows[:, 1:3].T @ flat[index])
            step = np.linalg.lstsq(tangents.T, -gap, rcond=None)[0]
            new = np.clip(at + step, 0.0, 1.0)
            if triangle and new.sum() > 1:
                new = np.clip(new - (new.sum() - 1) / 2, 0.0, 1.0)
                new /= max(1.0, new.sum())
            done = np.abs(new - at).max() < 1e-14
            at = new
            if done:
                break
        index, rows = self.shape(face, (float(at[0]), float(at[1])))
        distance = float(np.linalg.norm(rows[:, 0] @ flat[index] - target))
        return distance, face, (float(at[0]), float(at[1]))

    def path(self, points: FloatArray) -> tuple[list[int], list[Side]]:
        """Nodes and sides of the edge through points of the stress-free surface."""
        r = self.reference[:, 0]
        rim = {pair for pair, sides in self.sides.items() if len(sides) == 1}
        stops: list[int] = []
        for k, point in enumerate(points):
            distance = np.linalg.norm(r - point, axis=1)
            node = int(np.argmin(distance))
            neighbours = [r[a] - r[b] for a, b in self.sides if node in (a, b)]
            spacing = max(float(np.linalg.norm(piece)) for piece in neighbours)
            if distance[node] > 0.5 * spacing * (1 + 1e-9):
                _check.fail(f"points[{k}]", point, f"lies {distance[node]:.3g} m from the nearest node")
            if not stops or stops[-1] != node:
                stops.append(node)
        if len(stops) < 2:
            _check.fail("points", points, "must reach from one node to another")
        nodes = [stops[0]]
        for a, b in pairwise(stops):
            piece = _shortest(rim, r, a, b) or _shortest(set(self.sides), r, a, b)
            if piece is None:
                _check.fail("points", points, "no chain of edges joins these points")
            nodes += piece[1:]
        return nodes, self.sides_along(nodes)

    def sides_along(self, nodes: list[int]) -> list[Side]:
        """Sides of faces along a chain of nodes, one each."""
        sides = []
        for a, b in pairwise(nodes):
            found = self.sides.get((min(a, b), max(a, b)))
            if not found:
                raise ModelError(f"edge: nodes {a} and {b} of '{self.name}' are not neighbours")
            sides.append(found[0])
        return sides

    def sides_running(self, nodes: list[int]) -> tuple[list[Side], bool]:
        """Sides along a chain of nodes that all run as it does, or all against it, and which.

        On a rim a side runs one way only; inside, the faces on both sides of it run it either way.
        """
        with_it: list[Side | None] = []
        against: list[Side | None] = []
        for a, b in pairwise(nodes):
            found: dict[bool, Side] = {}
            for face, side in self.sides.get((min(a, b), max(a, b)), []):
                found.setdefault(int(self.corners(face)[side]) == a, (face, side))
            with_it.append(found.get(True))
            against.append(found.get(False))
        for chain, forwards in ((with_it, True), (against, False)):
            sides = [side for side in chain if side is not None]
            if len(sides) == len(chain):
                return sides, forwards
        raise ModelError(
            f"edge: along the nodes {nodes} of '{self.name}' the surface lies left and right by turns; "
            "give the edge in pieces"
        )


def _shared_key(nodes: list[int], i: int, j: int, fine: int) -> tuple[int, ...] | None:
    """Name of a point on a side, (node, node, pieces from the first), the same for all faces there."""
    k = fine - i - j
    on = [
        (j == 0, 0, 1, i),
        (i == fine, 1, 2, j) if len(nodes) == 4 else (k == 0, 1, 2, j),
        (j == fine, 2, 3, fine - i) if len(nodes) == 4 else (i == 0, 2, 0, fine - j),
        (i == 0, 3, 0, fine - j) if len(nodes) == 4 else (False, 0, 0, 0),
    ]
    for there, a, b, pieces in on:
        if there:
            first, second = nodes[a], nodes[b]
            if pieces in (0, fine):
                return (-1, first if pieces == 0 else second)
            return (-2, first, second, pieces) if first < second else (-2, second, first, fine - pieces)
    return None


def _shortest(pairs: set[tuple[int, int]], r: FloatArray, start: int, end: int) -> list[int] | None:
    """Shortest chain of edges between two nodes."""
    import heapq

    links: dict[int, list[tuple[int, float]]] = defaultdict(list)
    for a, b in pairs:
        length = float(np.linalg.norm(r[a] - r[b]))
        links[a].append((b, length))
        links[b].append((a, length))
    heap: list[tuple[float, int, int]] = [(0.0, start, -1)]
    before: dict[int, int] = {}
    while heap:
        distance, node, previous = heapq.heappop(heap)
        if node in before:
            continue
        before[node] = previous
        if node == end:
            chain = [node]
            while before[chain[-1]] >= 0:
                chain.append(before[chain[-1]])
            return chain[::-1]
        for other, length in links[node]:
            if other not in before:
                heapq.heappush(heap, (distance + length, other, node))
    return None


@dataclass(frozen=True)
class _SurfaceHandle(Handle):
    _body: SurfaceBody

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle) and (self.name, self.identity) == (other.name, other.identity)

    def __hash__(self) -> int:
        return hash((self.name, self.identity))

    def node(self, i: int) -> Point:
        """Node ``i`` of the mesh, counted from 0; negative numbers count from the end."""
        n = self._body.nodes
        i = _check.count(i, "i", at_least=-n, at_most=n - 1)
        return self._body.node_point(self.identity, i % n)

    def at(self, point: ArrayLike) -> Point:
        """Point of the stress-free surface nearest to a place.

        Parameters
        ----------
        point : array_like, shape (3,)
            A place [m].
        """
        return self._body.nearest(_check.vector(point, "point"), self.identity, stress_free=True)

    def edge(self, points: ArrayLike | str) -> Edge:
        """Edge through points of the stress-free surface, or by name.

        Parameters
        ----------
        points : array_like, shape (k, 3), or str
            Two or more places [m], the ends and where needed some between: from each the shortest way along
            the rim leads to the next (inside the surface, where the rim leads nowhere). Or a name: of the
            mesh's edges, ``"u_min"``, ``"u_max"``, ``"v_min"``, ``"v_max"`` of structured ones, or ``"rim"``.

        Returns
        -------
        Edge
            For ``clamp``, ``pin``, ``symmetry``, ``weld`` and edge loads.
        """
        body = self._body
        if isinstance(points, str):
            named = dict(body.edges)
            if points == "rim" and points not in named:
                pairs = [pair for pair, sides in body.sides.items() if len(sides) == 1]
                if not pairs:
                    _check.fail("points", points, "this surface is closed")
                from pliant.mesh import _ordered

                nodes = _ordered(np.array(pairs)).tolist()
            elif points in named:
                nodes = named[points]
            else:
                names = ", ".join(f'"{name}"' for name in [*named, "rim"])
                _check.fail("points", points, f"must be points or one of {names}")
            sides = body.sides_along(nodes)
        else:
            nodes, sides = body.path(_check.points(points, "points", 2))
        return Edge(self.identity, self.name, tuple(nodes), tuple(sides))

    def faces(self, select: Any = None) -> Faces:
        """Faces by name, number or mask; all by default.

        Parameters
        ----------
        select : str or array_like, optional
            Name of a group of the mesh, numbers of faces (quadrilaterals, then triangles), or a mask with
            one flag for each face.
        """
        n = self._body.elements
        if select is None:
            numbers = np.arange(n)
        elif isinstance(select, str):
            named = dict(self._body.groups)
            if select not in named:
                _check.fail("select", select, f"the mesh has the groups {', '.join(named) or 'none'}")
            numbers = np.array(named[select])
        else:
            given = np.asarray(select)
            if given.dtype == bool:
                if given.shape != (n,):
                    _check.fail("select", select, f"a mask must have one flag for each of the {n} faces")
                numbers = np.flatnonzero(given)
            else:
                numbers = np.atleast_1d(_check.integers(np.atleast_1d(given), "select", (None,)))
        if len(numbers) == 0 or numbers.min() < 0 or numbers.max() >= n:
            _check.fail("select", select, f"must be numbers of faces, 0 to {n - 1}")
        return Faces(self.identity, self.name, tuple(int(i) for i in np.unique(numbers)))


class Shell(_SurfaceHandle):
    """A shell of a model: ``node(i)``, ``at(point)``, ``edge(points)``, ``faces(select)``.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    >>> sheet = model.add_shell(pl.Mesh.rectangle(1, 1, divisions=(2, 2)), thickness=1e-3, material=steel)
    >>> print(sheet.at((0.5, 0.5, 0)), "|", sheet.edge([(0, 0, 0), (0, 1, 0)]))
    shell1, node 4 | shell1, edge of 3 nodes from node 0
    """


class Membrane(_SurfaceHandle):
    """A membrane of a model: ``node(i)``, ``at(point)``, ``edge(points)``, ``faces(select)``."""


def make_surface(
    mesh: Any,
    *,
    name: str,
    kind: str,
    element: str,
    thickness: Any,
    material: Any,
    quadrature: str,
    bending: str,
    integrals: str,
    wrinkling: Any,
    initial: Any,
    velocity: Any,
    angular_velocity: Any,
) -> SurfaceBody:
    """Check the arguments of ``add_shell`` and ``add_membrane``."""
    mesh = as_mesh(mesh)
    require_law(material, "a surface", (LinearElastic, SaintVenantKirchhoff, NeoHookean))
    law, residual = "saint_venant_kirchhoff", 0.0
    if isinstance(material, NeoHookean):
        law = "neo_hookean"
    elif kind == "membrane" and wrinkling is not False:
        law = "tension_field"
        residual = 1e-3 if wrinkling is True else _check.number(wrinkling, "wrinkling", at_least=0, at_most=1)
    quadrature = _check.choice(quadrature, "quadrature", QUADRATURES)
    if quadrature == "reduced" and law == "neo_hookean":
        _check.fail("quadrature", quadrature, "goes with Saint Venant-Kirchhoff only, not with NeoHookean")
    count = len(mesh.quads) + len(mesh.triangles)
    if np.ndim(thickness) == 0:
        h = np.array([_check.number(thickness, "thickness", above=0)])
    else:
        h = _check.array(thickness, "thickness", (count,))
        if h.min() <= 0:
            _check.fail("thickness", thickness, "must be above 0")
    element, quads, triangles, sizes, charts, reference, h, source, turns = _discretise(
        mesh, kind, element, h
    )
    if quadrature == "reduced" and kind == "membrane":
        _check.fail("quadrature", quadrature, "is there for shells")
    if _check.choice(integrals, "integrals", INTEGRALS) == "precomputed":
        if law != "saint_venant_kirchhoff":
            _check.fail("integrals", integrals, "goes with a linear material, not with NeoHookean")
        if element not in ("cylindrical", "plate") or len(triangles):
            _check.fail("integrals", integrals, 'is there for the elements "cylindrical" and "plate" only')
    if _check.choice(bending, "bending", BENDINGS) == "simplified":
        if law != "saint_venant_kirchhoff":
            _check.fail("bending", bending, "is for small strains of a linear material, not for NeoHookean")
        if material.retardation_time:
            _check.fail("bending", bending, "goes with materials without retardation_time")
        if not _is_flat(reference):
            _check.fail("bending", bending, "is for surfaces that are flat when stress-free")
    groups = [(key, np.flatnonzero(np.isin(source, rows)).tolist()) for key, rows in mesh.groups.items()]
    body = SurfaceBody(
        name=name,
        kind=kind,
        element=element,
        material=repr(material),
        law=law,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
        density=material.density,
        retardation_time=material.retardation_time,
        residual_stiffness=residual,
        quadrature=quadrature,
        thickness=h,
        quads=quads,
        triangles=triangles,
        quad_sizes=sizes,
        triangle_charts=charts,
        reference=reference,
        q=reference,
        v=np.zeros_like(reference),
        groups=groups,
        edges=[(key, rows.tolist()) for key, rows in mesh.edges.items()],
        turns=turns,
        bending=bending,
        integrals=integrals,
    )
    if initial is not None:
        places = _check.array(initial, "initial", (body.nodes, 3))
        body = replace(body, q=_follow(body, places))
    return _with_velocity(body, velocity, angular_velocity)


class Discretised(NamedTuple):
    """Element, faces, parameters, stress-free nodal vectors; ``source``: the face of the mesh each was."""

    element: str
    quads: IntArray
    triangles: IntArray
    quad_sizes: FloatArray
    triangle_charts: FloatArray
    reference: FloatArray
    thickness: FloatArray
    source: IntArray
    turns: FloatArray = np.empty((0, 2, 2))


def _is_flat(reference: FloatArray) -> bool:
    """Whether all nodal vectors lie in one plane."""
    places = reference[:, 0] - reference[:, 0].mean(axis=0)
    normal = np.linalg.svd(places, full_matrices=False)[2][-1]
    sizes = np.abs(reference).max(axis=(0, 2))
    sizes[0] = np.abs(places).max()
    off = np.abs(np.concatenate([places[:, None], reference[:, 1:]], axis=1) @ normal).max(axis=0)
    return bool(np.all(off <= 1e-9 * np.maximum(sizes, 1e-300)))


def _discretise(mesh: Mesh, kind: str, element: str, h: FloatArray) -> Discretised:
    quads, triangles = mesh.quads, mesh.triangles
    none, no_charts = np.empty((0, 2)), np.empty((0, 3, 2))
    all_faces = np.arange(len(quads) + len(triangles))
    if kind == "membrane":
        reference = mesh.points[:, None]
        return Discretised("membrane", quads, triangles, none, no_charts, reference, h, all_faces)
    words = ("auto", "bicubic", "cylindrical", "plate", "triangle")
    element = _check.choice(element, "element", words)
    if element in ("auto", "bicubic", "cylindrical") and not len(triangles):
        smooth = mesh if mesh.slopes is not None else _rectangles(mesh)
        if smooth is not None:
            assert smooth.slopes is not None
            assert smooth.sizes is not None
            element = "bicubic" if element == "auto" else element
            wanted = VECTORS[element] - 1
            reference = np.concatenate([mesh.points[:, None], smooth.slopes[:, :wanted]], axis=1)
            sizes = smooth.sizes
            return Discretised(element, smooth.quads, triangles, sizes, no_charts, reference, h, all_faces)
    if element in ("bicubic", "cylindrical"):
        _check.fail(
            "element",
            element,
            "needs a mesh with common (u, v) directions: pliant.Mesh.rectangle, grid or surface, or "
            "rectangles in one plane with parallel sides",
        )
    return _plates_and_triangles(mesh, element, h)


def _rectangles(mesh: Mesh) -> Mesh | None:
    """Give slopes to rectangles in one plane with parallel sides; None for other meshes."""
    p = mesh.points[mesh.quads]
    sides = np.roll(p, -1, axis=1) - p
    lengths = np.linalg.norm(sides, axis=2)
    if lengths.min() <= 0:
        return None
    t = sides / lengths[..., None]
    e_u = t[0, 0]
    normal = np.cross(t[0, 0], t[0, 1])
    if np.linalg.norm(normal) < 0.5:
        return None
    normal /= np.linalg.norm(normal)
    e_v = np.cross(normal, e_u)
    # The side of each face that runs along u, by which its corners are turned.
    along = t @ e_u
    first = np.argmax(along, axis=1)
    order = (first[:, None] + np.arange(4)) % 4
    quads = np.take_along_axis(mesh.quads, order, axis=1)
    p = mesh.points[quads]
    expected = np.stack([e_u, e_v, -e_u, -e_v])
    sides = np.roll(p, -1, axis=1) - p
    lengths = np.linalg.norm(sides, axis=2)
    if np.abs(sides / lengths[..., None] - expected).max() > PARALLEL:
        return None
    slopes = np.zeros((len(mesh.points), 3, 3))
    slopes[:, 0], slopes[:, 1] = e_u, e_v
    return Mesh(mesh.points, quads, slopes=slopes, sizes=lengths[:, :2])


def _plates_and_triangles(mesh: Mesh, element: str, h: FloatArray) -> Discretised:
    """Plates, and triangles; quadrilaterals that are no plates are halved.

    In a plane whose rectangles have parallel sides all faces share parameters, else each has its own.
    """
    points, m = mesh.points, len(mesh.quads)
    center = points.mean(axis=0)
    _, spans, axes = np.linalg.svd(points - center, full_matrices=False)
    is_plane = len(spans) < 3 or spans[2] <= PARALLEL * spans[0]
    plates = None
    if is_plane and m and element != "triangle":
        plates = _rectangles(Mesh(points, mesh.quads)) if _all_used(mesh) else _turned(mesh)
    if element == "triangle":
        whole = np.zeros(m, dtype=bool)
    else:
        whole = is_parallelogram(points, mesh.quads) if plates is None else np.ones(m, dtype=bool)
    if element == "plate" and not whole.all():
        _check.fail(
            f"quads[{int(np.argmin(whole))}]",
            mesh.quads[int(np.argmin(whole))],
            'element "plate" needs parallelograms, nearly; "auto" halves other quadrilaterals to triangles',
        )
    quads = mesh.quads[whole] if plates is None else plates.quads
    halves = mesh.quads[~whole][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    triangles = np.vstack([halves, mesh.triangles])
    source = np.concatenate(
        [np.flatnonzero(whole), np.repeat(np.flatnonzero(~whole), 2), m + np.arange(len(mesh.triangles))]
    )
    name = "plate" if len(quads) else "triangle"
    thickness = h if len(h) == 1 else np.ascontiguousarray(h[source])
    if is_plane and (plates is not None or not len(quads)):
        charts, slopes = _plane(mesh, plates, triangles, center, axes)
        sizes = np.empty((0, 2)) if plates is None or plates.sizes is None else plates.sizes
        turns = np.empty((0, 2, 2))
    else:
        slopes, sizes, charts, turns = own_parameters(mesh, quads, triangles)
    reference = np.concatenate([points[:, None], slopes], axis=1)
    return Discretised(name, quads, triangles, sizes, charts, reference, thickness, source, turns)


def _plane(
    mesh: Mesh, plates: Mesh | None, triangles: IntArray, center: FloatArray, axes: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Parameters of triangles in the plane of the mesh, and the slopes there."""
    points = mesh.points
    first = mesh.quads[0] if len(mesh.quads) else mesh.triangles[0]
    normal = np.cross(points[first[1]] - points[first[0]], points[first[2]] - points[first[0]])
    normal /= np.linalg.norm(normal)
    e_u = axes[0] - normal * (axes[0] @ normal)
    if plates is not None and plates.slopes is not None:
        e_u = plates.slopes[0, 0]
    e_u = e_u / np.linalg.norm(e_u)
    e_v = np.cross(normal, e_u)
    uv = np.column_stack([(points - center) @ e_u, (points - center) @ e_v])
    charts = uv[triangles]
    area = np.linalg.det(charts[:, 1:] - charts[:, :1]) if len(triangles) else np.ones(1)
    if area.min() <= 0:
        bad = int(np.argmin(area))
        _check.fail(
            f"triangles[{bad}]", triangles[bad], "all faces must have their corners the same way round"
        )
    return charts, np.tile(np.stack([e_u, e_v]), (len(points), 1, 1))


def _all_used(mesh: Mesh) -> bool:
    return len(np.unique(mesh.quads)) == len(mesh.points)


def _turned(mesh: Mesh) -> Mesh | None:
    """Rectangles among triangles."""
    if not len(mesh.quads):
        return None
    used, inverse = np.unique(mesh.quads, return_inverse=True)
    part = _rectangles(Mesh(mesh.points[used], inverse.reshape(-1, 4)))
    if part is None or part.slopes is None:
        return None
    slopes = np.tile(part.slopes[0], (len(mesh.points), 1, 1))
    return Mesh(mesh.points, used[part.quads], mesh.triangles, slopes=slopes, sizes=part.sizes)


def _follow(body: SurfaceBody, places: FloatArray) -> FloatArray:
    """Nodal vectors at positions unlike the stress-free ones: slopes by the differences between neighbours.

    At each node the map from stress-free to given differences along the edges that meet there, a deformation
    gradient in the sense of least squares, is applied to the slopes; twists follow from the neighbours.
    """
    q = body.reference.copy()
    q[:, 0] = places
    if body.vectors == 1:
        return q
    neighbours: dict[int, list[int]] = defaultdict(list)
    for a, b in body.sides:
        neighbours[a].append(b)
        neighbours[b].append(a)
    gradients = np.empty((body.nodes, 3, 3))
    for node, others in neighbours.items():
        before = body.reference[others, 0] - body.reference[node, 0]
        after = places[others] - places[node]
        gradients[node] = np.linalg.lstsq(before, after, rcond=1e-9)[0]
    for s in range(1, min(body.vectors, 3)):
        q[:, s] = np.einsum("nij,ni->nj", gradients, body.reference[:, s])
    if body.vectors == 4:
        twist = np.zeros((body.nodes, 3))
        count = np.zeros(body.nodes)
        for quad, (a, b) in zip(body.quads, body.quad_sizes, strict=True):
            change = (q[quad[2], 0] - q[quad[1], 0] - q[quad[3], 0] + q[quad[0], 0]) / (a * b)
            twist[quad] += change
            count[quad] += 1
        q[:, 3] = twist / count[:, None]
    return q


def _with_velocity(body: SurfaceBody, velocity: Any, angular_velocity: Any) -> SurfaceBody:
    """Velocities of the nodal vectors from ``velocity`` and ``angular_velocity``."""
    omega = _check.vector(angular_velocity, "angular_velocity")
    v = np.cross(omega, body.q)
    if callable(velocity):

        def field(x: FloatArray) -> FloatArray:
            return _check.array(velocity(x), "velocity(positions)", (len(x), 3))

        size = float(np.ptp(body.r, axis=0).max())
        step = 1e-4 * size / np.sqrt(body.nodes)
        v[:, 0] += field(body.r)
        for s in range(1, min(body.vectors, 3)):
            ahead, behind = (field(body.r + sign * step * body.q[:, s]) for sign in (1.0, -1.0))
            v[:, s] += (ahead - behind) / (2 * step)
        if body.vectors == 4:
            u, w = body.q[:, 1], body.q[:, 2]
            corners = [
                a * b * field(body.r + step * (a * u + b * w)) for a in (-1.0, 1.0) for b in (-1.0, 1.0)
            ]
            v[:, 3] += sum(corners) / (4 * step**2)
    elif velocity is not None and np.ndim(velocity) == 2:
        values = _check.array(velocity, "velocity", (body.nodes, 3))
        moved = _follow(replace(body, reference=body.q), body.r + values)
        v = v + moved - body.q
    elif velocity is not None:
        v[:, 0] += _check.vector(velocity, "velocity")
    return replace(body, v=v)
