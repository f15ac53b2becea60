"""Rigid bodies: what a model keeps of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.points import Point
from pliant.shapes import SHAPES, Shape
from pliant.typing import ArrayLike, FloatArray

__all__ = ["RigidBodyData"]


@dataclass(frozen=True, eq=False)
class RigidBodyData:
    """A rigid body at the start.

    Attributes
    ----------
    inertia : (3, 3)
        About the centre of mass in body axes [kg m^2].
    position, velocity : (3,)
        Of the centre of mass [m], [m/s].
    axes : (3, 3)
        Body axes, one a row.
    angular_velocity : (3,)
        In world axes [rad/s].
    """

    name: str
    mass: float
    inertia: FloatArray
    position: FloatArray
    axes: FloatArray
    velocity: FloatArray
    angular_velocity: FloatArray
    shape: Shape | None

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        _check.number(self.mass, "mass", above=0)
        for name in ("position", "velocity", "angular_velocity"):
            object.__setattr__(self, name, _check.vector(getattr(self, name), name))
        for name in ("inertia", "axes"):
            object.__setattr__(self, name, _check.array(getattr(self, name), name, (3, 3)))
        with np.errstate(over="ignore", invalid="ignore"):
            skew = np.abs(self.axes @ self.axes.T - np.eye(3)).max()
        if not skew < 1e-9:
            _check.fail("axes", self.axes, "must be orthonormal rows")
        require_inertia(self.inertia)
        if self.shape is not None and not isinstance(self.shape, SHAPES):
            _check.fail("shape", self.shape, "must be a pl.Sphere, pl.Box, pl.Cylinder or pl.Capsule")

    @property
    def r(self) -> FloatArray:
        """Position of the centre and the axes, (4, 3)."""
        return np.vstack([self.position, self.axes])

    @property
    def v_r(self) -> FloatArray:
        """Their rates, (4, 3)."""
        return np.vstack([self.velocity, np.cross(self.angular_velocity, self.axes)])

    def weights(self, point: Point) -> FloatArray:
        """Shares of (r, e1, e2, e3) in the position of a point, (4,)."""
        return np.array([1.0, *(point.local or (0.0, 0.0, 0.0))])

    def nearest(self, target: FloatArray, identity: str) -> Point:
        """Find the point of the body that is at a place."""
        x, y, z = (float(c) for c in self.axes @ (target - self.position))
        return Point(identity, self.name, 0, 0.0, local=(x, y, z))


def require_inertia(inertia: FloatArray) -> None:
    """Refuse what no distribution of mass has; a flat body meets the triangle inequality with equality."""
    size = float(np.abs(inertia).max())
    if not size > 0 or np.abs(inertia - inertia.T).max() > 1e-9 * size:
        _check.fail("inertia", inertia, "must be a symmetric tensor, not zero")
    moments = np.linalg.eigvalsh(inertia / size)
    if moments[0] < -1e-9 or moments[0] + moments[1] < moments[2] * (1 - 1e-9):
        _check.fail(
            "inertia",
            moments * size,
            "principal moments: 0 or more, none above the sum of the other two (triangle inequality)",
        )


def make_rigid_body(
    name: str,
    mass: Any,
    inertia: Any,
    density: Any,
    position: ArrayLike,
    orientation: Any,
    velocity: ArrayLike,
    angular_velocity: ArrayLike,
    shape: Any,
) -> RigidBodyData:
    """Check the arguments of ``add_rigid_body``."""
    if shape is not None and not isinstance(shape, SHAPES):
        _check.fail("shape", shape, "must be a pl.Sphere, pl.Box, pl.Cylinder or pl.Capsule")
    if mass is not None and density is not None:
        _check.fail("density", density, "give mass or density, not both")
    if mass is not None:
        mass = _check.number(mass, "mass", above=0)
    elif density is None:
        _check.fail("mass", mass, "give the mass, or a density and a shape")
    elif shape is None:
        _check.fail("density", density, "needs a shape, whose volume gives the mass; or give mass")
    else:
        mass = _check.number(density, "density", above=0) * shape.volume
    if inertia is not None:
        plain = np.ndim(inertia) if not isinstance(inertia, str) else 0
        tensor = (
            np.diag(_check.vector(inertia, "inertia"))
            if plain != 2
            else _check.array(inertia, "inertia", (3, 3))
        )
    elif shape is None:
        _check.fail("inertia", inertia, "give the inertia (3,) or (3, 3), or a shape, which has one")
    else:
        tensor = np.diag(mass * shape.gyration)
    return RigidBodyData(
        name,
        mass,
        tensor,
        _check.vector(position, "position"),
        _axes(orientation),
        _check.vector(velocity, "velocity"),
        _check.vector(angular_velocity, "angular_velocity"),
        shape,
    )


def _axes(orientation: Any) -> FloatArray:
    """Body axes, one a row, of a scipy Rotation."""
    if orientation is None:
        return np.eye(3)
    from scipy.spatial.transform import Rotation

    if not isinstance(orientation, Rotation):
        _check.fail("orientation", orientation, "must be a scipy.spatial.transform.Rotation")
    matrix = np.asarray(orientation.as_matrix())
    if matrix.shape != (3, 3):
        raise ModelError(f"orientation: must be one Rotation, not {len(matrix)}")
    return np.ascontiguousarray(matrix.T)
