"""Forces that depend on positions and velocities: what a model keeps of them.

The fields of a force beside its points are those of the core's document.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar

from pliant import _check
from pliant.points import Point, WorldPoint
from pliant.signals import Signal, Table
from pliant.surfaces import Faces

__all__ = ["FORCES", "ON_FACES", "Curvature", "ForceData", "SheetWind", "Spring", "Tendon", "Wind"]


@dataclass(frozen=True)
class ForceData:
    """A force between parts of a model."""

    name: str

    def __post_init__(self) -> None:
        _check.text(self.name, "name")

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        raise NotImplementedError

    def entries(self) -> dict[str, Any]:
        """Entries of the core's document; points, signals and the body's name are still to be lowered."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}


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


@dataclass(frozen=True)
class Tendon(ForceData):
    """A line through points, pulled at the first by a force [N] or by a motor to a stress-free length [m]."""

    guides: tuple[Point | WorldPoint, ...]
    tension: Signal | None
    free_length: Signal | None
    stiffness: float | None
    damping: float
    friction: float
    slip_velocity: float

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "guides", tuple(self.guides))
        if len(self.guides) < 2:
            _check.fail("points", self.guides, "must be two or more points")
        if (self.tension is None) == (self.free_length is None):
            _check.fail("length", self.free_length, "give tension or length, one of them")
        for name in ("tension", "free_length"):
            value = getattr(self, name)
            if value is not None and (not isinstance(value, Signal) or value.size != 1):
                _check.fail(name, value, "must be a signal of one component")
        if self.free_length is not None:
            _check.number(self.stiffness, "stiffness", above=0)
        _check.number(self.slip_velocity, "slip_velocity", above=0)
        for name in ("damping", "friction"):
            _check.number(getattr(self, name), name, at_least=0)

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on."""
        return self.guides

    def entries(self) -> dict[str, Any]:
        """Entries of the core's document; points, signals and the body's name are still to be lowered."""
        pull: dict[str, Any] = {"kind": "force", "tension": self.tension}
        if self.free_length is not None:
            motor = {"stiffness": self.stiffness, "damping": self.damping}
            pull = {"kind": "motor", "length": self.free_length, **motor}
        return {
            "name": self.name,
            "points": self.guides,
            "pull": pull,
            "friction": self.friction,
            "slip_velocity": self.slip_velocity,
        }


@dataclass(frozen=True)
class Wind(ForceData):
    """Flow across a line body: velocity [m/s], density [kg/m^3], coefficients of drag and lift."""

    body: str
    velocity: Signal
    density: float
    drag: float
    lift: Signal

    def __post_init__(self) -> None:
        super().__post_init__()
        _check.text(self.body, "body")
        for name, size in (("velocity", 3), ("lift", 1)):
            value = getattr(self, name)
            if not isinstance(value, Signal) or value.size != size:
                _check.fail(name, value, f"must be a signal of {size} components")
        for name in ("density", "drag"):
            _check.number(getattr(self, name), name, at_least=0)

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on: it acts on all of its body."""
        return ()

    def entries(self) -> dict[str, Any]:
        """Entries of the core's document; points, signals and the body's name are still to be lowered."""
        constant = float(self.lift(0.0)[0])
        lift: dict[str, Any] = {"constant": constant}
        if isinstance(self.lift, Table):
            angles, coefficients = self.lift.times.tolist(), self.lift.values[:, 0].tolist()
            lift = {"angle": {"angles": angles, "coefficients": coefficients}}
        return {
            "name": self.name,
            "cable": self.body,
            "velocity": self.velocity,
            "direction": self.velocity(0.0).tolist(),
            "density": self.density,
            "drag": self.drag,
            "lift": lift,
        }


@dataclass(frozen=True)
class SheetWind(ForceData):
    """Flow by faces of a surface: velocity [m/s], density [kg/m^3], coefficients of drag and lift."""

    faces: Faces
    velocity: Signal
    density: float
    drag: float
    lift: float

    kind: ClassVar[str] = "sheet_wind"

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_on_faces(self.faces, "velocity", self.velocity)
        for name in ("density", "drag", "lift"):
            _check.number(getattr(self, name), name, at_least=0)

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on: it acts on faces."""
        return ()


@dataclass(frozen=True)
class Curvature(ForceData):
    """A rest curvature (11, 22, 12) of faces of a shell that changes in time [1/m]."""

    faces: Faces
    value: Signal

    kind: ClassVar[str] = "curvature"

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_on_faces(self.faces, "value", self.value)

    def points(self) -> tuple[Point | WorldPoint, ...]:
        """Points that it acts on: it acts on faces."""
        return ()

    def entries(self) -> dict[str, Any]:
        """Entries of the core's document; faces and signals are still to be lowered."""
        return {**super().entries(), "steady": self.value.constant}


def _check_on_faces(faces: object, name: str, value: object) -> None:
    if not isinstance(faces, Faces):
        _check.fail("faces", faces, "must be faces of a surface")
    if not isinstance(value, Signal) or value.size != 3:
        _check.fail(name, value, "must be a signal of 3 components")


FORCES: tuple[type[ForceData], ...] = (Spring, Tendon, Wind, SheetWind, Curvature)
ON_FACES = (SheetWind, Curvature)
