"""Loads: what a model keeps of them."""

from __future__ import annotations

from dataclasses import dataclass

from pliant import _check
from pliant.forces import ForceData
from pliant.gas import Chamber
from pliant.points import Point
from pliant.signals import Signal
from pliant.surfaces import Edge, Faces

__all__ = [
    "EdgeLoad",
    "EdgeMoment",
    "Force",
    "LineLoad",
    "LoadData",
    "Moment",
    "MovingForce",
    "Pressure",
    "SurfaceLoad",
]


@dataclass(frozen=True)
class Force:
    """A force at a point [N]; a follower turns with the tangent."""

    name: str
    at: Point
    value: Signal
    follower: bool

    def __post_init__(self) -> None:
        _check_load(self.name, self.value)
        _check.flag(self.follower, "follower")


@dataclass(frozen=True)
class Moment:
    """A moment at a point of a cable [N m]."""

    name: str
    at: Point
    value: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value)


@dataclass(frozen=True)
class LineLoad:
    """A force per stress-free length on all of a cable [N/m]."""

    name: str
    body: str
    value: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value)


@dataclass(frozen=True)
class MovingForce:
    """A force [N] at an arc length [m] of a cable's stress-free line."""

    name: str
    body: str
    value: Signal
    position: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value)
        _check.text(self.body, "body")
        if not isinstance(self.position, Signal) or self.position.size != 1:
            _check.fail("position", self.position, "must be a signal of one component")


@dataclass(frozen=True)
class EdgeLoad:
    """A force per stress-free length on an edge of a surface [N/m]."""

    name: str
    edge: Edge
    value: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value)


@dataclass(frozen=True)
class EdgeMoment:
    """A moment per stress-free length on an edge of a shell, about its direction at the start [N]."""

    name: str
    edge: Edge
    value: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value, 1)


@dataclass(frozen=True)
class Pressure:
    """A pressure on faces of a surface [Pa]."""

    name: str
    faces: Faces
    value: Signal

    def __post_init__(self) -> None:
        _check_load(self.name, self.value, 1)


SurfaceLoad = EdgeLoad | EdgeMoment | Pressure
LoadData = Force | Moment | LineLoad | MovingForce | ForceData | SurfaceLoad | Chamber


def _check_load(name: object, value: object, size: int = 3) -> None:
    _check.text(name, "name")
    if not isinstance(value, Signal) or value.size != size:
        _check.fail("value", value, f"must be a signal of size {size}")
