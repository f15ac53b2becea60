"""Obstacles, and pairs that may touch."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.curves import Curve
from pliant.friction import Coulomb, Friction, LuGre
from pliant.points import Point
from pliant.shapes import Box, Capsule, Cylinder, Shape, Sphere
from pliant.typing import FloatArray, IntArray, Json

__all__ = ["Bore", "ContactData", "HalfSpace", "ObstacleData", "TriangleMesh"]

POISSON_RATIO = 0.4  # of the default stiffness, which hardly depends on it
RAMP = 0.005  # penetration at which the full stiffness is reached, over the radius
DAMPING = 3.0
NUDGE = 1e-6  # by which ends of strands are moved inwards, over the length of an element
STANDARD_GRAVITY = 9.80665
FINEST = 10_000  # places along the line of a bore that are compared with each other


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """All on one side of a plane, as an obstacle: the ground, a wall.

    Parameters
    ----------
    normal : array_like, shape (3,)
        Normal of the plane, away from the obstacle; of any length.

    Examples
    --------
    >>> HalfSpace(normal=(0, 0, 2)).normal.tolist()
    [0.0, 0.0, 1.0]
    """

    normal: Any = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        normal = _check.vector(self.normal, "normal")
        length = float(np.linalg.norm(normal))
        if length == 0.0:
            _check.fail("normal", self.normal, "must not vanish")
        object.__setattr__(self, "normal", normal / length)


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """A surface of triangles, as an obstacle: terrain, a mould, a part read from a file.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Corners [m].
    triangles : array_like, shape (m, 3)
        Numbers of three points for each triangle, counter-clockwise seen from outside, so that neighbours go
        along their common side in opposite ways. The surface may be closed or, like a terrain, have a rim;
        behind it all is solid.

    Examples
    --------
    >>> slope = TriangleMesh([(0, 0, 0), (2, 0, 1), (2, 3, 1), (0, 3, 0)], [(0, 1, 2), (0, 2, 3)])
    >>> slope.triangles.shape
    (2, 3)
    """

    points: Any
    triangles: Any

    def __post_init__(self) -> None:
        points = _check.array(self.points, "points", (None, 3))
        triangles = _check.integers(self.triangles, "triangles", (None, 3))
        if not len(triangles) or triangles.min() < 0 or triangles.max() >= len(points):
            _check.fail("triangles", self.triangles, f"must be numbers of points, 0 to {len(points) - 1}")
        a, b, c = (points[triangles[:, k]] for k in range(3))
        flat = np.linalg.norm(np.cross(b - a, c - a), axis=1) <= 1e-14 * float(np.ptp(points)) ** 2
        if flat.any():
            bad = int(np.argmax(flat))
            _check.fail("triangles", triangles[bad].tolist(), f"triangle {bad} has no area")
        _check_turned(triangles)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "triangles", triangles)


def _check_turned(triangles: IntArray) -> None:
    """Refuse neighbours that are turned against each other: one of them would be solid in front."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(triangles)
    sides = np.concatenate([np.roll(triangles, -k, axis=1)[:, :2] for k in range(3)])
    owner = np.tile(np.arange(count), 3)
    _, which, uses = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(which.ravel(), kind="stable")
    # Where more than two meet none is the neighbour of another.
    first = (np.cumsum(uses) - uses)[uses == 2]
    one, two = order[first], order[first + 1]
    same = sides[one, 0] == sides[two, 0]
    if not same.any():
        return
    # Each triangle as it is, and turned.
    rows = np.concatenate([owner[one], owner[one] + count])
    columns = np.concatenate([owner[two] + count * same, owner[two] + count * ~same])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count))
    part = connected_components(graph, directed=False)[1]
    worst = int(np.argmax(same))
    a, b = sorted((int(owner[one[worst]]), int(owner[two[worst]])))
    if part[a] == part[a + count]:
        remedy = "the surface has one side only, like Möbius' band; cut it open"
    else:
        halves = [np.flatnonzero(part[:count] == part[k]).tolist() for k in (a, a + count)]
        remedy = f"turn {reprlib.repr(min(reversed(halves), key=len))}, their corners in reverse order"
    _check.fail(
        "triangles",
        triangles[[a, b]].tolist(),
        f"triangles {a} and {b} are neighbours and turned against each other; {remedy}",
    )


@dataclass(frozen=True, eq=False)
class Bore:
    """A channel along a line, touched from inside, as an obstacle: a tube, a vessel, a cable guide.

    All around it is solid, and beyond the ends of its line it goes on straight.

    Parameters
    ----------
    line : Curve, or array_like of shape (n, 3)
        Its middle line [m]: a curve, or two or more points that a smooth line is laid through.
    radius : float
        Inner radius [m]; the line must not bend as sharply, nor the channel run into itself.
    tangents : array_like, shape (n, 3), optional
        Directions of the line at the points, of any length; None: those of a cubic spline.
    pieces : int
        Cubic pieces that a curve is made of; their distance from an arc is a 2e-3 of its radius times the
        fourth power of the angle of one.

    Examples
    --------
    A quarter of a ring:

    >>> import numpy as np
    >>> arc = Curve(lambda s: (np.sin(s), 1.0 - np.cos(s), 0.0), length=np.pi / 2)
    >>> Bore(arc, radius=0.05, pieces=16).line.shape
    (17, 3)
    """

    line: Any
    radius: float
    tangents: Any = None
    pieces: int = 64

    def __post_init__(self) -> None:
        radius = _check.number(self.radius, "radius", above=0)
        pieces = _check.count(self.pieces, "pieces", at_least=1)
        if isinstance(self.line, Curve):
            if self.tangents is not None:
                _check.fail("tangents", self.tangents, "come from the curve; leave them out")
            s = np.linspace(0.0, self.line.length, pieces + 1)
            points = self.line.sample(s)
            tangents = self.line.tangents(s, self.line.length / pieces)
        else:
            points = _check.array(self.line, "line", (None, 3))
            if len(points) < 2:
                _check.fail("line", self.line, "must have two points or more")
            steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
            if steps.min() <= 1e-9 * float(np.ptp(points)):
                k = int(np.argmin(steps))
                _check.fail(f"line[{k + 1}]", points[k + 1], f"coincides with line[{k}]; leave one out")
            if self.tangents is None:
                tangents = _spline_tangents(points, steps)
            else:
                tangents = _check.array(self.tangents, "tangents", (len(points), 3))
            size = np.linalg.norm(tangents, axis=1, keepdims=True)
            if size.min() == 0.0:
                _check.fail("tangents", self.tangents, "must not vanish")
            # Those of a file are unit vectors but for rounding, and stay as they are.
            tangents = tangents / np.where(np.abs(size - 1.0) < 1e-12, 1.0, size)
        for name, value in (("line", points), ("radius", radius), ("tangents", tangents)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "pieces", len(points) - 1)
        sharpest = self._sharpest()
        if sharpest * radius >= 1.0:
            _check.fail(
                "radius",
                radius,
                f"must be below the least radius of curvature of the line, {1 / sharpest:g} m",
            )
        self._check_apart()

    @property
    def lengths(self) -> FloatArray:
        """Lengths of the pieces, as arcs between their tangents [m], shape (n - 1,)."""
        chords = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
        cosine = np.clip(np.einsum("ij,ij->i", self.tangents[:-1], self.tangents[1:]), -1.0, 1.0)
        half = 0.5 * np.arccos(cosine)
        lengths: FloatArray = chords / np.sinc(half / np.pi)
        return lengths

    def _slopes(self) -> FloatArray:
        """Coefficients of the line's derivatives by xi, ascending, shape (3, n - 1, 3)."""
        chord = np.diff(self.line, axis=0)
        t, u = (self.tangents[k : len(chord) + k] * self.lengths[:, None] for k in (0, 1))
        return np.stack([t, 2 * (3 * chord - 2 * t - u), 3 * (t + u - 2 * chord)])

    def _sharpest(self) -> float:
        """Largest curvature of the line [1/m]."""
        from numpy.polynomial.polynomial import polyder, polymul, polyroots, polysub, polytrim, polyval

        a, b, c = self._slopes()
        # Slope times its derivative: the cubic terms cancel.
        turn = np.stack([np.cross(a, b), 2 * np.cross(a, c), np.cross(b, c)])
        largest = 0.0
        for piece in range(self.pieces):
            speed, turned = (_square(x[:, piece]) for x in (np.stack([a, b, c]), turn))
            # kappa^2 = turned / speed^3 is largest at an end or where its derivative vanishes.
            rising = polysub(polymul(polyder(turned), speed), 3 * polymul(turned, polyder(speed)))
            roots = polyroots(polytrim(rising, 1e-14 * np.abs(rising).max()))
            # Of a double root rounding makes a pair beside the axis.
            xi = np.clip(np.concatenate([[0.0, 1.0], roots.real]), 0.0, 1.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                squares = polyval(xi, turned) / polyval(xi, speed) ** 3
            largest = max(largest, float(np.nan_to_num(squares, nan=np.inf, posinf=np.inf).max()))
        return float(np.sqrt(largest))

    def _check_apart(self) -> None:
        """Refuse a channel that runs into itself."""
        from scipy.spatial import KDTree

        # Half a turn on, a line that bends less sharply than the radius is two radii away (Schur 1921).
        ends = np.concatenate([[0.0], np.cumsum(self.lengths)])
        fine = min(int(8 * ends[-1] / self.radius) + 2, FINEST)
        s = np.linspace(0.0, ends[-1], fine)
        piece = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, self.pieces - 1)
        xi = ((s - ends[piece]) / self.lengths[piece])[:, None]
        a, b, c = self._slopes()[:, piece]
        points = self.line[piece] + (a + (b / 2 + c / 3 * xi) * xi) * xi
        spacing = float(np.linalg.norm(np.diff(points, axis=0), axis=1).max())
        near = 2 * self.radius - spacing
        if near <= 0.0:
            return
        first, second = KDTree(points).query_pairs(near, output_type="ndarray").T
        along = np.abs(s[second] - s[first])
        if np.linalg.norm(points[-1] - points[0]) <= 1e-9 * ends[-1]:
            along = np.minimum(along, ends[-1] - along)
        bad = along > np.pi * self.radius + spacing
        if bad.any():
            k = int(np.argmax(bad))
            least = float(np.linalg.norm(points[first[bad]] - points[second[bad]], axis=1).min())
            _check.fail(
                "radius",
                self.radius,
                f"the channel runs into itself, {s[first[k]]:.3g} m and {s[second[k]]:.3g} m along the line: "
                f"must be below {least / 2:.3g} m, half of the distance there",
            )


def _square(x: FloatArray) -> FloatArray:
    """Square of a vector of polynomials (k, 3), ascending."""
    square: FloatArray = np.sum([np.convolve(x[:, c], x[:, c]) for c in range(3)], axis=0)
    return square


def _spline_tangents(points: FloatArray, steps: FloatArray) -> FloatArray:
    """Directions of a cubic spline through the points (n, 3)."""
    if len(points) == 2:
        return np.repeat(points[1:] - points[:1], 2, axis=0)
    from scipy.interpolate import CubicSpline

    s = np.concatenate([[0.0], np.cumsum(steps)])
    tangents: FloatArray = CubicSpline(s, points, axis=0)(s, 1)
    return tangents


@dataclass(frozen=True, eq=False)
class ObstacleData:
    """A fixed shape; ``axes`` has the shape's axes as rows."""

    name: str
    shape: Shape | HalfSpace | TriangleMesh | Bore
    position: FloatArray
    axes: FloatArray

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        if not isinstance(self.shape, (Shape, HalfSpace, TriangleMesh, Bore)):
            _check.fail("shape", self.shape, "must be a shape")
        object.__setattr__(self, "position", _check.vector(self.position, "position"))
        object.__setattr__(self, "axes", _check.array(self.axes, "axes", (3, 3)))

    def document(self) -> Json:
        """Write the obstacle as the core reads it."""
        shape = self.shape
        axes = self.axes
        if isinstance(shape, HalfSpace):
            axes = frame(axes.T @ shape.normal)
        kind = shape_document(shape)
        return {"kind": "shape", "origin": self.position.tolist(), "axes": axes.tolist(), "shape": kind}


def shape_document(shape: Shape | HalfSpace | TriangleMesh | Bore) -> Json:
    """Write a shape in its own frame."""
    if isinstance(shape, HalfSpace):
        return {"kind": "half_space"}
    if isinstance(shape, TriangleMesh):
        return {
            "kind": "mesh",
            "points": shape.points.ravel().tolist(),
            "triangles": [float(k) for k in shape.triangles.ravel()],
        }
    if isinstance(shape, Bore):
        return {
            "kind": "bore",
            "radius": shape.radius,
            "points": shape.line.ravel().tolist(),
            "tangents": shape.tangents.ravel().tolist(),
            "lengths": shape.lengths.tolist(),
        }
    if isinstance(shape, Sphere):
        return {"kind": "sphere", "radius": shape.radius}
    if isinstance(shape, Box):
        return {"kind": "box", "size": np.asarray(shape.size).tolist()}
    assert isinstance(shape, (Cylinder, Capsule))
    name = "cylinder" if isinstance(shape, Cylinder) else "capsule"
    return {"kind": name, "radius": shape.radius, "length": shape.length}


@dataclass(frozen=True)
class ContactData:
    """A pair that may touch; ``b`` is ``a`` where a line touches itself."""

    name: str
    a: str
    b: str
    stiffness: float | None = None
    damping: float | None = None
    friction: Friction | None = None

    def __post_init__(self) -> None:
        for name in ("name", "a", "b"):
            _check.text(getattr(self, name), name)
        if self.stiffness is not None:
            object.__setattr__(self, "stiffness", _check.number(self.stiffness, "stiffness", above=0))
        if self.damping is not None:
            object.__setattr__(self, "damping", _check.number(self.damping, "damping", at_least=0))
        if self.friction is not None and not isinstance(self.friction, (LuGre, Coulomb)):
            _check.fail("friction", self.friction, "must be a pliant.LuGre, a pliant.Coulomb or None")

    def laws(self, bodies: Sequence[LineBody | BeamBody]) -> Json:
        """Numbers of the contact for the lines of it."""
        radius = min(float(body.radius.min()) for body in bodies)
        modulus = 1.0 / sum((1.0 - POISSON_RATIO**2) / effective_modulus(body) for body in bodies)
        return {
            # As stiff as Hertz where two round lines cross.
            "stiffness": modulus / 2.0 if self.stiffness is None else self.stiffness,
            "ramp": RAMP * radius,
            "damping": DAMPING if self.damping is None else self.damping,
            "friction": friction_document(self.friction, radius),
        }


def effective_modulus(body: LineBody | BeamBody) -> float:
    """Young's modulus of a round bar with the axial stiffness of a line [Pa]."""
    if isinstance(body, BeamBody):
        axial = body.youngs_modulus * np.mean(body.mass[..., 0])
    else:
        axial = np.mean(body.axial_stiffness)
    return float(axial / (np.pi * np.mean(body.radius) ** 2))


def frame(normal: FloatArray) -> FloatArray:
    """Axes, one a row, the third of which is ``normal``."""
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first), normal])


def friction_document(law: Friction | None, radius: float) -> Json | None:
    """Write a law with all its coefficients."""
    if law is None:
        return None
    if isinstance(law, Coulomb):
        stiffness = 1e3 * law.coefficient / radius
        return {
            "law": "coulomb",
            "mu": law.coefficient,
            "sigma_0": stiffness,
            "sigma_1": damping_of(stiffness),
        }
    assert isinstance(law, LuGre)
    scaled = law.form == "scaled"
    stiffness = 1e3 * law.static / radius if law.bristle_stiffness is None else law.bristle_stiffness
    damping = law.bristle_damping
    if damping is None:
        damping = damping_of(stiffness) if scaled else 0.0
    return {
        "law": "lugre",
        "mu_s": law.static,
        "mu_d": law.dynamic,
        "v_s": law.stribeck_velocity,
        "alpha": law.exponent,
        "sigma_0": stiffness,
        "sigma_1": damping,
        "sigma_2": law.viscous,
        "v_d": 5.0 * law.stribeck_velocity if law.damping_velocity is None else law.damping_velocity,
        "scaled": scaled,
    }


def damping_of(stiffness: float) -> float:
    """Give a tenth of critical damping for what lies under its own weight [s/m]."""
    return float(0.1 * 2.0 * np.sqrt(stiffness / STANDARD_GRAVITY))


def arc(body: LineBody | BeamBody, point: Point) -> float:
    """Arc length of a point, counted through all strands of its body, inside of its element [m]."""
    xi = min(max(point.xi, NUDGE), 1.0 - NUDGE)
    return float(body.lengths[: point.element].sum() + xi * body.lengths[point.element])


def knots(body: LineBody) -> list[tuple[float, float]]:
    """Pairs of arc lengths, inside of their strands, at which strands of one body meet."""
    ends: dict[int, list[float]] = {}
    node, start = 0, 0.0
    element = 0
    for count in body.strands.tolist():
        lengths = body.lengths[element : element + count]
        stop = start + float(lengths.sum())
        first, last = start + NUDGE * float(lengths[0]), stop - NUDGE * float(lengths[-1])
        for at, here in ((node, first), (node + count, last)):
            ends.setdefault(int(body.users[at]), []).append(here)
        node += count + 1
        element += count
        start = stop
    pairs = [
        (one, other)
        for places in ends.values()
        for i, one in enumerate(places)
        for j, other in enumerate(places)
        if i != j
    ]
    return sorted(set(pairs))
