"""Contacts other than of cables among themselves: which pairs there are, and how the core reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.beams import BeamBody
from pliant.bodies import Body, LineBody, MassBody
from pliant.contacts import (
    DAMPING,
    RAMP,
    STANDARD_GRAVITY,
    ContactData,
    ObstacleData,
    friction_document,
    shape_document,
)
from pliant.rigid import RigidBodyData
from pliant.shapes import Box
from pliant.surfaces import SurfaceBody
from pliant.typing import Json

if TYPE_CHECKING:
    from pliant._lower import _Lowering

__all__ = ["document", "is_of_lines", "kind_of", "why_not"]

SINKING = 1e-3
"""How deep a rigid body sinks under its own weight, over its size: what its stiffness is chosen for."""
POINT_SIZE = 1e-2
"""Size of a mass without a radius [m]."""

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
        if isinstance(side, BeamBody):
            return "beams do not touch anything yet: take a cable or rigid bodies"
    if isinstance(a, ObstacleData) and isinstance(b, ObstacleData):
        return "two obstacles do not move: one of the two must be a body"
    solid = (RigidBodyData, ObstacleData)
    if a is b and isinstance(a, (RigidBodyData, MassBody)):
        return f"a {kind_of(a)} does not touch itself"
    if isinstance(a, LineBody) and isinstance(b, LineBody):
        return None
    if isinstance(a, solid) or isinstance(b, solid):
        return None
    return (
        f"contact between a {kind_of(a)} and a {kind_of(b)} is not known: shells, membranes and point masses "
        "touch obstacles and rigid bodies with a shape, cables these and each other"
    )


def is_of_lines(a: Side, b: Side) -> bool:
    """Whether two sides touch as lines do: two cables, or a cable and an obstacle."""
    kinds = (LineBody, ObstacleData)
    return isinstance(a, kinds) and isinstance(b, kinds)


def document(contact: ContactData, lowering: _Lowering) -> Json:
    """Write a contact as the core reads it."""
    model = lowering.model
    sides = [model._bodies.get(name) or model._obstacles[name] for name in (contact.a, contact.b)]
    size = _size(sides)
    soft = any(isinstance(side, (LineBody, SurfaceBody)) for side in sides)
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
    }


def _side(side: Side, lowering: _Lowering) -> Json:
    lowered = lowering.lowered
    if isinstance(side, LineBody):
        return {"side": "line", "cable": lowered.cables[side.name]}
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
    for side in sides:
        if isinstance(side, SurfaceBody):
            return float(side.thickness.min())
        if isinstance(side, LineBody):
            return float(side.radius.min())
        if isinstance(side, MassBody):
            sizes.append(side.radius if side.radius > 0 else POINT_SIZE)
        elif isinstance(side, RigidBodyData):
            sizes.append(_radius(side.shape))
    return min(sizes)


def _radius(shape: Any) -> float:
    return 0.5 * min(shape.size) if isinstance(shape, Box) else float(shape.radius)


def _stiffness(contact: ContactData, sides: list[Side], size: float, gravity: float) -> float:
    """Give the stiffness of a contact: that of the body that yields, else what carries a weight.

    Surfaces as a layer of their material between the faces, E/t per area; lines as on an obstacle; rigid
    bodies so that the lighter one sinks in by a thousandth of its size.
    """
    if contact.stiffness is not None:
        return contact.stiffness
    for side in sides:
        if isinstance(side, SurfaceBody):
            return side.youngs_modulus / size
        if isinstance(side, LineBody):
            stiffness: float = contact.laws([side])["stiffness"]
            return stiffness
    masses = [side.mass for side in sides if isinstance(side, (RigidBodyData, MassBody))]
    return min(masses) * (gravity or STANDARD_GRAVITY) / (SINKING * size)
