"""Loads: what a model keeps of them."""

from __future__ import annotations

from dataclasses import dataclass

from pliant import _check
from pliant.forces import ForceData
from pliant.points import Point
from pliant.signals import Signal

__all__ = ["Force", "LineLoad", "LoadData", "Moment", "MovingForce"]


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


LoadData = Force | Moment | LineLoad | MovingForce | ForceData


def _check_load(name: object, value: object) -> None:
    _check.text(name, "name")
    if not isinstance(value, Signal) or value.size != 3:
        _check.fail("value", value, "must be a signal of three components")
