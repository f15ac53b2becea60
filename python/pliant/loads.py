"""Loads: what a model keeps of them."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.points import Point
from pliant.signals import Signal

__all__ = ["Force", "LineLoad", "LoadData", "Moment"]


@dataclass(frozen=True)
class Force:
    """A force at a point [N]; a follower turns with the tangent."""

    name: str
    at: Point
    value: Signal
    follower: bool


@dataclass(frozen=True)
class Moment:
    """A moment at a point of a cable [N m]."""

    name: str
    at: Point
    value: Signal


@dataclass(frozen=True)
class LineLoad:
    """A force per stress-free length on all of a cable [N/m]."""

    name: str
    body: str
    value: Signal


LoadData = Force | Moment | LineLoad
