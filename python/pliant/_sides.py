"""Contacts other than of lines among themselves: which pairs there are, and how the core reads them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.beams import BeamBody
from pliant.bodies import Body, LineBody, MassBody
from pliant.contacts import (
    DAMPING,
    POISSON_RATIO,
    RAMP,
    STANDARD_GRAVITY,
    ContactData,
    ObstacleData,
    effective_modulus,
    friction_document,
    shape_document,
)
from pliant.joints import EdgeJoint
from pliant.points import Point
from pliant.rigid import RigidBodyData
from pliant.shapes import Box
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant._lower import _Lowering

__all__ = ["document", "is_of_lines", "kind_of", "why_not"]

SINKING = 1e-3
"""How deep a rigid body sinks under its own weight, over its size: what its stiffness is chosen for."""
LAYER = 2e7
"""Largest modulus of surfaces as layers [Pa]: a pressure of 10 bar sinks in by a twentieth of the thickness.
Stiffer foils would bounce faster than any step follows."""
POINT_SIZE = 1e-2
"""Size of a mass without a radius [m]."""
WINDOW = 1.05 * np.pi / 2.0
"""Way along a surface, over its thickness, below which it does not touch itself: half a turn of the tightest
bend."""
NEIGHBOURHOOD = 3.0
"""How far around a joint nothing touches, over what the two sides reach together."""

LINES = (LineBody, BeamBody)
"""What touches along its centre line."""

Side = Body | ObstacleData


def kind_of(side: Side) -> str:
    """Name of what touches, for messages."""
    if isinstance(side, LineBody):
        return "cable"
    if isinstance(side, SurfaceBody):
        return side.kind
    if isinstance(side, BeamBody):
        return "beam"
    if isinstance(side, RigidBodyData):
        return "rigid body"
    if isinstance(side, MassBody):
        return "point mass"
    return "obstacle"


def why_not(a: Side, b: Side) -> str | None:
    """Say why two sides cannot touch; None where they can."""
    for side in (a, b):
        if isinstance(side, RigidBodyData) and side.shape is None:
            return f"'{side.name}' has no shape: give it one, add_rigid_body(..., shape=pl.Box(...))"
    if isinstance(a, ObstacleData) and isinstance(b, ObstacleData):
        return "two obstacles do not move: one of the two must be a body"
    solid = (RigidBodyData, ObstacleData)
    if a is b and isinstance(a, (RigidBodyData, MassBody)):
        return f"a {kind_of(a)} does not touch itself"
    if isinstance(a, LINES) and isinstance(b, LINES):
        return None
    # A surface is touched by everything that has points.
    touched = (*solid, SurfaceBody)
    if isinstance(a, touched) or isinstance(b, touched):
        return None
    return (
        f"contact between a {kind_of(a)} and a {kind_of(b)} is not known: point masses touch obstacles, "
        "rigid bodies with a shape, shells and membranes; cables and beams these and each other"
    )


def is_of_lines(a: Side, b: Side) -> bool:
    """Whether two sides touch as lines do: two cables or beams, or one of these and an obstacle."""
    kinds = (*LINES, ObstacleData)
    return isinstance(a, kinds) and isinstance(b, kinds)


def document(contact: ContactData, lowering: _Lowering) -> Json:
    """Write a contact as the core reads it."""
    model = lowering.model
    sides = [model._bodies.get(name) or model._obstacles[name] for name in (contact.a, contact.b)]
    size = _size(sides)
    soft = any(isinstance(side, (*LINES, SurfaceBody)) for side in sides)
    return {
        "name": contact.name,
        "a": _side(sides[0], lowering),
        "b": _side(sides[1], lowering),
        "stiffness": _stiffness(contact, sides, size, float(np.linalg.norm(model.gravity))),
        # Rigid bodies rest in the ramp else, where their contact is softer.
        "ramp": (RAMP if soft else 0.1 * SINKING) * size,
        "size": size,
        "damping": DAMPING if contact.damping is None else contact.damping,
        "friction": friction_document(contact.friction, size),
        "window": WINDOW * 2.0 * _reach(sides[0]) if contact.a == contact.b else 0.0,
        "apart": lowering._array(_apart(contact, sides, lowering)),
    }


def _apart(contact: ContactData, sides: list[Side], lowering: _Lowering) -> FloatArray:
    """Places on stress-free surfaces around which nothing touches, for a joint holds the two there.

    Rows of side (0 or 1), place (3) and how far [m].
    """
    rows: list[FloatArray] = []
    if contact.a == contact.b:
        return np.array(rows)
    width = NEIGHBOURHOOD * sum(_reach(side) for side in sides)
    both = {contact.a, contact.b}

    def note(body: SurfaceBody, places: FloatArray) -> None:
        number = 0 if body.name == contact.a else 1
        rows.extend(np.array([number, *place, width]) for place in places)

    for joint in lowering.model._joints.values():
        if isinstance(joint, EdgeJoint):
            edges = [edge for edge in (joint.edge, joint.other) if edge is not None]
            names = {edge.body for edge in edges} | ({joint.body} if joint.body else set())
            if names != both:
                continue
            for edge in edges:
                body = lowering.model._bodies[edge.body]
                assert isinstance(body, SurfaceBody)
                corners = body.reference[list(edge.nodes), 0]
                places = [corners[:1]]
                for one, other in pairwise(corners):
                    count = max(1, int(np.ceil(np.linalg.norm(other - one) / width)))
                    places.append(one + (other - one) * np.linspace(0.0, 1.0, count + 1)[1:, None])
                note(body, np.concatenate(places))
            continue
        points = [point for point in joint.points() if isinstance(point, Point)]
        if {point.body for point in points} != both:
            continue
        for point in points:
            body = lowering.model._bodies[point.body]
            if isinstance(body, SurfaceBody):
                note(body, body.place(point, body.reference)[None])
    return np.array(rows)


def _reach(side: Side) -> float:
    """Half of a thickness, or a radius: how far a thin side reaches about its middle [m]."""
    if isinstance(side, SurfaceBody):
        return 0.5 * float(side.thickness.max())
    if isinstance(side, LINES):
        return float(side.radius.max())
    return 0.0


def _side(side: Side, lowering: _Lowering) -> Json:
    lowered = lowering.lowered
    if isinstance(side, LINES):
        return {"side": "line", "line": lowered.line(side.name)}
    if isinstance(side, SurfaceBody):
        return {"side": "surface", "surface": lowered.surfaces[side.name]}
    if isinstance(side, RigidBodyData):
        assert side.shape is not None
        return {"side": "rigid", "rigid": lowered.rigid[side.name], "shape": shape_document(side.shape)}
    if isinstance(side, MassBody):
        at: Any = {"shared": lowered.shared[side.name]} if side.at is None else lowering._point(side.at)
        return {"side": "mass", "at": at, "mass": side.mass, "radius": side.radius}
    assert isinstance(side, ObstacleData)
    place = side.document()
    return {"side": "rest", **{key: place[key] for key in ("origin", "axes", "shape")}}


def _size(sides: list[Side]) -> float:
    """Length by which penetration and bristles are measured: thickness, or the least of the radii [m]."""
    sizes = []
    for thin in (LINES, (SurfaceBody,)):
        widths = [
            float((side.thickness if isinstance(side, SurfaceBody) else side.radius).min())
            for side in sides
            if isinstance(side, thin)
        ]
        if widths:
            return min(widths)
    for side in sides:
        if isinstance(side, MassBody):
            sizes.append(side.radius if side.radius > 0 else POINT_SIZE)
        elif isinstance(side, RigidBodyData):
            sizes.append(_radius(side.shape))
    return min(sizes)


def _radius(shape: Any) -> float:
    return 0.5 * min(shape.size) if isinstance(shape, Box) else float(shape.radius)


def _stiffness(contact: ContactData, sides: list[Side], size: float, gravity: float) -> float:
    """Give the stiffness of a contact: that of the body that yields, else what carries a weight.

    Surfaces as layers of their materials between the faces, E/t per area with E no more than `LAYER`; lines
    as round bars that cross another of the other's material; a mass on a surface as a column of the mass's
    section; rigid bodies so that the lighter one sinks in by a thousandth of its size.
    """
    if contact.stiffness is not None:
        return contact.stiffness
    lines = [side for side in sides if isinstance(side, LINES)]
    surfaces = [side for side in sides if isinstance(side, SurfaceBody)]
    if lines:
        moduli = [effective_modulus(side) for side in lines] + [side.youngs_modulus for side in surfaces]
        return 0.5 / sum((1.0 - POISSON_RATIO**2) / modulus for modulus in moduli)
    if surfaces:
        thickness = [float(side.thickness.min()) for side in surfaces]
        layer = 1.0 / sum(t / side.youngs_modulus for t, side in zip(thickness, surfaces, strict=True))
        layer = min(layer, LAYER / sum(thickness))
        points = [side for side in sides if isinstance(side, MassBody)]
        return layer * np.pi * (points[0].radius or POINT_SIZE) ** 2 if points else layer
    masses = [side.mass for side in sides if isinstance(side, (RigidBodyData, MassBody))]
    return min(masses) * (gravity or STANDARD_GRAVITY) / (SINKING * size)
