"""Bodies: what a model keeps of them, plain arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from pliant import _check
from pliant.beams import BeamBody
from pliant.centreline import CentreLine, hermite
from pliant.curves import Curve, Line, element_nodes, first_nodes, polyline, smooth
from pliant.errors import ModelError
from pliant.materials import BilinearPlastic, LinearElastic, Material, SaintVenantKirchhoff, require_law
from pliant.points import Point, WorldPoint
from pliant.rigid import RigidBodyData
from pliant.sections import require_isotropic
from pliant.signals import Signal
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, IntArray

__all__ = ["LineBody", "MassBody", "hermite"]

# In closed form: numpy.polynomial takes its time to import.
_INNER, _OUTER = (np.sqrt(5.0 + sign * 2.0 * np.sqrt(10.0 / 7.0)) / 3.0 for sign in (-1.0, 1.0))
GAUSS_3 = 0.5 + 0.5 * np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
GAUSS_5 = 0.5 + 0.5 * np.array([-_OUTER, -_INNER, 0.0, _INNER, _OUTER])
LOBATTO_3 = np.array([0.0, 0.5, 1.0])

SLACK_STIFFNESS = 1e-4  # of a cable without compression, relative to tension, as in the core
SLACK_WIDTH = 1e-6  # strain over which it goes slack

CHOICES = {
    "kind": ("cable", "net"),
    "strain": ("green_lagrange", "biot"),
    "integration": ("lobatto", "full"),
    "bending": ("exact", "simplified"),
}


@dataclass(frozen=True, eq=False)
class LineBody(CentreLine):
    """A cable or a net of cables, discretised; arrays as in the core's document.

    Attributes
    ----------
    users : (n,)
        Node of the body for each node of a strand.
    r, t, v_r, v_t : (n, 3)
        Positions [m], slopes by stress-free arc length and their velocities at the start.
    reference_r, reference_t : (n, 3) or None
        The stress-free line where it is curved in the plane of ``normal``.
    rest_length : Signal or None
        Stress-free length over time [m], where a winch changes it; it begins with the sum of ``lengths``.
    yield_strain : float or None
        Strain at which the new line yields; None: never.
    isotropic_hardening, kinematic_hardening : float
        Growth and shift of the elastic range by plastic strain, over Young's modulus.
    """

    name: str
    kind: str
    closed: bool
    section: str
    material: str
    strands: IntArray
    users: IntArray
    r: FloatArray
    t: FloatArray
    v_r: FloatArray
    v_t: FloatArray
    lengths: FloatArray
    axial_stiffness: FloatArray
    bending_stiffness: FloatArray
    mass_per_length: FloatArray
    radius: FloatArray
    strain: str
    integration: str
    bending: str
    tension_only: bool
    retardation_time: float
    normal: FloatArray | None = None
    reference_r: FloatArray | None = None
    reference_t: FloatArray | None = None
    rest_length: Signal | None = None
    yield_strain: float | None = None
    isotropic_hardening: float = 0.0
    kinematic_hardening: float = 0.0

    def __post_init__(self) -> None:
        for name in ("strands", "users"):
            object.__setattr__(self, name, _check.integers(getattr(self, name), name, (None,)))
            if getattr(self, name).min(initial=0) < 0:
                _check.fail(name, getattr(self, name), "must be 0 or more")
        n, e = int((self.strands + 1).sum()), int(self.strands.sum())
        shapes: dict[str, tuple[int | None, ...]] = {
            **dict.fromkeys(("r", "t", "v_r", "v_t"), (n, 3)),
            **dict.fromkeys(("lengths", "radius"), (e,)),
        }
        if self.normal is not None:
            shapes |= {"normal": (3,), "reference_r": (n, 3), "reference_t": (n, 3)}
        for name, points in (
            ("axial_stiffness", 3 if self.integration == "lobatto" else 5),
            ("bending_stiffness", 3),
            ("mass_per_length", 5),
        ):
            shapes[name] = (1,) if np.ndim(getattr(self, name)) == 1 else (e, points)
        for name, shape in shapes.items():
            object.__setattr__(self, name, _check.array(getattr(self, name), name, shape))
        if (
            self.strands.min(initial=1) < 1
            or e < 1
            or len(self.users) != n
            or len(np.unique(self.users)) != self.nodes
        ):
            _check.fail("users", self.users, f"must number {n} nodes of strands")
        for name in ("lengths", "radius", "axial_stiffness", "mass_per_length"):
            if getattr(self, name).min() <= 0:
                _check.fail(name, getattr(self, name), "must be above 0")
        for name in ("name", "section", "material"):
            _check.text(getattr(self, name), name)
        for name in ("closed", "tension_only"):
            _check.flag(getattr(self, name), name)
        for name, words in CHOICES.items():
            _check.choice(getattr(self, name), name, words)
        _check.number(self.retardation_time, "retardation_time", at_least=0)
        if self.yield_strain is not None:
            _check.number(self.yield_strain, "yield_strain", above=0)
        for name in ("isotropic_hardening", "kinematic_hardening"):
            _check.number(getattr(self, name), name, at_least=0)
        length = self.rest_length
        if length is not None and (not isinstance(length, Signal) or length.size != 1):
            _check.fail("rest_length", length, "must be a signal of one component")

    @property
    def axial_points(self) -> int:
        """Points of an element at which the axial law is evaluated; one of them lies in the middle."""
        return len(LOBATTO_3 if self.integration == "lobatto" else GAUSS_5)

    @cached_property
    def elements(self) -> int:
        """Number of elements."""
        return int(self.strands.sum())

    @cached_property
    def nodes(self) -> int:
        """Number of nodes of the body; strands that meet share one."""
        return int(self.users.max()) + 1

    @cached_property
    def first(self) -> IntArray:
        """A strand's node for each node of the body, (nodes,)."""
        return np.unique(self.users, return_index=True)[1].astype(np.int64)

    @cached_property
    def element_nodes(self) -> IntArray:
        """First strand node of each element, (elements,)."""
        return element_nodes(self.strands)

    @cached_property
    def node_places(self) -> tuple[IntArray, IntArray]:
        """Element and end (0 or 1) of each node of the body, (nodes,) each."""
        element = np.searchsorted(self.element_nodes, self.first, side="right") - 1
        return element, self.first - self.element_nodes[element]

    def node_of(self, element: int, end: int) -> int:
        """Node of the body at an end (0 or 1) of an element."""
        return int(self.users[self.element_nodes[element] + end])

    def node_point(self, identity: str, node: int) -> Point:
        """Return the node as a material point."""
        element, end = self.node_places
        return Point(identity, self.name, int(element[node]), float(end[node]), node)

    def inner_point(self, identity: str, element: int, xi: float) -> Point:
        """Return a place in an element as a material point."""
        return Point(identity, self.name, element, xi)

    def inner_nodes(self, node: int) -> IntArray:
        """Strand nodes that a node of the body stands for."""
        return np.flatnonzero(self.users == node)


@dataclass(frozen=True, eq=False)
class MassBody:
    """A lumped mass at a material point, or free."""

    name: str
    mass: float
    at: Point | None
    position: WorldPoint
    velocity: WorldPoint
    radius: float = 0.0

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.number(self.mass, "mass", above=0)
        _check.number(self.radius, "radius", at_least=0)
        for place in (self.position, self.velocity):
            if not isinstance(place, WorldPoint):
                _check.fail("position", place, "must be three numbers")


Body = LineBody | MassBody | RigidBodyData | SurfaceBody | BeamBody


def element_masses(body: LineBody) -> FloatArray:
    """Mass at five Gauss points of each element [kg], (elements, 5)."""
    weights = np.polynomial.legendre.leggauss(5)[1] / 2.0
    return np.broadcast_to(body.mass_per_length, (body.elements, 5)) * weights * body.lengths[:, None]


def stretch_of_force(
    force: FloatArray,
    stiffness: FloatArray,
    strain: str,
    tension_only: bool = False,
    yielding: tuple[float, float] = (np.inf, 1.0),
) -> FloatArray:
    """Stretch at which the axial force EA n(eps) deps/dlambda has the given value, by Newton's method.

    eps is (lambda^2 - 1) / 2 (Green-Lagrange) or lambda - 1 (Biot); n(eps) is the elastic strain, or the
    smooth passage to slack. ``yielding``: strain at which the line yields, and the part of further strain
    that is elastic.

    Examples
    --------
    >>> stretch_of_force(np.array([10.0]), np.array([1000.0]), "biot")
    array([1.01])
    """
    load = force / stiffness
    stretch: FloatArray = 1.0 + load + (SLACK_WIDTH if tension_only else 0.0)
    for _ in range(60):
        if strain == "green_lagrange":
            eps, rate, bend = (stretch**2 - 1) / 2, stretch, 1.0
        else:
            eps, rate, bend = stretch - 1, np.ones_like(stretch), 0.0
        start, part = yielding
        share = np.where(eps > start, part, 1.0)
        eps = eps - (1.0 - part) * np.maximum(eps - start, 0.0)
        value, slope = eps, share
        if tension_only:
            root = np.sqrt(eps**2 + SLACK_WIDTH**2)
            value = (1 - SLACK_STIFFNESS) / 2 * (eps + root - SLACK_WIDTH) + SLACK_STIFFNESS * eps
            slope = share * ((1 - SLACK_STIFFNESS) / 2 * (1 + eps / root) + SLACK_STIFFNESS)
        change = (value * rate - load) / (slope * rate**2 + value * bend)
        stretch = stretch - change
        if np.abs(change).max(initial=0.0) <= np.finfo(float).eps:
            break
    return stretch


def _yielding(material: Material) -> tuple[float, float]:
    """Strain at which a material yields, and the part of further strain that is elastic."""
    if not isinstance(material, BilinearPlastic):
        return np.inf, 1.0
    return material.yield_strain, material.tangent_modulus / material.youngs_modulus


def _hardening(material: Material) -> dict[str, float]:
    """Give what a line body keeps of a material that yields."""
    if not isinstance(material, BilinearPlastic):
        return {}
    return {
        "yield_strain": material.yield_strain,
        f"{material.hardening}_hardening": material.hardening_modulus / material.youngs_modulus,
    }


def _require_carried(
    pretension: FloatArray, stiffness: FloatArray, name: str, yielding: tuple[float, float]
) -> None:
    """Refuse a tension that a line without hardening never reaches."""
    start, part = yielding
    most = np.min(stiffness) * start
    if part == 0.0 and np.max(pretension, initial=0.0) >= most:
        _check.fail(name, pretension.tolist(), f"must be below {most:.6g} N, where the cable yields for good")


def _stiffness(
    section: Any, material: Material, line: Line, integration: str
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, str]:
    """Return EA, EI, mass per length, radius and a label of what the user gave as ``section``."""
    modulus, density = material.youngs_modulus, material.density
    elements = len(line.lengths)
    axial = LOBATTO_3 if integration == "lobatto" else GAUSS_5
    if callable(section):
        start = np.cumsum(line.lengths) - line.lengths

        def sample(places: FloatArray) -> list[list[Any]]:
            s = start[:, None] + places * line.lengths[:, None]
            return [[require_isotropic(section(float(x)), f"section({x:g})") for x in row] for row in s]

        areas = np.array([[c.area for c in row] for row in sample(axial)])
        moments = np.array([[c.second_moments[0] for c in row] for row in sample(GAUSS_3)])
        inertias = np.array([[c.area for c in row] for row in sample(GAUSS_5)])
        middle = [row[0] for row in sample(np.array([0.5]))]
        label = "varying"
    elif isinstance(section, (list, tuple)):
        if len(section) != elements:
            _check.fail("section", section, f"a list must hold one section for each of {elements} elements")
        middle = [require_isotropic(c, f"section[{k}]") for k, c in enumerate(section)]
        areas = np.repeat([[c.area] for c in middle], len(axial), axis=1)
        moments = np.repeat([[c.second_moments[0]] for c in middle], 3, axis=1)
        inertias = np.repeat([[c.area] for c in middle], 5, axis=1)
        label = "one for each element"
    else:
        one = require_isotropic(section, "section")
        middle = [one] * elements
        areas, moments, inertias = (np.array([x]) for x in (one.area, one.second_moments[0], one.area))
        label = repr(one)
    radius = np.array([c.radius if c.radius is not None else np.sqrt(c.area / np.pi) for c in middle])
    return modulus * areas, modulus * moments, density * inertias, radius, label


def make_line_body(
    line: Line,
    *,
    name: str,
    kind: str,
    closed: bool,
    section: Any,
    material: Any,
    stretch_lengths: FloatArray | None,
    pretension: FloatArray | None,
    pretension_name: str = "pretension",
    tension_only: Any,
    strain: Any,
    integration: Any,
    bending: Any,
    initial: Any,
    velocity: Any,
    angular_velocity: Any,
    rest_length: Signal | None = None,
) -> LineBody:
    """Discretise: stress-free lengths from the rest length or pretension of each strand, then the start."""
    strain, integration, bending = (
        _check.choice(value, name, CHOICES[name])
        for name, value in (("strain", strain), ("integration", integration), ("bending", bending))
    )
    require_law(material, "a cable", (LinearElastic, SaintVenantKirchhoff, BilinearPlastic))
    yielding = _yielding(material)
    axial, bend, mass, radius, label = _stiffness(section, material, line, integration)
    stretch = np.ones(len(line.lengths))
    if stretch_lengths is not None:
        strand = np.add.reduceat(line.lengths, np.concatenate([[0], np.cumsum(line.strands)[:-1]]))
        stretch = np.repeat(strand / stretch_lengths, line.strands)
    elif pretension is not None:
        middle = axial if axial.ndim == 1 else axial[:, axial.shape[1] // 2]
        _require_carried(pretension, middle, pretension_name, yielding)
        stretch = stretch_of_force(
            np.repeat(pretension, line.strands),
            np.broadcast_to(middle, stretch.shape),
            strain,
            _check.flag(tension_only, "tension_only"),
            yielding,
        )
    uniform = bool(np.all(np.abs(stretch - stretch[0]) < 1e-14))
    if line.normal is not None and not uniform:
        raise ModelError(
            f"{pretension_name} = {pretension}: with a varying section a line that is curved at rest has no "
            'exact stress-free shape; take rest="straight" or rest_length'
        )
    mass = mass * stretch[0] if uniform else np.broadcast_to(mass, (len(stretch), 5)) * stretch[:, None]
    first = element_nodes(line.strands)
    weight = np.zeros(len(line.r))
    total = np.zeros(len(line.r))
    for end in (0, 1):
        weight[first + end] += 1.0
        total[first + end] += stretch
    lengths = line.lengths / stretch
    body = LineBody(
        name=name,
        kind=kind,
        closed=closed,
        section=label,
        material=repr(material),
        strands=line.strands,
        users=line.users,
        r=line.r,
        t=line.t * (total / weight)[:, None],
        v_r=np.zeros_like(line.r),
        v_t=np.zeros_like(line.r),
        lengths=lengths,
        axial_stiffness=axial,
        bending_stiffness=bend,
        mass_per_length=mass,
        radius=radius,
        strain=strain,
        integration=integration,
        bending=bending,
        tension_only=_check.flag(tension_only, "tension_only"),
        retardation_time=material.retardation_time,
        normal=line.normal,
        reference_r=None if line.normal is None else line.r / stretch[0],
        reference_t=None if line.normal is None else line.t,
        rest_length=rest_length,
        **_hardening(material),
    )
    body = _with_initial(body, initial)
    return _with_velocity(body, velocity, angular_velocity)


def _with_initial(body: LineBody, initial: Any) -> LineBody:
    """Nodes moved to ``initial`` (nodes, 3), slopes by cubic splines along each strand."""
    if initial is None:
        return body
    places = _check.array(initial, "initial", (body.nodes, 3))[body.users]
    if body.normal is not None and np.abs((places - body.r) @ body.normal).max() > 1e-9 * body.lengths.sum():
        _check.fail("initial", initial, f"must stay in the plane of the line, normal {body.normal}")
    return replace(body, r=places, t=_slopes(body, places))


def _slopes(body: LineBody, values: FloatArray) -> FloatArray:
    """Return derivatives by stress-free arc length of values at the strand nodes, both (n, 3)."""
    from scipy.interpolate import CubicSpline

    starts = first_nodes(body.strands)
    slopes = np.empty_like(values)
    elements = np.concatenate([[0], np.cumsum(body.strands)])
    for k in range(len(body.strands)):
        nodes = slice(starts[k], starts[k + 1])
        s = np.concatenate([[0.0], np.cumsum(body.lengths[elements[k] : elements[k + 1]])])
        if len(s) == 2:
            slopes[nodes] = (values[nodes][1] - values[nodes][0]) / s[1]
        else:
            slopes[nodes] = CubicSpline(s, values[nodes], axis=0)(s, 1)
    return slopes


def _with_velocity(body: LineBody, velocity: Any, angular_velocity: Any) -> LineBody:
    """Velocities of nodes and slopes from ``velocity`` and ``angular_velocity``."""
    omega = _check.vector(angular_velocity, "angular_velocity")
    if velocity is None and not omega.any():
        return body
    v_r = np.cross(omega, body.r)
    v_t = np.cross(omega, body.t)
    if callable(velocity):

        def field(x: FloatArray) -> FloatArray:
            return _check.array(velocity(x), "velocity(positions)", (len(x), 3))

        h = 1e-4 * float(body.lengths.min())
        v_r = v_r + field(body.r)
        v_t = v_t + (field(body.r + h * body.t) - field(body.r - h * body.t)) / (2 * h)
    elif velocity is not None and np.ndim(velocity) == 2:
        values = _check.array(velocity, "velocity", (body.nodes, 3))[body.users]
        v_r, v_t = v_r + values, v_t + _slopes(body, values)
    elif velocity is not None:
        v_r = v_r + _check.vector(velocity, "velocity")
    if body.normal is not None and np.abs(v_r @ body.normal).max() > 1e-9 * np.abs(v_r).max():
        _check.fail("velocity", velocity, f"must lie in the plane of the line, normal {body.normal}")
    return replace(body, v_r=v_r, v_t=v_t)


def line_of(points: Any, elements: Any, closed: bool, rest: str) -> Line:
    """Line of a cable from what the user gave as ``points``."""
    elements = _check.count(elements, "elements")
    if isinstance(points, Curve):
        return smooth(points, elements, closed, rest)
    if callable(points):
        _check.fail("points", points, "must be (n, 3) numbers or pliant.Curve(position, length=...)")
    return polyline(_check.points(points, "points", 2), elements, closed)


def line_of_net(points: Any, edges: Any, elements: Any) -> tuple[Line, FloatArray]:
    """Line of a net, one strand for each row of edges; nodes of the body: the points, then those between."""
    points = _check.points(points, "points", 2)
    edges = _check.integers(edges, "edges", (None, 2))
    if len(edges) == 0:
        _check.fail("edges", edges, "must have at least one row (i, j)")
    if edges.min() < 0 or edges.max() >= len(points):
        row = int(np.flatnonzero((edges < 0).any(axis=1) | (edges >= len(points)).any(axis=1))[0])
        _check.fail(f"edges[{row}]", edges[row], f"must be numbers of points, 0 to {len(points) - 1}")
    pieces = points[edges[:, 1]] - points[edges[:, 0]]
    lengths = np.linalg.norm(pieces, axis=1)
    if lengths.min() <= 1e-9 * np.abs(points - points[0]).max():
        row = int(np.argmin(lengths))
        _check.fail(f"edges[{row}]", edges[row], "joins a point with itself or with one at the same place")
    unused = np.setdiff1d(np.arange(len(points)), edges)
    if len(unused):
        _check.fail(
            f"points[{unused[0]}]", points[unused[0]], "no row of edges uses this point; leave it out"
        )
    counts = (
        np.full(len(edges), _check.count(elements, "elements"))
        if np.ndim(elements) == 0
        else _check.integers(elements, "elements", (len(edges),))
    )
    if counts.min() < 1 or counts.sum() > _check.LARGEST_COUNT:
        _check.fail("elements", elements, "must be at least 1 for each edge, and at most 1e8 in all")
    starts = first_nodes(counts)
    n = int(starts[-1])
    strand = np.repeat(np.arange(len(edges)), counts + 1)
    x = (np.arange(n) - starts[strand]) / counts[strand]
    r = points[edges[strand, 0]] + x[:, None] * pieces[strand]
    users = np.full(n, -1)
    users[starts[:-1]], users[starts[1:] - 1] = edges[:, 0], edges[:, 1]
    r[starts[1:] - 1] = points[edges[:, 1]]
    inside = users < 0
    users[inside] = len(points) + np.arange(int(inside.sum()))
    t = (pieces / lengths[:, None])[strand]
    return Line(counts, users, r, t, np.repeat(lengths / counts, counts)), lengths
