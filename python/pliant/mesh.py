"""Meshes of surfaces: points, quadrilaterals and triangles, with slopes where the surface is smooth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import ArrayLike, FloatArray, IntArray

__all__ = ["Mesh"]

PARALLEL = 1e-6  # sine of the angle below which directions count as parallel

# Seven-point one-sided first difference, 6th order.
_ONE_SIDED = np.array([-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0]) / 60.0
_CENTRAL = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points joined by quadrilaterals and triangles; the normal follows from the order of their corners.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Points [m].
    quads : array_like of int, shape (m, 4), optional
        Corners of the quadrilaterals, all the same way round.
    triangles : array_like of int, shape (k, 3), optional
        Corners of the triangles.
    slopes : array_like, shape (n, 3, 3), optional
        Derivatives r_u, r_v and r_uv at each point by parameters common to the whole mesh, made by
        :meth:`grid` and :meth:`surface`.
    sizes : array_like, shape (m, 2), optional
        Extent of each quadrilateral in u and v; its corners are (0, 0), (u, 0), (u, v), (0, v).
    groups : mapping of str to array_like of int, optional
        Named faces: numbers of quadrilaterals, then of triangles.
    edges : mapping of str to array_like of int, optional
        Named edges: numbers of points along them.

    Examples
    --------
    >>> import pliant as pl
    >>> square = pl.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], quads=[(0, 1, 2, 3)])
    >>> len(square.points), len(square.quads)
    (4, 1)
    """

    points: FloatArray
    quads: IntArray = field(default_factory=lambda: np.empty((0, 4), dtype=np.int64))
    triangles: IntArray = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    slopes: FloatArray | None = None
    sizes: FloatArray | None = None
    groups: Mapping[str, IntArray] = field(default_factory=dict)
    edges: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points = _check.points(self.points, "points", 3)
        n = len(points)
        object.__setattr__(self, "points", points)
        for name, corners in (("quads", 4), ("triangles", 3)):
            given = getattr(self, name)
            faces = (
                np.empty((0, corners), dtype=np.int64)
                if given is None or len(given) == 0
                else _check.integers(given, name, (None, corners))
            )
            bad = np.flatnonzero(((faces < 0) | (faces >= n)).any(axis=1))
            if len(bad):
                _check.fail(f"{name}[{bad[0]}]", faces[bad[0]], f"must be numbers of points, 0 to {n - 1}")
            same = np.flatnonzero([len(set(row)) < corners for row in faces.tolist()])
            if len(same):
                _check.fail(f"{name}[{same[0]}]", faces[same[0]], "must be different points")
            object.__setattr__(self, name, faces)
        faces_count = len(self.quads) + len(self.triangles)
        if not faces_count:
            _check.fail("quads", self.quads, "a mesh needs at least one quadrilateral or triangle")
        unused = np.setdiff1d(np.arange(n), np.concatenate([self.quads.ravel(), self.triangles.ravel()]))
        if len(unused):
            _check.fail(f"points[{unused[0]}]", points[unused[0]], "no face uses this point; leave it out")
        if (self.slopes is None) != (self.sizes is None):
            _check.fail("sizes", self.sizes, "slopes and sizes come together")
        if self.slopes is not None:
            object.__setattr__(self, "slopes", _check.array(self.slopes, "slopes", (n, 3, 3)))
            sizes = _check.array(self.sizes, "sizes", (len(self.quads), 2))
            if sizes.min(initial=1.0) <= 0:
                _check.fail("sizes", sizes, "must be above 0")
            object.__setattr__(self, "sizes", sizes)
        for name, limit in (("groups", faces_count), ("edges", n)):
            clean = {}
            for key, value in dict(getattr(self, name)).items():
                rows = _check.integers(value, f'{name}["{key}"]', (None,))
                if rows.min(initial=0) < 0 or rows.max(initial=0) >= limit:
                    _check.fail(f'{name}["{key}"]', rows, f"must be from 0 to {limit - 1}")
                clean[_check.text(key, name)] = rows
            object.__setattr__(self, name, clean)

    @classmethod
    def rectangle(cls, width: float, height: float, divisions: tuple[int, int]) -> Mesh:
        """Rectangle in the xy plane with a corner at the origin, normal along z.

        Parameters
        ----------
        width, height : float
            Edges along x and y [m], above 0.
        divisions : (int, int)
            Elements along x and y, (nx, ny). Node (i, j) is number ``i * (ny + 1) + j``; u runs along x, v
            along y.

        Examples
        --------
        >>> import pliant as pl
        >>> pl.Mesh.rectangle(2.0, 1.0, divisions=(4, 2)).points.shape
        (15, 3)
        """
        width = _check.number(width, "width", above=0)
        height = _check.number(height, "height", above=0)
        nx, ny = _divisions(divisions)
        x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1), indexing="ij")
        points = np.stack([x, y, np.zeros_like(x)], axis=-1)
        slopes = np.zeros((nx + 1, ny + 1, 3, 3))
        slopes[..., 0, 0] = slopes[..., 1, 1] = 1.0
        return _structured(points, slopes, np.full(nx, width / nx), np.full(ny, height / ny))

    @classmethod
    def grid(cls, points: ArrayLike) -> Mesh:
        """Smooth surface through structured points, slopes by cubic splines.

        Parameters
        ----------
        points : array_like, shape (nu + 1, nv + 1, 3)
            Points [m]; the normal is along r_u x r_v. Where the first and the last row (or column) coincide
            the surface is closed that way.

        Examples
        --------
        >>> import pliant as pl
        >>> import numpy as np
        >>> u, v = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 2, 9), indexing="ij")
        >>> arched = pl.Mesh.grid(np.stack([u, v, 0.1 * u**2], axis=-1))
        >>> len(arched.quads)
        32
        """
        from scipy.interpolate import CubicSpline

        values = _check.array(points, "points", (None, None, 3))
        if min(values.shape[:2]) < 2:
            _check.fail("points", values.shape, "must be at least (2, 2, 3)")
        size = float(np.ptp(values.reshape(-1, 3), axis=0).max())
        steps, closed, splines = [], [], []
        for axis in (0, 1):
            pieces = np.linalg.norm(np.diff(values, axis=axis), axis=2)
            step = pieces.mean(axis=1 - axis)
            if step.min() <= 1e-9 * size:
                _check.fail("points", values.shape, "neighbouring rows must not coincide")
            first, last = np.take(values, 0, axis), np.take(values, -1, axis)
            loop = len(step) > 2 and bool(np.abs(first - last).max() <= 1e-9 * size)
            steps.append(step)
            closed.append(loop)
            places = np.concatenate([[0.0], np.cumsum(step)])
            splines.append((places, "periodic" if loop else "not-a-knot"))

        def slope(array: FloatArray, axis: int) -> FloatArray:
            places, ends = splines[axis]
            if len(places) == 2:
                return np.broadcast_to(np.diff(array, axis=axis) / places[1], array.shape)
            array = array.copy()
            if ends == "periodic":
                first = [slice(None)] * array.ndim
                last = [slice(None)] * array.ndim
                first[axis], last[axis] = slice(0, 1), slice(-1, None)
                array[tuple(last)] = array[tuple(first)]
            result: FloatArray = CubicSpline(places, array, axis=axis, bc_type=ends)(places, 1)
            return result

        r_u, r_v = slope(values, 0), slope(values, 1)
        slopes = np.stack([r_u, r_v, slope(r_v, 0)], axis=2)
        return _structured(values, slopes, steps[0], steps[1], (closed[0], closed[1]))

    @classmethod
    def surface(
        cls,
        position: Callable[[float, float], ArrayLike],
        u: tuple[float, float],
        v: tuple[float, float],
        divisions: tuple[int, int],
        closed: tuple[bool, bool] = (False, False),
    ) -> Mesh:
        """Sample a smooth surface; slopes and twist by differences of sixth order.

        Parameters
        ----------
        position : callable
            ``position(u, v)``, shape (3,) [m]; the normal is along r_u x r_v.
        u, v : (float, float)
            Ranges of the parameters, ascending.
        divisions : (int, int)
            Elements along u and v.
        closed : (bool, bool)
            Whether the surface closes smoothly on itself along u and v.

        Examples
        --------
        >>> import pliant as pl
        >>> import numpy as np
        >>> def tube(u, v):
        ...     return np.cos(u), np.sin(u), v
        >>> mesh = pl.Mesh.surface(tube, (0, 2 * np.pi), (0, 3), divisions=(16, 4), closed=(True, False))
        >>> len(mesh.points), len(mesh.quads)
        (80, 64)
        """
        if not callable(position):
            _check.fail("position", position, "must be a callable of u and v")
        nu, nv = _divisions(divisions)
        ranges = []
        for name, given in (("u", u), ("v", v)):
            low, high = (float(x) for x in _check.array(given, name, (2,)))
            if not high > low:
                _check.fail(name, given, "must ascend")
            ranges.append((low, high))
        if not isinstance(closed, (tuple, list)) or len(closed) != 2:
            _check.fail("closed", closed, "must be two of True or False")
        loops = tuple(_check.flag(flag, f"closed[{k}]") for k, flag in enumerate(closed))
        places = [np.linspace(low, high, n + 1) for (low, high), n in zip(ranges, (nu, nv), strict=True)]
        weights, offsets = [], []
        for k, (low, high) in enumerate(ranges):
            step = 0.02 * (high - low) / (nu, nv)[k]
            central = np.tile(_CENTRAL, (len(places[k]), 1)), np.tile(np.arange(-3, 4), (len(places[k]), 1))
            w, o = central
            if not loops[k]:
                w[0], o[0] = _ONE_SIDED, np.arange(7)
                w[-1], o[-1] = -_ONE_SIDED, -np.arange(7)
            weights.append(w / step)
            offsets.append(places[k][:, None] + step * o)

        def sample(x: FloatArray, y: FloatArray) -> FloatArray:
            def one(a: float, b: float) -> FloatArray:
                return _check.vector(position(a, b), f"position({a:g}, {b:g})")

            return np.array([[one(float(a), float(b)) for b in y] for a in x])

        points = sample(*places)
        r_u, r_v, r_uv = (np.empty_like(points) for _ in range(3))
        for i in range(nu + 1):
            for j in range(nv + 1):
                patch = sample(offsets[0][i], offsets[1][j])
                r_uv[i, j] = np.einsum("a,b,abk->k", weights[0][i], weights[1][j], patch)
            r_u[i] = np.einsum("a,abk->bk", weights[0][i], sample(offsets[0][i], places[1]))
        for j in range(nv + 1):
            r_v[:, j] = np.einsum("b,abk->ak", weights[1][j], sample(places[0], offsets[1][j]))
        # Parameters that are lengths, on average: slopes of size one.
        scale = [float(np.linalg.norm(r, axis=2).mean()) for r in (r_u, r_v)]
        if min(scale) <= 0:
            _check.fail("position", position, "must depend on u and v")
        slopes = np.stack([r_u / scale[0], r_v / scale[1], r_uv / (scale[0] * scale[1])], axis=2)
        steps = [
            np.full(n, (high - low) / n * s)
            for (low, high), n, s in zip(ranges, (nu, nv), scale, strict=True)
        ]
        return _structured(points, slopes, steps[0], steps[1], (loops[0], loops[1]))


def _divisions(divisions: Any) -> tuple[int, int]:
    if not isinstance(divisions, (tuple, list)) or len(divisions) != 2:
        _check.fail("divisions", divisions, "must be two whole numbers (nu, nv)")
    nu, nv = (_check.count(n, f"divisions[{k}]") for k, n in enumerate(divisions))
    if nu * nv > _check.LARGEST_COUNT:
        _check.fail("divisions", divisions, "at most 1e8 elements")
    return nu, nv


def _structured(
    points: FloatArray,
    slopes: FloatArray,
    u: FloatArray,
    v: FloatArray,
    closed: tuple[bool, bool] = (False, False),
) -> Mesh:
    """Mesh of points (nu + 1, nv + 1, 3) with steps (nu,) and (nv,); rows that close are one."""
    nu, nv = len(u), len(v)
    rows, columns = nu + 1 - closed[0], nv + 1 - closed[1]
    i, j = (x.ravel() for x in np.meshgrid(np.arange(nu), np.arange(nv), indexing="ij"))

    def node(a: IntArray, b: IntArray) -> IntArray:
        return (a % rows) * columns + b % columns

    quads = np.stack([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)], axis=1)
    edges: dict[str, IntArray] = {}
    if not closed[0]:
        edges |= {"u_min": np.arange(columns), "u_max": (rows - 1) * columns + np.arange(columns)}
    if not closed[1]:
        edges |= {"v_min": np.arange(rows) * columns, "v_max": np.arange(rows) * columns + columns - 1}
    return Mesh(
        points[:rows, :columns].reshape(-1, 3),
        quads,
        slopes=slopes[:rows, :columns].reshape(-1, 3, 3),
        sizes=np.stack([u[i], v[j]], axis=1),
        edges=edges,
    )


def as_mesh(mesh: Any) -> Mesh:
    """Return a mesh, also from what meshio read."""
    if isinstance(mesh, Mesh):
        return mesh
    if not (hasattr(mesh, "points") and hasattr(mesh, "cells")):
        _check.fail("mesh", mesh, "must be a pliant.Mesh or a meshio.Mesh")
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    faces: dict[str, list[IntArray]] = {"quad": [], "triangle": []}
    lines: list[IntArray] = []
    sets = dict(getattr(mesh, "cell_sets", {}) or {})
    tags = (getattr(mesh, "cell_data", {}) or {}).get("gmsh:physical")
    names = {
        (int(tag), int(dimension)): name
        for name, (tag, dimension) in (getattr(mesh, "field_data", {}) or {}).items()
    }
    members: dict[str, list[tuple[str, int]]] = {}
    line_members: dict[str, list[IntArray]] = {}
    for block, cells in enumerate(mesh.cells):
        kind, data = cells.type, np.asarray(cells.data, dtype=np.int64)
        if kind not in ("quad", "triangle", "line", "vertex"):
            _check.fail("mesh", kind, "cells must be quad, triangle or line, of first order")
        start = sum(len(x) for x in faces.get(kind, []))
        named = {
            name: np.asarray(rows[block], dtype=np.int64)
            for name, rows in sets.items()
            if not name.startswith("gmsh:") and rows[block] is not None
        }
        if tags is not None:
            dimension = {"line": 1, "vertex": 0}.get(kind, 2)
            for tag in np.unique(tags[block]):
                if (int(tag), dimension) in names:
                    named[names[int(tag), dimension]] = np.flatnonzero(np.asarray(tags[block]) == tag)
        for name, rows in named.items():
            if not len(rows):
                continue
            if kind == "line":
                line_members.setdefault(name, []).append(data[rows])
            elif kind in faces:
                members.setdefault(name, []).extend((kind, start + int(row)) for row in rows)
        if kind in faces:
            faces[kind].append(data)
        elif kind == "line":
            lines.append(data)
    quads = np.vstack([np.empty((0, 4), dtype=np.int64), *faces["quad"]])
    triangles = np.vstack([np.empty((0, 3), dtype=np.int64), *faces["triangle"]])
    used, inverse = np.unique(np.concatenate([quads.ravel(), triangles.ravel()]), return_inverse=True)
    groups = {
        name: np.array([row + (len(quads) if kind == "triangle" else 0) for kind, row in rows])
        for name, rows in members.items()
    }
    edges = {}
    for name, pieces in line_members.items():
        path = _ordered(np.vstack(pieces))
        if np.isin(path, used).all():
            edges[name] = np.searchsorted(used, path)
    split = 4 * len(quads)
    return Mesh(
        points[used],
        inverse[:split].reshape(-1, 4),
        inverse[split:].reshape(-1, 3),
        groups=groups,
        edges=edges,
    )


def _ordered(pairs: IntArray) -> IntArray:
    """Points along a chain of pieces."""
    neighbours: dict[int, list[int]] = {}
    for a, b in pairs.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    ends = [node for node, others in neighbours.items() if len(others) == 1]
    if len(ends) not in (0, 2) or any(len(others) > 2 for others in neighbours.values()):
        raise ModelError("mesh: a named group of lines must be one chain without branches")
    path = [ends[0] if ends else int(pairs[0, 0])]
    last = None
    while True:
        following = [node for node in neighbours[path[-1]] if node != last]
        if not following or (len(path) > 2 and following[0] == path[0]):
            break
        last = path[-1]
        path.append(following[0])
        if len(path) > len(neighbours):
            break
    return np.array(path + ([path[0]] if not ends and path[-1] != path[0] else []), dtype=np.int64)
