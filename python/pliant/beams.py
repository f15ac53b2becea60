"""Beams: what a model keeps of them, and their handle."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from pliant import _check
from pliant.centreline import CentreLine
from pliant.curves import Curve, Line, polyline, smooth
from pliant.errors import ModelError
from pliant.materials import LinearElastic, Material, SaintVenantKirchhoff, require_law
from pliant.points import Handle, Point
from pliant.sections import CrossSection
from pliant.typing import ArrayLike, FloatArray, IntArray

__all__ = ["Beam", "BeamBody", "make_beam"]

LOCKING = ("enhanced", "poisson", "none")
ALONG = 1e-3  # sine of the angle between ``up`` and the tangent below which another axis is taken

LOBATTO = np.array([0.0, 0.5, 1.0])
_INNER, _OUTER = (np.sqrt(5.0 + sign * 2.0 * np.sqrt(10.0 / 7.0)) / 3.0 for sign in (-1.0, 1.0))
GAUSS_3 = 0.5 + 0.5 * np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
GAUSS_5 = 0.5 + 0.5 * np.array([-_OUTER, -_INNER, 0.0, _INNER, _OUTER])


@dataclass(frozen=True, eq=False)
class BeamBody(CentreLine):
    """A beam, discretised; arrays as in the core's document.

    Attributes
    ----------
    lengths : (elements,)
        Lengths along the stress-free line [m].
    reference, q, v : (nodes, 4, 3)
        Position [m] and gradients along x, y and z of the section at each node, stress-free, at the start,
        and velocities.
    stretch : (elements or 1, 3, 3)
        Area [m^2] and shear corrections along y and z at the start, in the middle and at the end of elements.
    bend : (elements or 1, 3, 3)
        I_y, I_z and torsion constant [m^4] at three Gauss points.
    mass : (elements or 1, 5, 3)
        Area, I_y and I_z at five Gauss points.
    section_points : (m, 3)
        Rule over the section, empty for the law of sections.
    radius : (elements,)
        For contact [m].
    outline : (elements or 1, k, 2)
        Corners of the section in its y and z [m], for pictures.
    """

    name: str
    section: str
    material: str
    locking: str
    youngs_modulus: float
    poisson_ratio: float
    density: float
    retardation_time: float
    lengths: FloatArray
    reference: FloatArray
    q: FloatArray
    v: FloatArray
    stretch: FloatArray
    bend: FloatArray
    mass: FloatArray
    section_points: FloatArray
    radius: FloatArray
    outline: FloatArray

    def __post_init__(self) -> None:
        for name in ("name", "section", "material"):
            _check.text(getattr(self, name), name)
        _check.choice(self.locking, "locking", LOCKING)
        for name in ("youngs_modulus", "density"):
            _check.number(getattr(self, name), name, above=0)
        _check.number(self.poisson_ratio, "poisson_ratio", above=-1, below=0.5)
        _check.number(self.retardation_time, "retardation_time", at_least=0)
        object.__setattr__(self, "lengths", _check.array(self.lengths, "lengths", (None,)))
        e = len(self.lengths)
        shapes: dict[str, tuple[int | None, ...]] = {
            **dict.fromkeys(("reference", "q", "v"), (e + 1, 4, 3)),
            "radius": (e,),
        }
        for name, count in (("stretch", 3), ("bend", 3), ("mass", 5)):
            shapes[name] = (1 if len(getattr(self, name)) == 1 else e, count, 3)
        shapes["outline"] = (1 if len(self.outline) == 1 else e, None, 2)
        for name, shape in shapes.items():
            object.__setattr__(self, name, _check.array(getattr(self, name), name, shape))
        given = self.section_points
        points = _check.array(given, "section_points", (None, 3)) if len(given) else np.empty((0, 3))
        object.__setattr__(self, "section_points", points)
        for name in ("lengths", "radius", "stretch", "bend", "mass"):
            if getattr(self, name).size == 0 or getattr(self, name).min() <= 0:
                _check.fail(name, getattr(self, name), "must be above 0")

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.lengths)

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.lengths) + 1

    @property
    def r(self) -> FloatArray:
        """Positions of the nodes at the start, (nodes, 3)."""
        return self.q[:, 0]

    @property
    def t(self) -> FloatArray:
        """Slopes of the centre line there, (nodes, 3)."""
        return self.q[:, 1]

    @property
    def v_r(self) -> FloatArray:
        """Velocities of the nodes at the start, (nodes, 3)."""
        return self.v[:, 0]

    @cached_property
    def element_nodes(self) -> IntArray:
        """First node of each element, (elements,)."""
        return np.arange(self.elements)

    def node_of(self, element: int, end: int) -> int:
        """Node at an end (0 or 1) of an element."""
        return element + end

    def node_point(self, identity: str, node: int) -> Point:
        """Return the node as a material point."""
        element = min(node, self.elements - 1)
        return Point(identity, self.name, element, float(node - element), node, offset=(0.0, 0.0))

    def inner_point(self, identity: str, element: int, xi: float) -> Point:
        """Return a place in an element as a material point."""
        return Point(identity, self.name, element, xi, offset=(0.0, 0.0))

    def weights(self, point: Point) -> tuple[IntArray, FloatArray]:
        """Numbers of nodal vectors (node by node) and their weights in a point's position, (8,) each."""
        first, (r_1, x_1, r_2, x_2) = self.shape(point.element, point.xi)
        y, z = point.offset or (0.0, 0.0)
        a, b = 1.0 - point.xi, point.xi
        return 4 * first + np.arange(8), np.array([r_1, x_1, a * y, a * z, r_2, x_2, b * y, b * z])

    def place(self, point: Point, vectors: FloatArray | None = None) -> FloatArray:
        """Position of a point, at the start or for nodal vectors (nodes, 4, 3)."""
        index, weights = self.weights(point)
        place: FloatArray = weights @ (self.q if vectors is None else vectors).reshape(-1, 3)[index]
        return place


def section_axes(y: FloatArray, z: FloatArray) -> FloatArray:
    """Axes of sections that gradients (n, 3) span, one a row, (n, 3, 3): normal, and two across.

    The latter are orthonormal and as near to ``y`` as to ``z``, which may have sheared.
    """
    normal = _unit(np.cross(y, z))
    across = _unit(y + np.cross(z, normal))
    return np.stack([normal, across, np.cross(normal, across)], axis=-2)


def _unit(x: FloatArray) -> FloatArray:
    unit: FloatArray = x / np.linalg.norm(x, axis=-1, keepdims=True)
    return unit


class Beam(Handle):
    """A beam of a model.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    >>> bar = pl.Rectangle(width=0.02, height=0.04)
    >>> arm = model.add_beam([(0, 0, 0), (1, 0, 0)], elements=4, section=bar, material=steel)
    >>> print(arm.end, "|", arm.at(0.6, offset=(0, 0.02)))
    beam1, node 4 | beam1, element 2 at 0.4, offset (0, 0.02)
    """

    _body: BeamBody

    def __init__(self, name: str, identity: str, body: BeamBody) -> None:
        super().__init__(name, identity)
        object.__setattr__(self, "_body", body)

    def __repr__(self) -> str:
        return f"Beam({self.name!r})"

    @property
    def start(self) -> Point:
        """First end."""
        return self.node(0)

    @property
    def end(self) -> Point:
        """Last end."""
        return self.node(-1)

    @property
    def length(self) -> float:
        """Stress-free length [m]."""
        return float(self._body.lengths.sum())

    def node(self, i: int) -> Point:
        """Node ``i``, counted from 0; negative numbers count from the end.

        Parameters
        ----------
        i : int
            Number of the node; row ``i`` of ``result.positions(body)``.
        """
        n = self._body.nodes
        i = _check.count(i, "i", at_least=-n, at_most=n - 1)
        return self._body.node_point(self.identity, i % n)

    def at(self, s: float, offset: ArrayLike = (0.0, 0.0)) -> Point:
        """Point at an arc length of the stress-free line, on it or beside it in the section there.

        Parameters
        ----------
        s : float
            Arc length from the start [m], from 0 to ``length``.
        offset : array_like, shape (2,)
            Distance from the centre line along the section's y and z [m]; z is nearest to ``up``.
        """
        ends = np.concatenate([[0.0], np.cumsum(self._body.lengths)])
        s = _check.number(s, "s", at_least=0, at_most=float(ends[-1]) * (1 + 1e-12))
        y, z = (float(x) for x in _check.array(offset, "offset", (2,)))
        element = min(max(int(np.searchsorted(ends, s, side="right")) - 1, 0), len(ends) - 2)
        xi = float((s - ends[element]) / self._body.lengths[element])
        for end in (0, 1):
            if abs(xi - end) < 1e-9:
                node = self._body.node_point(self.identity, element + end)
                return node if y == 0.0 == z else replace(node, node=None, offset=(y, z))
        return Point(self.identity, self.name, element, xi, offset=(y, z))


def make_beam(
    points: Any,
    *,
    name: str,
    elements: Any,
    section: Any,
    material: Any,
    up: Any,
    locking: Any,
    initial: Any,
    velocity: Any,
    angular_velocity: Any,
) -> BeamBody:
    """Check the arguments of ``add_beam``."""
    require_law(material, "a beam", (LinearElastic, SaintVenantKirchhoff))
    locking = _check.choice(locking, "locking", LOCKING)
    line = _line_of(points, _check.count(elements, "elements"))
    reference = np.concatenate([line.r[:, None], _frames(line, up, name)], axis=1)
    body = BeamBody(
        name=name,
        locking=locking,
        material=repr(material),
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
        density=material.density,
        retardation_time=material.retardation_time,
        lengths=line.lengths,
        reference=reference,
        q=reference,
        v=np.zeros_like(reference),
        **_sections(section, material, line.lengths, locking),
    )
    if initial is not None:
        places = _check.array(initial, "initial", (body.nodes, 3))
        if np.linalg.norm(np.diff(places, axis=0), axis=1).min() <= 0:
            _check.fail("initial", initial, "neighbouring nodes must lie apart")
        body = replace(body, q=_follow(body, places))
    return _with_velocity(body, velocity, angular_velocity)


def _line_of(points: Any, elements: int) -> Line:
    """One strand along what the user gave as ``points``."""
    if isinstance(points, Curve):
        return smooth(points, elements, False, "straight")
    if callable(points):
        _check.fail("points", points, "must be (n, 3) numbers or pliant.Curve(position, length=...)")
    places = _check.points(points, "points", 2)
    line = polyline(places, elements, False)
    if len(line.strands) > 1:
        pieces = _unit(np.diff(places, axis=0))
        corner = 1 + int(np.argmax(np.linalg.norm(np.diff(pieces, axis=0), axis=1) >= 1e-9))
        _check.fail(
            f"points[{corner}]",
            places[corner],
            "a beam has no corners: add one beam for each straight piece and weld them, or round the corner "
            "in a pliant.Curve",
        )
    return line


def _frames(line: Line, up: Any, name: str) -> FloatArray:
    """Axes of the sections at the nodes, one a row, (nodes, 3, 3)."""
    s = np.concatenate([[0.0], np.cumsum(line.lengths)])
    if callable(up):
        wanted = np.array([_check.vector(up(float(x)), f"up({x:g})") for x in s])
    else:
        wanted = np.tile(_check.vector(up, "up"), (len(s), 1))
    size = np.linalg.norm(wanted, axis=1)
    if size.min() <= 0:
        _check.fail("up", up, "must be longer than 0")
    wanted = wanted / size[:, None]
    off = np.linalg.norm(np.cross(line.t, wanted), axis=1)
    if off.min() < ALONG:
        node = int(np.argmin(off))
        if callable(up) or np.abs(line.t - line.t[0]).max() > 1e-9:
            _check.fail(
                "up",
                wanted[node],
                f"runs along the beam at s = {s[node]:g} m; give a callable of arc length",
            )
        other = np.eye(3)[int(np.argmin(np.abs(line.t[0])))]
        warnings.warn(
            f"beam '{name}': up = {wanted[0].tolist()} runs along the beam; {other.tolist()} is taken",
            stacklevel=4,
        )
        wanted = np.tile(other, (len(s), 1))
    across = _unit(np.cross(wanted, line.t))
    return np.stack([line.t, across, np.cross(line.t, across)], axis=1)


def _sections(section: Any, material: Material, lengths: FloatArray, locking: str) -> dict[str, Any]:
    """Numbers of the sections at the points of the rules, as fields of the body."""
    nu = material.poisson_ratio
    start = np.cumsum(lengths) - lengths

    def numbers(one: Any, name: str) -> tuple[list[float], list[float], list[float]]:
        if not isinstance(one, CrossSection):
            _check.fail(name, one, "must be a section such as pliant.Circle(radius=...)")
        if one.torsion_constant is None:
            _check.fail(name, one, "a beam twists: give torsion_constant=...")
        i_y, i_z = one.second_moments
        if min(i_y, i_z) <= 0:
            _check.fail(name, one, "a beam bends about both axes: second moments must be above 0")
        shear = one._shear_corrections(nu)
        return [one.area, *shear], [i_y, i_z, one.torsion_constant], [one.area, i_y, i_z]

    if callable(section):

        def sample(rule: FloatArray) -> list[list[tuple[CrossSection, str]]]:
            places = start[:, None] + rule * lengths[:, None]
            return [[(section(float(x)), f"section({x:g})") for x in row] for row in places]

        rows = [
            np.array([[numbers(*one)[k] for one in row] for row in sample(rule)])
            for k, rule in enumerate((LOBATTO, GAUSS_3, GAUSS_5))
        ]
        middle = [row[0][0] for row in sample(np.array([0.5]))]
        label = "varying"
    else:
        if isinstance(section, (list, tuple)):
            if len(section) != len(lengths):
                text = f"a list must hold one section for each of {len(lengths)} elements"
                _check.fail("section", section, text)
            middle, label = list(section), "one for each element"
            each = [numbers(one, f"section[{k}]") for k, one in enumerate(middle)]
        else:
            each = [numbers(section, "section")]
            middle, label = [section], repr(section)
        rows = [
            np.repeat(np.array([one[k] for one in each])[:, None], count, axis=1)
            for k, count in enumerate((3, 3, 5))
        ]
    points = None
    if locking != "enhanced":
        points = middle[0]._points() if len(middle) == 1 or label != "varying" else None
        if len(rows[0]) > 1 or points is None:
            text = 'is for one section of known shape all along; take the default, "enhanced"'
            _check.fail("locking", locking, text)
    outlines = [one._outline() for one in middle]
    if len({len(one) for one in outlines}) > 1:
        from pliant.sections import _ring

        outlines = [_ring(float(np.sqrt(one.area / np.pi))) for one in middle]
    radius = [getattr(one, "radius", None) or np.sqrt(one.area / np.pi) for one in middle]
    return {
        "section": label,
        "stretch": rows[0],
        "bend": rows[1],
        "mass": rows[2],
        "section_points": np.empty((0, 3)) if points is None else points,
        "radius": np.broadcast_to(np.array(radius, dtype=np.float64), len(lengths)).copy(),
        "outline": np.array(outlines),
    }


def _slopes(body: BeamBody, values: FloatArray) -> FloatArray:
    """Return derivatives by stress-free arc length of values at the nodes, both (nodes, 3)."""
    from scipy.interpolate import CubicSpline

    s = np.concatenate([[0.0], np.cumsum(body.lengths)])
    if len(s) == 2:
        return np.repeat((values[1:] - values[:1]) / s[1], 2, axis=0)
    slopes: FloatArray = CubicSpline(s, values, axis=0)(s, 1)
    return slopes


def _follow(body: BeamBody, places: FloatArray) -> FloatArray:
    """Nodal vectors at other positions: smooth slopes, sections normal to them and without twist."""
    q = body.reference.copy()
    q[:, 0], q[:, 1] = places, _slopes(body, places)
    turn = np.eye(3)
    for node, (before, after) in enumerate(zip(body.reference[:, 1], q[:, 1], strict=True)):
        # The shortest way from where the section before has turned the tangent to the new one.
        turn = _shortest(turn @ _unit(before), _unit(after)) @ turn
        q[node, 2:] = body.reference[node, 2:] @ turn.T
    return q


def _shortest(a: FloatArray, b: FloatArray) -> FloatArray:
    """Rotation by the shortest way from unit vector a to b."""
    cosine = float(a @ b)
    if cosine < -1 + 1e-12:
        raise ModelError(
            "initial: turns a section by half a turn from one node to the next; take more elements"
        )
    cross = np.cross(a, b)
    x, y, z = cross
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: FloatArray = np.eye(3) + skew + skew @ skew / (1.0 + cosine)
    return turn


def _with_velocity(body: BeamBody, velocity: Any, angular_velocity: Any) -> BeamBody:
    """Velocities of the nodal vectors from ``velocity`` and ``angular_velocity``."""
    omega = _check.vector(angular_velocity, "angular_velocity")
    v = np.cross(omega, body.q)
    if callable(velocity):

        def field(x: FloatArray) -> FloatArray:
            return _check.array(velocity(x), "velocity(positions)", (len(x), 3))

        h = 1e-4 * float(body.lengths.min())
        v[:, 0] += field(body.r)
        for k in (1, 2, 3):
            v[:, k] += (field(body.r + h * body.q[:, k]) - field(body.r - h * body.q[:, k])) / (2 * h)
    elif velocity is not None and np.ndim(velocity) == 2:
        values = _check.array(velocity, "velocity", (body.nodes, 3))
        slopes = _slopes(body, values)
        # Sections turn with the tangent, without spin about it.
        turning = np.cross(body.t, slopes) / (body.t**2).sum(axis=1, keepdims=True)
        v[:, 0] += values
        v[:, 1] += slopes
        for k in (2, 3):
            v[:, k] += np.cross(turning, body.q[:, k])
    elif velocity is not None:
        v[:, 0] += _check.vector(velocity, "velocity")
    return replace(body, v=v)
