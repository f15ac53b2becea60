"""Rigid bodies and the joints between bodies, as methods of the model."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._contents import Contents
from pliant.bodies import LineBody, MassBody
from pliant.joints import (
    Axis,
    Cylindrical,
    Distance,
    Hinge,
    SlideCable,
    SlideLine,
    Slider,
    Universal,
    Weld,
    axis_of,
)
from pliant.points import Cable, Joint, Line, Point, RigidBody, WorldPoint
from pliant.rigid import RigidBodyData, make_rigid_body
from pliant.shapes import Shape
from pliant.surfaces import Edge
from pliant.typing import ArrayLike

__all__ = ["Mechanism"]

PARALLEL = 1e-6  # sine of the angle below which directions count as parallel, as in the core


class Mechanism(Contents):
    """Rigid bodies and joints."""

    def add_rigid_body(
        self,
        *,
        mass: float | None = None,
        inertia: ArrayLike | None = None,
        density: float | None = None,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: Any = None,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        shape: Shape | None = None,
        name: str | None = None,
    ) -> RigidBody:
        """Add a rigid body.

        Parameters
        ----------
        mass : float, optional
            Mass [kg]; or give ``density`` and ``shape``.
        inertia : array_like, shape (3,) or (3, 3), optional
            About the centre of mass in body axes [kg m^2]: principal moments or the tensor. None: that of
            ``shape``.
        density : float, optional
            Density [kg/m^3] of the shape.
        position, velocity : array_like, shape (3,)
            Of the centre of mass at the start [m], [m/s].
        orientation : scipy.spatial.transform.Rotation, optional
            Body axes to world; None: the axes of the world.
        angular_velocity : array_like, shape (3,)
            At the start, in world axes [rad/s].
        shape : Sphere, Box, Cylinder or Capsule, optional
            For the inertia, and for pictures.
        name : str, optional
            Name; else ``rigid_body1``, ...

        Returns
        -------
        RigidBody
            Handle with ``center`` and ``at(local_point)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> plate = model.add_rigid_body(density=7850.0, shape=pl.Box((0.5, 0.3, 0.01)), position=(0, 0, 1))
        >>> model.dof, model.constraints
        (12, 6)
        """
        body = make_rigid_body(
            self._new_name(name, "rigid_body"),
            mass,
            inertia,
            density,
            position,
            orientation,
            velocity,
            angular_velocity,
            shape,
        )
        self._bodies[body.name] = body
        return RigidBody(body.name, self._identity)

    def weld(self, a: Any, b: Any = None, *, engaged: bool = True, name: str | None = None) -> Joint:
        """Make two bodies move as one; a cable keeps the direction of its tangent, it has no twist.

        Parameters
        ----------
        a : Point, RigidBody or Edge
            First point; or an edge of a surface whose nodes coincide with those of ``b``, another edge.
        b : Point, RigidBody, Edge or array_like, shape (3,), optional
            Second point, at the same place; None: the world.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> brick = model.add_rigid_body(mass=1.0, shape=pl.Box((0.2, 0.1, 0.1)))
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0.1, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> model.weld(rope.start, brick.at((0.1, 0, 0))).name
        'weld1'
        """
        if isinstance(a, Edge) and isinstance(b, Edge):
            return self._weld_edges(a, b, name)
        first, second, here = self._pair(a, b, ("a", "b"), anywhere=True)
        self._require_together(first, second, b, "b", engaged)
        self._require_directions(first, second, a, b)
        return self._add_joint(Weld(self._new_name(name, "weld"), first, second, here), engaged, a, b)

    def hinge(
        self,
        a: Any,
        b: Any = None,
        axis: ArrayLike = (0.0, 0.0, 1.0),
        *,
        stiffness: float = 0.0,
        damping: float = 0.0,
        rest: float = 0.0,
        limits: Any = None,
        engaged: bool = True,
        name: str | None = None,
    ) -> Joint:
        """Let two bodies turn about a common axis.

        Parameters
        ----------
        a : Point or RigidBody
            First point, on the axis.
        b : Point, RigidBody or array_like, shape (3,), optional
            Second point, at the same place; None: the world.
        axis : array_like, shape (3,)
            Axis at the start, in world axes. On a cable along its tangent, or normal to it: the tangent then
            stays normal to the axis.
        stiffness, damping : float
            Of a torsion spring and damper about the axis [N m/rad], [N m s/rad].
        rest : float
            Angle [rad] where the spring is free; turns are counted.
        limits : (float, float), optional
            Lower and upper limit of the angle [rad], None on a side without one. The stops give way a little,
            ``K p max(0, 1 + chi p')`` for p beyond the limit, stiff enough for the energy at hand
            (about a hundredth of the range), and take about half of it; they never pull.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction`` and ``result.joint``, whose position is the angle of ``a`` against
            ``b`` about the axis.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, -9.81, 0))
        >>> arm = model.add_rigid_body(mass=1.0, shape=pl.Box((1.0, 0.1, 0.1)), position=(0.5, 0, 0))
        >>> pivot = model.hinge(arm.at((-0.5, 0, 0)))
        >>> result = pl.simulate(model, duration=0.1, step=1e-2)
        >>> print(f"{result.joint(pivot).position[-1]:.3f}")
        -0.073
        """
        first, second, here = self._pair(a, b, ("a", "b"))
        self._require_together(first, second, b, "b", engaged)
        unit = axis_of(axis, "axis")
        self._require_directions(first, second, a, b)
        for point in (first, second):
            tangent = self._tangent(point)
            if tangent is not None and abs(float(tangent @ unit)) > PARALLEL:
                self._require_along(point, unit, "axis")
        return self._add_joint(
            Hinge(self._new_name(name, "hinge"), first, second, here, unit, stiffness, damping, rest, limits),
            engaged,
            a,
            b,
        )

    def slider(
        self,
        a: Any,
        b: Any = None,
        axis: ArrayLike = (1.0, 0.0, 0.0),
        *,
        stiffness: float = 0.0,
        damping: float = 0.0,
        rest: float = 0.0,
        limits: Any = None,
        engaged: bool = True,
        name: str | None = None,
    ) -> Joint:
        """Let two bodies slide along an axis without turning against each other.

        Parameters
        ----------
        a : Point or RigidBody
            First point.
        b : Point, RigidBody or array_like, shape (3,), optional
            Second point, at the same place; None: the world.
        axis : array_like, shape (3,)
            Axis at the start, in world axes; it turns with ``b``.
        stiffness, damping : float
            Of a spring and damper along the axis [N/m], [N s/m].
        rest : float
            Way [m] where the spring is free; 0 is where the joint starts.
        limits : (float, float), optional
            Lower and upper limit of the way [m], None on a side without one. The stops give way a little,
            ``K p max(0, 1 + chi p')`` for p beyond the limit, stiff enough for the energy at hand
            (about a hundredth of the range), and take about half of it; they never pull.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction`` and ``result.joint``, whose position is the way of ``a`` along the
            axis.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> lift = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1))
        >>> rail = model.slider(lift, axis=(0, 0, 1))
        >>> result = pl.simulate(model, duration=1.0, step=1e-2)
        >>> print(f"{result.joint(rail).position[-1]:.3f}")
        -4.905
        """
        first, second, here = self._pair(a, b, ("a", "b"), anywhere=True)
        self._require_together(first, second, b, "b", engaged)
        unit = axis_of(axis, "axis")
        self._require_directions(first, second, a, b)
        return self._add_joint(
            Slider(
                self._new_name(name, "slider"), first, second, here, unit, stiffness, damping, rest, limits
            ),
            engaged,
            a,
            b,
        )

    def cylindrical(
        self,
        a: Any,
        b: Any = None,
        axis: ArrayLike = (0.0, 0.0, 1.0),
        *,
        engaged: bool = True,
        name: str | None = None,
    ) -> Joint:
        """Let two bodies slide along an axis and turn about it.

        Parameters
        ----------
        a : Point or RigidBody
            First point, on the axis.
        b : Point, RigidBody or array_like, shape (3,), optional
            Second point, at the same place; None: the world.
        axis : array_like, shape (3,)
            Axis at the start, in world axes; of a cable its tangent.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> ring = model.add_rigid_body(mass=1.0, shape=pl.Cylinder(0.1, 0.02), angular_velocity=(0, 0, 5))
        >>> shaft = model.cylindrical(ring.center)
        >>> model.constraints
        10
        """
        first, second, here = self._pair(a, b, ("a", "b"))
        self._require_together(first, second, b, "b", engaged)
        unit = axis_of(axis, "axis")
        self._require_directions(first, second, a, b)
        for point in (first, second):
            self._require_along(point, unit, "axis")
        return self._add_joint(
            Cylindrical(self._new_name(name, "cylindrical"), first, second, here, unit), engaged, a, b
        )

    def universal(
        self,
        a: Any,
        b: Any,
        axis_a: ArrayLike,
        axis_b: ArrayLike,
        *,
        engaged: bool = True,
        name: str | None = None,
    ) -> Joint:
        """Join two bodies by a universal joint: an axis of each stays normal to that of the other.

        Parameters
        ----------
        a : Point or RigidBody
            First point.
        b : Point, RigidBody, array_like of shape (3,) or None
            Second point, at the same place; None: the world.
        axis_a, axis_b : array_like, shape (3,)
            Axes of ``a`` and of ``b`` at the start, in world axes, normal to each other; of a cable its
            tangent.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> bob = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(0, 0, -1))
        >>> cross = model.universal(bob.at((0, 0, 1)), None, (1, 0, 0), (0, 1, 0))
        >>> model.constraints
        10
        """
        first, second, here = self._pair(a, b, ("a", "b"))
        self._require_together(first, second, b, "b", engaged)
        units = axis_of(axis_a, "axis_a"), axis_of(axis_b, "axis_b")
        if abs(float(np.dot(*units))) > 1e-9:
            _check.fail("axis_b", axis_b, "must be normal to axis_a")
        self._require_directions(first, second, a, b, lines=True)
        self._require_along(first, units[0], "axis_a")
        self._require_along(second, units[1], "axis_b")
        return self._add_joint(
            Universal(self._new_name(name, "universal"), first, second, here, *units), engaged, a, b
        )

    def distance(
        self, a: Any, b: Any, length: float | None = None, *, engaged: bool = True, name: str | None = None
    ) -> Joint:
        """Keep two points a length apart: a massless rod.

        Parameters
        ----------
        a : Point or RigidBody
            First point; of a bare rigid body its centre.
        b : Point, RigidBody or array_like, shape (3,)
            Second point.
        length : float, optional
            The length [m]; None: that at the start.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> bob = model.add_point_mass(1.0, at=(1, 0, 0))
        >>> rod = model.distance(bob, (0, 0, 0))
        >>> model.dof, model.constraints
        (3, 1)
        """
        first = self._point(a, "a")
        second = self._other(b, "b")
        at_start = float(np.linalg.norm(self._position(first) - self._position(second)))
        if at_start <= 1e-9 * self._size():
            _check.fail("b", b, "must be apart from a at the start; points that coincide take a pin")
        if length is not None:
            length = _check.number(length, "length", above=0)
            if abs(length - at_start) > 1e-9 * self._size():
                _check.fail("length", length, f"the points are {at_start:.9g} m apart at the start; move one")
        return self._add_joint(
            Distance(self._new_name(name, "distance"), first, second, False, at_start), engaged, a, b
        )

    def slide_along(self, point: Any, path: Any, *, name: str | None = None) -> Joint:
        """Let a point slide along a cable or a straight line, without friction.

        A run that brings the point to an end of the cable stops with an error that tells where and when.

        Parameters
        ----------
        point : Point or body
            The point, on the path at the start; of a bare rigid body its centre.
        path : Cable or Line
            The cable, any of its elements, or the line.

        Returns
        -------
        Joint
            Handle for ``result.reaction``, the force on the point, and for ``result.joint``, whose position
            is the arc length: of the cable's stress-free line from its start, or from the line's point.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> bead = model.add_point_mass(1.0, at=(0, 0, 0))
        >>> wire = model.slide_along(bead, pl.Line((0, 0, 0), (1, 0, -1)))
        >>> result = pl.simulate(model, duration=1.0, step=0.01)
        >>> print(f"{result.joint(wire).position[-1]:.3f}")
        3.468
        """
        first = self._point(point, "point")
        if isinstance(path, Line):
            other = self._other(path.point, "path")
            if isinstance(other, Point) and not isinstance(self._bodies[other.body], RigidBodyData):
                _check.fail("path", path, "the line's point must be of a rigid body or of the world")
            axis = axis_of(path.direction, "direction")
            arm = self._position(first) - self._position(other)
            self._require_on_path(float(np.linalg.norm(np.cross(arm, axis))), path)
            joint = SlideLine(self._new_name(name, "slide"), first, other, False, axis)
            return self._add_joint(joint, True, path.point)
        if not isinstance(path, Cable):
            _check.fail("path", path, "must be a cable or a pliant.Line")
        body = self._body(path, "path")
        if not isinstance(body, LineBody) or body.closed or len(body.strands) != 1:
            _check.fail("path", path, "must be a cable with two ends")
        if first.body == body.name:
            _check.fail("point", point, "is a point of the path itself")
        nearest = body.nearest(self._position(first), self._identity)
        self._require_on_path(float(np.linalg.norm(self._position(nearest) - self._position(first))), path)
        return self._add_joint(SlideCable(self._new_name(name, "slide"), first, body.name))

    def _require_on_path(self, gap: float, path: object) -> None:
        if gap > 1e-6 * self._size():
            _check.fail("path", path, f"the point must be on it at the start, but is {gap:.6g} m away")

    def _weld_edges(self, a: Edge, b: Edge, name: str | None) -> Joint:
        raise NotImplementedError

    def _require_directions(
        self, a: Point, b: Point | WorldPoint, given_a: object, given_b: object, *, lines: bool = False
    ) -> None:
        """Refuse point masses, and two cables (unless ``lines``): one side must carry all directions."""
        for point, given, argument in ((a, given_a, "a"), (b, given_b, "b")):
            if isinstance(point, Point) and isinstance(self._bodies[point.body], MassBody):
                _check.fail(argument, given, "a point mass has no directions; pin it, or take a rigid body")
            if isinstance(point, Point) and self._is_membrane(point):
                _check.fail(argument, given, "a membrane has no directions at a point; pin it")
        if not lines and self._tangent(a) is not None and self._tangent(b) is not None:
            _check.fail("b", given_b, "cables have no twist: one side must be a rigid body or the world")
        flexible = [p for p in (a, b) if isinstance(p, Point) and p.local is None and p.offset is None]
        if len(flexible) == 2 and any(p.at is not None for p in flexible):
            _check.fail("b", given_b, "with a shell one side must be a rigid body or the world; pin them")

    def _require_along(self, point: Point | WorldPoint, axis: Axis, argument: str) -> None:
        """Refuse an axis off the tangent of a cable, which has no other direction."""
        tangent = self._tangent(point)
        if tangent is not None and np.linalg.norm(np.cross(tangent, axis)) > PARALLEL:
            _check.fail(
                argument,
                axis,
                f"a cable has no direction but its tangent, here {np.round(tangent, 9).tolist()}",
            )
