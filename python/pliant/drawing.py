"""What results look like: lines, surfaces, solids, markers and arrows, from which every picture is made.

A body of a new kind needs one function here, entered in ``LOOKS``: pictures, pages, films and files for
ParaView show what it returns.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.beams import BeamBody, section_axes
from pliant.bodies import LineBody, MassBody, hermite
from pliant.loads import Force
from pliant.points import Joint, Point
from pliant.rigid import RigidBodyData
from pliant.signals import scaled
from pliant.surfaces import SurfaceBody
from pliant.typing import ArrayLike, FloatArray, IntArray

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = [
    "COLORS",
    "Arrows",
    "Drawing",
    "Lines",
    "Marker",
    "Solid",
    "Surface",
    "arrows",
    "contact_arrows",
    "draw",
    "frames_of",
    "joint_points",
    "up_of",
]

COLORS = {"strain": "axial strain", "axial_force": "axial force [N]", "speed": "speed [m/s]"}
Values = Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Lines:
    """Cables: polylines with a thickness.

    Attributes
    ----------
    points : (frames, p, 3)
        Points along the strands [m], one strand after the other.
    strands : (k,)
        Number of points of each strand.
    radius : float
        Radius [m].
    values : dict of (frames, p) or (frames, p, 3)
        Quantities by name.
    """

    name: str
    points: FloatArray
    strands: IntArray
    radius: float
    values: Values

    @property
    def pieces(self) -> IntArray:
        """First points of the straight pieces, whose second points follow."""
        return np.setdiff1d(np.arange(self.points.shape[1]), np.cumsum(self.strands) - 1)


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface that deforms: points (frames, p, 3), triangles (t, 3), values (frames, p)."""

    name: str
    points: FloatArray
    triangles: IntArray
    values: Values


@dataclass(frozen=True, eq=False)
class Solid:
    """A rigid shape.

    Attributes
    ----------
    points, normals : (p, 3)
        In body axes [m].
    triangles : (t, 3)
        Corners.
    outline : list of (k, 3)
        Edges in body axes [m].
    place : (frames, 3)
        Centre [m].
    axes : (frames, 3, 3)
        Body axes, one a row.
    rates : (frames, 4, 3)
        Velocity of the centre [m/s], rates of the axes [1/s].
    """

    name: str
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    outline: list[FloatArray]
    place: FloatArray
    axes: FloatArray
    rates: FloatArray
    values: Values

    def at(self, frame: int, points: FloatArray | None = None) -> FloatArray:
        """Place points of the body, by default its own, at a time, (p, 3)."""
        own = self.points if points is None else points
        world: FloatArray = self.place[frame] + own @ self.axes[frame]
        return world


@dataclass(frozen=True, eq=False)
class Marker:
    """Points without a size of their own, (frames, p, 3)."""

    name: str
    points: FloatArray
    values: Values = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Arrows:
    """A force over time: kind "force", "reaction", "contact", feet (frames, 3) [m], vectors (frames, 3) [N].

    Those of contact are on the first of the two bodies; where nothing touches they vanish.
    """

    name: str
    kind: str
    feet: FloatArray
    vectors: FloatArray
    moments: FloatArray


Drawing = Lines | Surface | Solid | Marker


def frames_of(result: Result, most: int) -> IntArray:
    """Choose the outputs to draw: at most so many, the first and the last among them, even in time."""
    n = len(result.time)
    if n <= most:
        return np.arange(n)
    wanted = np.linspace(result.time[0], result.time[-1], most)
    return np.unique(np.clip(np.searchsorted(result.time, wanted - 1e-12), 0, n - 1))


def draw(
    result: Result, frames: IntArray, color: str | ArrayLike | None = None, points: int = 4000
) -> list[Drawing]:
    """Every body at these outputs, with about so many points of lines in all.

    ``color`` may be a name, or (n, nodes) values of the only flexible body; these come under the name
    ``"color"``.
    """
    bodies = result.model._bodies
    given: FloatArray | None = None
    if color is not None and not isinstance(color, str):
        flexible = [body for body in bodies.values() if hasattr(body, "nodes")]
        if len(flexible) != 1:
            _check.fail("color", color, f"an array colours a single cable, and the model has {len(flexible)}")
        given = _check.array(color, "color", (len(result.time), flexible[0].nodes))[frames]
    elif color is not None:
        _check.choice(color, "color", COLORS)
    elements = sum(b.elements for b in bodies.values() if isinstance(b, LineBody))
    fine = int(np.clip(points // max(elements, 1), 1, 8))
    return [LOOKS[type(body)](result, name, frames, fine, given) for name, body in bodies.items()]


def _line(result: Result, name: str, frames: IntArray, fine: int, given: FloatArray | None) -> Drawing:
    """Polylines of a cable or a net, ``fine`` pieces an element."""
    body = result._body(name)
    offsets = result._offsets(name)[:, :, None] + np.arange(3)
    first = body.element_nodes
    x = np.arange(fine) / fine
    shape = hermite(x[None, :], body.lengths[:, None])
    ends = np.cumsum(body.strands + 1) - 1
    strands = body.strands * fine + 1
    last = np.cumsum(strands) - 1
    inner = np.setdiff1d(np.arange(int(strands.sum())), last)

    def spread(rows: FloatArray) -> FloatArray:
        values = sum(
            shape[k][None, :, :, None] * rows[:, offsets[first + k // 2, k % 2]][:, :, None, :]
            for k in range(4)
        )
        out = np.empty((len(rows), int(strands.sum()), 3))
        out[:, inner] = np.asarray(values).reshape(len(rows), -1, 3)
        out[:, last] = rows[:, offsets[ends, 0]]
        return out

    def by_element(rows: FloatArray) -> FloatArray:
        out = np.empty((len(rows), int(strands.sum()), *rows.shape[2:]))
        out[:, inner] = np.repeat(rows, fine, axis=1)
        out[:, last] = rows[:, np.cumsum(body.strands) - 1]
        return out

    q, v = result._records.q[frames], result._records.v[frames]
    outputs = result._records.outputs[frames]
    cable = result._lowered.cables[name]
    strain, curvature = result._system.strain(cable, q, outputs)
    velocity = spread(v)
    values = {
        "strain": by_element(strain),
        "axial_force": by_element(result._system.axial_force(cable, q, outputs)),
        "speed": np.linalg.norm(velocity, axis=2),
        "velocity": velocity,
        "curvature": by_element(curvature),
    }
    if given is not None:
        nodes = given[:, body.users]
        out = np.empty((len(frames), int(strands.sum())))
        mixed = (1 - x) * nodes[:, first, None] + x * nodes[:, first + 1, None]
        out[:, inner] = mixed.reshape(len(frames), -1)
        out[:, last] = nodes[:, ends]
        values["color"] = out
    return Lines(name, spread(q), strands, float(body.radius.mean()), values)


def _rigid(result: Result, name: str, frames: IntArray, fine: int, given: FloatArray | None) -> Drawing:
    """Shape of a rigid body, or a marker where it has none."""
    body = result.model._bodies[name]
    assert isinstance(body, RigidBodyData)
    if body.shape is None:
        return _mass(result, name, frames, fine, given)
    index = result._offsets(name) + np.arange(3)
    q, v = (rows[frames][:, index] for rows in (result._records.q, result._records.v))
    surface = body.shape.surface
    weights = np.column_stack([np.ones(len(surface.points)), surface.points])
    velocity = np.einsum("pi,nik->npk", weights, v)
    values = {"speed": np.linalg.norm(velocity, axis=2), "velocity": velocity}
    return Solid(name, *surface, body.shape.outline, q[:, 0], q[:, 1:], v, values)


def _mass(result: Result, name: str, frames: IntArray, fine: int, given: FloatArray | None) -> Drawing:
    """Marker at a point."""
    velocity = result._nodes(name, result._records.v[frames])
    values = {"speed": np.linalg.norm(velocity, axis=2), "velocity": velocity}
    return Marker(name, result._nodes(name, result._records.q[frames]), values)


def _surface(result: Result, name: str, frames: IntArray, fine: int, given: FloatArray | None) -> Drawing:
    """Triangles of a shell or membrane, finer than the elements where these are few."""
    body = result.model._bodies[name]
    assert isinstance(body, SurfaceBody)
    across = max(1, round(float(np.sqrt(body.elements))))
    weights, triangles, face = body.triangulation(1 if body.vectors == 1 else max(1, min(6, 48 // across)))
    index = result._offsets(name)[:, 0][:, None] + np.arange(3)
    q, v = result._records.q[frames][:, index], result._records.v[frames][:, index]
    velocity = np.stack([weights @ one for one in v])
    strain = result._system.surface_strain(result._lowered.surfaces[name], result._records.q[frames])
    mean, half = (strain[..., 0] + strain[..., 1]) / 2, (strain[..., 0] - strain[..., 1]) / 2
    values = {
        "strain": (mean + np.hypot(half, strain[..., 2])) @ face.T,
        "regime": strain[..., 6] @ face.T,
        "speed": np.linalg.norm(velocity, axis=2),
        "velocity": velocity,
    }
    if given is not None:
        shares = abs(weights[:, :: body.vectors])
        values["color"] = given @ np.asarray(shares / shares.sum(axis=1)).T
    return Surface(name, np.stack([weights @ one for one in q]), triangles, values)


def _beam(result: Result, name: str, frames: IntArray, fine: int, given: FloatArray | None) -> Drawing:
    """Outline of the section along the centre line, with both ends closed."""
    body = result.model._bodies[name]
    assert isinstance(body, BeamBody)
    fine = max(1, min(8, 200 // body.elements))
    element = np.append(np.repeat(np.arange(body.elements), fine), body.elements - 1)
    xi = np.append(np.tile(np.arange(fine) / fine, body.elements), 1.0)
    along = hermite(xi, body.lengths[element])
    outline = body.outline[np.minimum(element, len(body.outline) - 1)]
    stations, corners = len(element), outline.shape[1]
    flat = corners == 4  # corners of a polygon with edges: each side has its own points
    ring = np.repeat(np.arange(corners), 2)[1:].tolist() + [0] if flat else list(range(corners))
    y, z = outline[:, ring, 0], outline[:, ring, 1]
    m = len(ring)
    pairs = [(k, k + 1) for k in range(0, m, 2)] if flat else [(k, (k + 1) % m) for k in range(m)]
    first = np.arange(stations - 1)[:, None] * m
    a, b = (first + np.array([pair[end] for pair in pairs]) for end in (0, 1))
    sides = np.stack([np.stack([a, b, b + m], -1), np.stack([a, b + m, a + m], -1)], 2)
    rings = np.array([ring.index(k) for k in range(corners)])
    caps = [
        base + rings[[0, k + 1, k] if end == 0 else [0, k, k + 1]]
        for end, base in ((0, 0), (1, (stations - 1) * m))
        for k in range(1, corners - 1)
    ]
    triangles = np.concatenate([sides.reshape(-1, 3), np.array(caps)])
    offsets = result._offsets(name)[:, 0].reshape(-1, 4)

    def spread(rows: FloatArray) -> FloatArray:
        nodes = rows[:, offsets[..., None] + np.arange(3)]
        start, end = nodes[:, element], nodes[:, element + 1]
        line = sum(w[:, None] * x for w, x in zip(along, (start[:, :, 0], start[:, :, 1]), strict=False))
        line = line + along[2][:, None] * end[:, :, 0] + along[3][:, None] * end[:, :, 1]
        across = (1 - xi)[:, None, None] * start[:, :, 2:] + xi[:, None, None] * end[:, :, 2:]
        points = (
            line[:, :, None] + y[..., None] * across[:, :, None, 0] + z[..., None] * across[:, :, None, 1]
        )
        spread_points: FloatArray = points.reshape(len(rows), -1, 3)
        return spread_points

    q, v = result._records.q[frames], result._records.v[frames]
    rows = result._system.beam_strain(result._lowered.beams[name], q)
    velocity = spread(v)
    values = {
        "strain": np.repeat(rows[:, element, 0], m, axis=1),
        "axial_force": np.repeat(rows[:, element, 6], m, axis=1),
        "speed": np.linalg.norm(velocity, axis=2),
        "velocity": velocity,
    }
    if given is not None:
        mixed = (1 - xi) * given[:, element] + xi * given[:, element + 1]
        values["color"] = np.repeat(mixed, m, axis=1)
    return Surface(name, spread(q), triangles, values)


LOOKS: dict[type, Callable[[Any, str, IntArray, int, FloatArray | None], Drawing]] = {
    LineBody: _line,
    RigidBodyData: _rigid,
    MassBody: _mass,
    SurfaceBody: _surface,
    BeamBody: _beam,
}
"""Look of each kind of body: (result, name, frames, pieces an element, given values) to what is drawn."""


def arrows(result: Result, frames: IntArray) -> list[Arrows]:
    """Collect forces that act at points, and what joints exert on their first bodies."""
    model = result.model
    rows = result._records[frames]
    found = []
    for name, load in model._loads.items():
        if isinstance(load, Force):
            factors = rows.time if result.is_static else np.ones(len(rows.time))
            held = [result._held(int(i)) for i in frames]
            pairs = zip(rows.time, factors, held, strict=True)
            vectors = np.array([scaled(load.value, float(t), float(f), h) for t, f, h in pairs])
            if load.follower:
                vectors = _followed(result, load, rows.q[:], vectors)
            feet = result._at(load.at, rows.q)
            found.append(Arrows(name, "force", feet, vectors, np.zeros_like(vectors)))
    part = result._part(rows)
    for name, joint in model._joints.items():
        if name in result._lowered.plan and joint.points():
            reaction = part.reaction(Joint(name, model.identity))
            feet = result._at(joint.points()[0], rows.q)
            found.append(Arrows(name, "reaction", feet, reaction.force, reaction.moment))
    return found + contact_arrows(result, frames)


def contact_arrows(result: Result, frames: IntArray) -> list[Arrows]:
    """Collect forces of contact: as many arrows as there are patches at once, the strongest first."""
    touching = [result._patches(rows) for rows in result._patch_rows(frames)]
    most = max((len(patches) for patches in touching), default=0)
    feet, vectors = np.zeros((2, most, len(frames), 3))
    for f, patches in enumerate(touching):
        for k, patch in enumerate(sorted(patches, key=lambda patch: -patch.normal_force)):
            feet[k, f], vectors[k, f] = patch.point, patch.force
    return [
        Arrows(f"contact {k + 1}", "contact", feet[k], vectors[k], np.zeros_like(vectors[k]))
        for k in range(most)
    ]


def _followed(result: Result, load: Force, q: FloatArray, vectors: FloatArray) -> FloatArray:
    """Turn forces with a rigid body, or with a tangent in its plane with the force at the start."""
    body = result.model._bodies[load.at.body]
    offsets = result._offsets(load.at.body)
    turned: FloatArray
    if isinstance(body, RigidBodyData):
        axes = q[:, offsets[1:] + np.arange(3)]
        turned = np.einsum("nk,nki->ni", vectors @ body.axes.T, axes)
        return turned
    at = load.at
    if isinstance(body, BeamBody):
        first = 4 * at.element + np.array([2, 3])
        gradients = [
            (1 - at.xi) * q[:, offsets[k, 0] + np.arange(3)] + at.xi * q[:, offsets[k + 4, 0] + np.arange(3)]
            for k in first
        ]
        start = [(1 - at.xi) * body.q[at.element, k] + at.xi * body.q[at.element + 1, k] for k in (2, 3)]
        turned = np.einsum("nk,nki->ni", vectors @ section_axes(*start).T, section_axes(*gradients))
        return turned
    assert isinstance(body, LineBody)
    length, xi = float(body.lengths[at.element]), at.xi
    nodes = q[:, offsets[body.element_nodes[at.element] + np.arange(2)][:, :, None] + np.arange(3)]
    slope = (
        6 * xi * (1 - xi) / length * (nodes[:, 1, 0] - nodes[:, 0, 0])
        + (1 - 4 * xi + 3 * xi**2) * nodes[:, 0, 1]
        + (3 * xi**2 - 2 * xi) * nodes[:, 1, 1]
    )
    t = slope / np.linalg.norm(slope, axis=1)[:, None]
    t_0 = body.tangent(at.element, xi)
    t_0 = t_0 / np.linalg.norm(t_0)
    turned = (vectors @ t_0)[:, None] * t + np.cross(np.cross(t_0, vectors), t)
    return turned


def joint_points(result: Result, frames: IntArray) -> dict[str, FloatArray]:
    """Find the places of the joints, (frames, 3) by name."""
    q = result._records.q[frames]
    return {
        name: result._at(joint.points()[0], q)
        for name, joint in result.model._joints.items()
        if joint.points() and isinstance(joint.points()[0], Point)
    }


def up_of(result: Result) -> FloatArray:
    """Tell where up is: against gravity, else along z."""
    gravity = result.model.gravity
    size = float(np.linalg.norm(gravity))
    return -gravity / size if size > 0 else np.array([0.0, 0.0, 1.0])
