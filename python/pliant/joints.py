"""Joints: what a model keeps of them.

The fields of a joint between two points, beside ``here``, are those of the core's document.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.points import Point, WorldPoint
from pliant.signals import Signal
from pliant.surfaces import Edge

__all__ = [
    "JOINTS",
    "Clamp",
    "Cylindrical",
    "Distance",
    "DriveAxis",
    "DriveForce",
    "DriveJoint",
    "DrivePoint",
    "EdgeJoint",
    "Fold",
    "Gear",
    "Hinge",
    "JointData",
    "Jointed",
    "Pair",
    "Pin",
    "SlideCable",
    "SlideLine",
    "Slider",
    "Universal",
    "Weld",
    "acting_along",
]

Axis = tuple[float, float, float]


Limits = tuple[float | None, float | None]


@dataclass(frozen=True)
class Jointed:
    """Anything that a model lists among its joints."""

    name: str

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on, the first body's before the second's."""
        return ()


@dataclass(frozen=True)
class Pair(Jointed):
    """A joint between two points; ``here``: the second is where the first starts."""

    a: Point
    b: Point | WorldPoint
    here: bool = False

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.flag(self.here, "here")
        for name in ("axis", "axis_a", "axis_b"):
            if hasattr(self, name):
                object.__setattr__(self, name, axis_of(getattr(self, name), name))

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return self.a, self.b


@dataclass(frozen=True)
class Pin(Pair):
    """Two points coincide."""


@dataclass(frozen=True)
class Clamp(Jointed):
    """A point of a cable keeps its position and the direction of its tangent; a rigid body its place."""

    a: Point

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return (self.a,)

    def __post_init__(self) -> None:
        _check.text(self.name, "name")


@dataclass(frozen=True)
class Weld(Pair):
    """Two bodies move as one."""


@dataclass(frozen=True)
class Sprung(Pair):
    """A joint with one freedom, along which a spring, a damper and stops may act."""

    axis: Axis = (0.0, 0.0, 1.0)
    stiffness: float = 0.0
    damping: float = 0.0
    rest: float = 0.0
    limits: Limits | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("stiffness", "damping"):
            object.__setattr__(self, name, _check.number(getattr(self, name), name, at_least=0))
        object.__setattr__(self, "rest", _check.number(self.rest, "rest"))
        object.__setattr__(self, "limits", limits_of(self.limits))

    @property
    def is_sprung(self) -> bool:
        """Whether anything acts along the freedom."""
        return self.stiffness > 0 or self.damping > 0 or self.limits is not None


@dataclass(frozen=True)
class Hinge(Sprung):
    """Two bodies share a point and an axis."""


@dataclass(frozen=True)
class Slider(Sprung):
    """Two bodies slide along an axis without turning."""


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
class SlideCable(Jointed):
    """A point slides along a cable."""

    a: Point
    cable: str

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.text(self.cable, "cable")

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return (self.a,)


@dataclass(frozen=True)
class EdgeJoint(Jointed):
    """An edge of a surface is held: clamped, pinned, in a plane of symmetry, or welded to another edge.

    ``a`` is the first node of the edge, about which the reaction's moment is told; ``axes`` are the
    directions that a pin holds (all where there are none), or the normal of a plane of symmetry; ``body`` is
    the rigid body that it is pinned to, in place of the world.
    """

    a: Point
    kind: str
    edge: Edge
    other: Edge | None = None
    axes: tuple[Axis, ...] = ()
    body: str | None = None

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.choice(self.kind, "kind", ("clamp", "pin", "symmetry", "weld", "fold"))
        object.__setattr__(self, "axes", tuple(axis_of(axis, "axes") for axis in self.axes))

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on: the first node of the edge."""
        return (self.a,)


@dataclass(frozen=True)
class Fold(EdgeJoint):
    """Two edges keep one position; a spring and damper about them, or a given angle (see ``Model.fold``)."""

    stiffness: float = 0.0
    damping: float = 0.0
    angle: Signal | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("stiffness", "damping"):
            _check.number(getattr(self, name), name, at_least=0)
        if self.other is None:
            _check.fail("other", self.other, "a fold joins two edges")
        if self.angle is not None and (not isinstance(self.angle, Signal) or self.angle.size != 1):
            _check.fail("angle", self.angle, "must be a signal of one component")

    @property
    def is_held(self) -> bool:
        """Whether the angle is given, not sprung."""
        return self.angle is not None and self.stiffness == 0.0


@dataclass(frozen=True)
class DrivePoint(Jointed):
    """A point follows a path, the tangent of a cable there a direction, a rigid body given axes."""

    a: Point
    position: Signal | None = None
    direction: Signal | None = None
    axis_x: Signal | None = None
    axis_y: Signal | None = None
    axis_z: Signal | None = None

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return (self.a,)

    @property
    def equations(self) -> int:
        """Number of constraint equations."""
        given = (self.position, self.direction, self.axis_x)
        return sum(count for count, value in zip((3, 2, 3), given, strict=True) if value is not None)


@dataclass(frozen=True)
class DriveJoint(Jointed):
    """The angle of a hinge or the way of a slider, or its rate, follows a course."""

    joint: str
    value: Signal
    rate: bool = False


@dataclass(frozen=True)
class DriveAxis(Jointed):
    """A rigid body turns about an axis by a given angle, or at a given rate."""

    a: Point
    axis: Axis
    value: Signal
    rate: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", axis_of(self.axis, "axis"))

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return (self.a,)


@dataclass(frozen=True)
class DriveForce(Jointed):
    """A torque about the axis of a hinge [N m], or a force along a slider [N]."""

    joint: str
    value: Signal


@dataclass(frozen=True)
class Gear(Jointed):
    """The angle or way of one joint is a ratio times that of the other."""

    joint_a: str
    joint_b: str
    ratio: float


JointData = Pair | Clamp | SlideCable | DrivePoint | DriveJoint | DriveAxis | DriveForce | Gear | EdgeJoint
JOINTS: tuple[type[JointData], ...] = (
    EdgeJoint,
    Fold,
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
    DrivePoint,
    DriveJoint,
    DriveAxis,
    DriveForce,
    Gear,
)


def acting_along(joints: Mapping[str, JointData], name: str) -> str | None:
    """Name what acts along a joint: itself with a spring, damper or stops, a drive, or a gear."""
    for other in joints.values():
        if isinstance(other, Sprung):
            acts = other.name == name and other.is_sprung
        elif isinstance(other, (DriveForce, DriveJoint)):
            acts = other.joint == name
        else:
            acts = isinstance(other, Gear) and name in (other.joint_a, other.joint_b)
        if acts:
            return other.name
    return None


def limits_of(value: Any) -> Limits | None:
    """Return a lower and an upper limit; None for a side without one."""
    allowed = "must be (lower, upper), lower below upper, around 0 where the joint starts; None: no limit"
    if value is None:
        return None
    if not isinstance(value, (tuple, list, np.ndarray)) or len(value) != 2:
        _check.fail("limits", value, allowed)
    lower, upper = (
        None if x is None or (isinstance(x, float) and np.isinf(x)) else _check.number(x, "limits")
        for x in value
    )
    if (lower is not None and lower > 0) or (upper is not None and upper < 0) or lower == upper:
        _check.fail("limits", value, allowed)
    return lower, upper


def axis_of(value: Any, name: str) -> Axis:
    """Return a unit vector."""
    axis = _check.vector(value, name)
    length = float(np.linalg.norm(axis))
    if not 0 < length < np.inf:
        _check.fail(name, value, "must be a direction, longer than zero")
    x, y, z = (float(c) for c in axis / length)
    return (x, y, z)
