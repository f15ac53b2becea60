"""Forces that depend on positions and velocities: what a model keeps of them.

The fields of a force beside its points are those of the core's document.
"""

from __future__ import annotations

from dataclasses import dataclass

from pliant import _check
from pliant.points import Point, WorldPoint

__all__ = ["FORCES", "ForceData", "Spring"]


@dataclass(frozen=True)
class ForceData:
    """A force between parts of a model."""

    name: str

    def __post_init__(self) -> None:
        _check.text(self.name, "name")

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        raise NotImplementedError


@dataclass(frozen=True)
class Spring(ForceData):
    """A spring and damper between two points: stiffness [N/m], damping [N s/m], stress-free length [m]."""

    a: Point
    b: Point | WorldPoint
    stiffness: float
    damping: float
    length: float

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("stiffness", "damping", "length"):
            _check.number(getattr(self, name), name, at_least=0)

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return self.a, self.b


FORCES: tuple[type[ForceData], ...] = (Spring,)
