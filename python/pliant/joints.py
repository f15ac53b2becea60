"""Joints: what a model keeps of them."""

from __future__ import annotations

from dataclasses import dataclass

from pliant import _check
from pliant.points import Point, WorldPoint

__all__ = ["Clamp", "JointData", "Pin"]


@dataclass(frozen=True)
class Pin:
    """Two points coincide; ``here``: the second is where the first starts."""

    name: str
    a: Point
    b: Point | WorldPoint
    here: bool = False

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.flag(self.here, "here")


@dataclass(frozen=True)
class Clamp:
    """A point of a cable keeps its position and the direction of its tangent."""

    name: str
    a: Point

    def __post_init__(self) -> None:
        _check.text(self.name, "name")


JointData = Pin | Clamp
