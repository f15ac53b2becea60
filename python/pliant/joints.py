"""Joints: what a model keeps of them.

The fields of a joint between two points, beside ``here``, are those of the core's document.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.points import Point, WorldPoint
from pliant.surfaces import Edge

__all__ = [
    "JOINTS",
    "Clamp",
    "Cylindrical",
    "Distance",
    "EdgeJoint",
    "Hinge",
    "JointData",
    "Pair",
    "Pin",
    "SlideCable",
    "SlideLine",
    "Slider",
    "Universal",
    "Weld",
]

Axis = tuple[float, float, float]


@dataclass(frozen=True)
class Pair:
    """A joint between two points; ``here``: the second is where the first starts."""

    name: str
    a: Point
    b: Point | WorldPoint
    here: bool = False

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.flag(self.here, "here")
        for name in ("axis", "axis_a", "axis_b"):
            if hasattr(self, name):
                object.__setattr__(self, name, axis_of(getattr(self, name), name))


@dataclass(frozen=True)
class Pin(Pair):
    """Two points coincide."""


@dataclass(frozen=True)
class Clamp:
    """A point of a cable keeps its position and the direction of its tangent; a rigid body its place."""

    name: str
    a: Point

    def __post_init__(self) -> None:
        _check.text(self.name, "name")


@dataclass(frozen=True)
class Weld(Pair):
    """Two bodies move as one."""


@dataclass(frozen=True)
class Hinge(Pair):
    """Two bodies share a point and an axis."""

    axis: Axis = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Slider(Pair):
    """Two bodies slide along an axis without turning."""

    axis: Axis = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Cylindrical(Pair):
    """Two bodies slide along an axis and turn about it."""

    axis: Axis = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Universal(Pair):
    """Two bodies share a point; an axis of each stays normal to that of the other."""

    axis_a: Axis = (1.0, 0.0, 0.0)
    axis_b: Axis = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Distance(Pair):
    """Two points stay a length apart [m]."""

    length: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        _check.number(self.length, "length", above=0)


@dataclass(frozen=True)
class SlideLine(Pair):
    """A point slides along a straight line."""

    axis: Axis = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class SlideCable:
    """A point slides along a cable."""

    name: str
    a: Point
    cable: str

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.text(self.cable, "cable")


@dataclass(frozen=True)
class EdgeJoint:
    """An edge of a surface is held: clamped, pinned, in a plane of symmetry, or welded to another edge.

    ``a`` is the first node of the edge, about which the reaction's moment is told; ``axes`` are the
    directions that a pin holds (all where there are none), or the normal of a plane of symmetry.
    """

    name: str
    a: Point
    kind: str
    edge: Edge
    other: Edge | None = None
    axes: tuple[Axis, ...] = ()

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.choice(self.kind, "kind", ("clamp", "pin", "symmetry", "weld"))
        object.__setattr__(self, "axes", tuple(axis_of(axis, "axes") for axis in self.axes))


JointData = Pair | Clamp | SlideCable | EdgeJoint
JOINTS: tuple[type[JointData], ...] = (
    EdgeJoint,
    Pin,
    Clamp,
    Weld,
    Hinge,
    Slider,
    Cylindrical,
    Universal,
    Distance,
    SlideLine,
    SlideCable,
)


def axis_of(value: Any, name: str) -> Axis:
    """Return a unit vector."""
    axis = _check.vector(value, name)
    length = float(np.linalg.norm(axis))
    if not 0 < length < np.inf:
        _check.fail(name, value, "must be a direction, longer than zero")
    x, y, z = (float(c) for c in axis / length)
    return (x, y, z)
