"""Shapes of rigid bodies: their volume and inertia, and how they are drawn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pliant import _check
from pliant.typing import FloatArray, IntArray

__all__ = ["Box", "Capsule", "Cylinder", "Shape", "Sphere"]

TURN = np.linspace(0.0, 2.0 * np.pi, 33)
RING = np.stack([np.cos(TURN), np.sin(TURN), np.zeros_like(TURN)], axis=1)


class Surface(NamedTuple):
    """Triangles: points (p, 3) [m], outward unit normals (p, 3) there, corners (t, 3) counter-clockwise."""

    points: FloatArray
    normals: FloatArray
    triangles: IntArray


class Shape(ABC):
    """A solid of even density about its centre, axis z."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume [m^3]."""

    @property
    @abstractmethod
    def gyration(self) -> FloatArray:
        """Principal moments of inertia about the centre, per mass [m^2], shape (3,)."""

    @property
    @abstractmethod
    def outline(self) -> list[FloatArray]:
        """Lines that show it, each (k, 3) [m]."""

    @property
    @abstractmethod
    def surface(self) -> Surface:
        """Its surface as triangles."""


@dataclass(frozen=True)
class Sphere(Shape):
    """A sphere.

    Parameters
    ----------
    radius : float
        Radius [m].
    """

    radius: float

    def __post_init__(self) -> None:
        _store(self, radius=_check.number(self.radius, "radius", above=0))

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return 4.0 / 3.0 * np.pi * self.radius**3

    @property
    def gyration(self) -> FloatArray:
        """Principal moments of inertia about the centre, per mass [m^2], shape (3,)."""
        return np.full(3, 0.4 * self.radius**2)

    @property
    def outline(self) -> list[FloatArray]:
        """Lines that show it, each (k, 3) [m]."""
        return [self.radius * np.roll(RING, shift, axis=1) for shift in range(3)]

    @property
    def surface(self) -> Surface:
        """Its surface as triangles."""
        arc = np.linspace(-np.pi / 2, np.pi / 2, 17)
        return _turned([(self.radius * np.cos(arc), self.radius * np.sin(arc))])


@dataclass(frozen=True, eq=False)
class Box(Shape):
    """A box.

    Parameters
    ----------
    size : array_like, shape (3,)
        Full edges along x, y, z [m].
    """

    size: Any

    def __post_init__(self) -> None:
        edges = _check.vector(self.size, "size")
        for k in range(3):
            _check.number(float(edges[k]), f"size[{k}]", above=0)
        _store(self, size=tuple(float(x) for x in edges))

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return float(np.prod(self.size))

    @property
    def gyration(self) -> FloatArray:
        """Principal moments of inertia about the centre, per mass [m^2], shape (3,)."""
        squares = np.square(self.size)
        moments: FloatArray = (squares.sum() - squares) / 12.0
        return moments

    @property
    def outline(self) -> list[FloatArray]:
        """Lines that show it, each (k, 3) [m]."""
        square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) / 2.0
        lines = [np.column_stack([square, np.full(5, z)]) for z in (-0.5, 0.5)]
        lines += [np.array([(x, y, -0.5), (x, y, 0.5)]) for x, y in square[:4]]
        return [line * np.array(self.size) for line in lines]

    @property
    def surface(self) -> Surface:
        """Its surface as triangles."""
        square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
        points, normals = [], []
        for axis in range(3):
            for side in (-1.0, 1.0):
                face = np.column_stack([square[:: int(side)], np.full(4, side)])
                points.append(np.roll(face, axis + 1, axis=1))
                normals.append(np.tile(np.roll([0.0, 0.0, side], axis + 1), (4, 1)))
        corners = np.array([(0, 1, 2), (0, 2, 3)])
        triangles = np.concatenate([corners + 4 * k for k in range(6)])
        return Surface(np.concatenate(points) * np.array(self.size) / 2.0, np.concatenate(normals), triangles)


@dataclass(frozen=True)
class Cylinder(Shape):
    """A cylinder along z, centred.

    Parameters
    ----------
    radius, length : float
        Radius and length [m].
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _store(
            self,
            radius=_check.number(self.radius, "radius", above=0),
            length=_check.number(self.length, "length", above=0),
        )

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return np.pi * self.radius**2 * self.length

    @property
    def gyration(self) -> FloatArray:
        """Principal moments of inertia about the centre, per mass [m^2], shape (3,)."""
        across = self.radius**2 / 4.0 + self.length**2 / 12.0
        return np.array([across, across, self.radius**2 / 2.0])

    @property
    def outline(self) -> list[FloatArray]:
        """Lines that show it, each (k, 3) [m]."""
        return _tube(self.radius, self.length)

    @property
    def surface(self) -> Surface:
        """Its surface as triangles."""
        r, z = self.radius, self.length / 2.0
        return _turned(
            [
                (np.array([0.0, r]), np.array([-z, -z])),
                (np.array([r, r]), np.array([-z, z])),
                (np.array([r, 0.0]), np.array([z, z])),
            ]
        )


@dataclass(frozen=True)
class Capsule(Shape):
    """A cylinder along z with hemispheres at its ends, centred.

    Parameters
    ----------
    radius, length : float
        Radius, and length of the cylinder between the hemispheres [m].
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _store(
            self,
            radius=_check.number(self.radius, "radius", above=0),
            length=_check.number(self.length, "length", above=0),
        )

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return np.pi * self.radius**2 * (self.length + 4.0 / 3.0 * self.radius)

    @property
    def gyration(self) -> FloatArray:
        """Principal moments of inertia about the centre, per mass [m^2], shape (3,)."""
        r, h = self.radius, self.length
        tube, caps = h, 4.0 / 3.0 * r  # parts of the volume, over the cross section
        # The caps' centres lie 3 r / 8 beyond the ends; about its own centre a cap has (2/5 - 9/64) r^2.
        across = tube * (r**2 / 4.0 + h**2 / 12.0) + caps * (
            0.4 * r**2 - (3.0 * r / 8.0) ** 2 + (h / 2.0 + 3.0 * r / 8.0) ** 2
        )
        along = tube * r**2 / 2.0 + caps * 0.4 * r**2
        return np.array([across, across, along]) / (tube + caps)

    @property
    def outline(self) -> list[FloatArray]:
        """Lines that show it, each (k, 3) [m]."""
        half = np.stack([np.cos(TURN[:17]), np.zeros(17), np.sin(TURN[:17])], axis=1) * self.radius
        lift = np.array([0.0, 0.0, self.length / 2.0])
        arcs = [half + lift, half[:, [1, 0, 2]] + lift]
        return _tube(self.radius, self.length) + arcs + [arc * (1, 1, -1) for arc in arcs]

    @property
    def surface(self) -> Surface:
        """Its surface as triangles."""
        arc, lift = np.linspace(-np.pi / 2, np.pi / 2, 18), np.repeat([-self.length / 2, self.length / 2], 9)
        return _turned([(self.radius * np.cos(arc), self.radius * np.sin(arc) + lift)])


SHAPES: tuple[type[Shape], ...] = (Sphere, Box, Cylinder, Capsule)


def _turned(profile: list[tuple[FloatArray, FloatArray]]) -> Surface:
    """Turn pieces of a profile, radii and heights from below to above, about z; edges between pieces stay."""
    points, normals, triangles = [], [], []
    count = 0
    around = np.stack([RING[:, 0], RING[:, 1]])
    for r, z in profile:
        slope = np.stack([np.gradient(z), -np.gradient(r)])
        slope /= np.linalg.norm(slope, axis=0)
        for radius, height, (n_r, n_z) in zip(r, z, slope.T, strict=True):
            points.append(
                np.column_stack([radius * around[0], radius * around[1], np.full(len(RING), height)])
            )
            normals.append(np.column_stack([n_r * around[0], n_r * around[1], np.full(len(RING), n_z)]))
        k = np.arange(len(RING) - 1)
        for row in range(len(r) - 1):
            a = count + row * len(RING) + k
            b = a + len(RING)
            triangles += [np.column_stack([a, a + 1, b + 1]), np.column_stack([a, b + 1, b])]
        count += len(r) * len(RING)
    return Surface(np.concatenate(points), np.concatenate(normals), np.concatenate(triangles))


def _tube(radius: float, length: float) -> list[FloatArray]:
    rings = [radius * RING + (0.0, 0.0, z) for z in (-length / 2.0, length / 2.0)]
    return rings + [np.stack([rings[0][k], rings[1][k]]) for k in (0, 8, 16, 24)]


def _store(shape: object, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(shape, name, value)
