"""What moves cables and what cables move: tendons, moving forces, wind, as methods of the model."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from pliant import _check
from pliant._drives import Drives
from pliant.bodies import LineBody
from pliant.forces import SheetWind, Tendon, Wind
from pliant.loads import MovingForce
from pliant.points import Handle, Load, Point
from pliant.signals import Constant, Signal, Table, as_signal
from pliant.surfaces import Faces, Membrane, Shell
from pliant.typing import ArrayLike

__all__ = ["Actuation"]

ANGLES = 360  # samples of a lift coefficient over a turn


class Actuation(Drives):
    """Tendons, moving forces and wind."""

    def add_tendon(
        self,
        points: Any,
        tension: Any = None,
        *,
        length: Any = None,
        stiffness: float | None = None,
        damping: float = 0.0,
        friction: float = 0.0,
        slip_velocity: float = 1e-3,
        name: str | None = None,
    ) -> Load:
        """Add a tendon: a line without mass through guides, pulled at one end and fastened at the other.

        It is pulled by a force or by a motor, and never pushes. At guides it turns without friction, or
        with the capstan's: the tensions on both sides differ by the factor ``exp(friction * wrap angle)``
        while it slides.

        Parameters
        ----------
        points : sequence of points
            Two or more: points of bodies, bodies (a rigid body's centre) or places in the world (3,), from
            the pulled end to the fastened one. Those between are guides.
        tension : float, callable, Table, product with a Ramp, or Input, optional
            Force at the pulled end [N]; below zero it is none.
        length : float, callable, Table, product with a Ramp, or Input, optional
            Stress-free length that a motor leaves to the tendon [m], above 0; instead of ``tension``.
        stiffness : float, optional
            Stiffness EA of the tendon [N], needed with ``length``: it pulls by EA (l - length)/length.
        damping : float
            Force per rate of the stretch [N s/m], with ``length``; never pushing either.
        friction : float
            Coefficient of friction at the guides, from 0 on.
        slip_velocity : float
            Velocity w_s over which friction changes its sign, as tanh(w/w_s) [m/s]: below it the tendon
            creeps instead of sticking, and at rest all tensions are equal.

        Returns
        -------
        Load
            Handle for ``result.tendon``.

        Examples
        --------
        A mass on a pulley:

        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> ball = model.add_point_mass(2.0, at=(1, 0, -1))
        >>> line = model.add_tendon([(0, 0, -1), (0, 0, 0), (1, 0, 0), ball], length=3.0, stiffness=5000.0)
        >>> result = pl.solve_static(model)
        >>> print(f"{result.tendon(line).tension[-1]:.2f}")
        19.62
        """
        if isinstance(points, (Point, Handle, str)) or not np.iterable(points):
            _check.fail("points", points, "must be two or more points")
        guides = tuple(self._other(point, f"points[{k}]") for k, point in enumerate(points))
        if len(guides) < 2:
            _check.fail("points", points, "must be two or more points")
        if not any(isinstance(point, Point) for point in guides):
            _check.fail("points", points, "at least one must be a point of a body")
        for k, (a, b) in enumerate(pairwise(guides)):
            if np.linalg.norm(self._position(a) - self._position(b)) <= 1e-9 * self._size():
                _check.fail(f"points[{k + 1}]", str(b), "lies where the point before it lies")
        if (tension is None) == (length is None):
            _check.fail("length", length, "give tension or length, one of them")
        pull = None if tension is None else as_signal(tension, "tension", 1)
        if pull is not None and pull.constant:
            _check.number(float(pull(0.0)[0]), "tension", at_least=0)
        left = None if length is None else as_signal(length, "length", 1)
        if left is not None:
            _check.number(float(left(0.0)[0]), "length", above=0)
            stiffness = _check.number(stiffness, "stiffness", above=0)
        elif stiffness is not None:
            _check.fail("stiffness", stiffness, "goes with length: a tendon pulled by a force needs none")
        damping = _check.number(damping, "damping", at_least=0)
        if left is None and damping > 0.0:
            _check.fail("damping", damping, "goes with length: a tendon pulled by a force has none")
        return self._add_load(
            Tendon(
                self._new_name(name, "tendon"),
                guides,
                pull,
                left,
                stiffness,
                damping,
                _check.number(friction, "friction", at_least=0),
                _check.number(slip_velocity, "slip_velocity", above=0),
            )
        )

    def add_moving_force(self, cable: Any, force: Any, position: Any, *, name: str | None = None) -> Load:
        """Add a force that moves along a cable.

        Parameters
        ----------
        cable : Cable
            The cable.
        force : array_like, shape (3,), callable, Table, product with a Ramp, or Input
            Force [N].
        position : callable, Table, product with a Ramp, Input, or float
            Arc length of the stress-free line where it acts [m]. Before the start and beyond the end there is
            no force.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (4, 0, 0)], elements=8, section=thin, material=rubber)
        >>> car = model.add_moving_force(rope, (0, 0, -10.0), lambda t: 2.0 * t)
        >>> car.name
        'moving_force1'
        """
        body = self._cable(cable, "cable")
        value = as_signal(force, "force", 3)
        self._require_in_plane(body, value, "force")
        return self._add_load(
            MovingForce(
                self._new_name(name, "moving_force"), body.name, value, as_signal(position, "position", 1)
            )
        )

    def add_wind(
        self,
        body: Any,
        velocity: Any,
        density: float,
        drag: float,
        lift: float | Callable[[float], float] | Table | None = None,
        *,
        name: str | None = None,
    ) -> Load:
        """Add wind, or any fluid that flows by: drag and lift on a cable or on faces of a surface.

        On a cable, per length, with the velocity n of the flow relative to the line and across it, and the
        diameter D of the section: drag ``density/2 drag D |n| n`` and lift ``density/2 lift D |n| t x n``, t
        the tangent. Flow along the line does nothing.

        On a surface, per area, with the relative velocity w at the angle alpha to the surface: drag along w
        with the coefficient ``drag sin(alpha)**2`` and lift normal to w with ``lift sin(alpha) cos(alpha)``.
        Without ``lift``, which is ``drag`` then, the flow presses along the normal alone.

        Parameters
        ----------
        body : Cable, CableNet, Shell, Membrane or Faces
            The body, or ``sheet.faces(select)``.
        velocity : array_like, shape (3,), callable, Table, product with a Ramp, or Input
            Velocity of the fluid [m/s], (0, 0, 0) for air at rest.
        density : float
            Density of the fluid [kg/m^3], above 0.
        drag : float
            Drag coefficient, from 0 on; about 1.1 for a round line, 1.2 for a square plate across the flow.
        lift : float, callable or Table, optional
            Lift coefficient. On cables also one over the angle of attack [rad], from the velocity at t = 0 to
            that of the flow relative to the line, both seen along the tangent and positive about it; a
            callable is sampled. On surfaces a number from 0 on; by default that of ``drag``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> nylon = pl.LinearElastic(youngs_modulus=2e9, poisson_ratio=0.4, density=1150.0)
        >>> thin = pl.Circle(radius=2e-3)
        >>> line = model.add_cable([(0, 0, 0), (0, 0, 20)], elements=10, section=thin, material=nylon)
        >>> model.add_wind(line, (8, 0, 0), density=1.2, drag=1.1).name
        'wind1'
        """
        value = as_signal(velocity, "velocity", 3)
        if isinstance(body, (Shell, Membrane, Faces)):
            drag = _check.number(drag, "drag", at_least=0)
            if lift is not None:
                lift = _check.number(lift, "lift", at_least=0)
            faces = self._one_part(body, "body")
            density = _check.number(density, "density", above=0)
            force = drag if lift is None else lift
            return self._add_load(SheetWind(self._new_name(name, "wind"), faces, value, density, drag, force))
        data = self._body(body, "body")
        if not isinstance(data, LineBody):
            _check.fail("body", body, "wind acts on cables, nets of cables, shells and membranes")
        self._require_in_plane(data, value, "velocity")
        return self._add_load(
            Wind(
                self._new_name(name, "wind"),
                data.name,
                value,
                _check.number(density, "density", above=0),
                _check.number(drag, "drag", at_least=0),
                _lift(lift),
            )
        )

    def _cable(self, cable: Any, name: str) -> LineBody:
        data = self._body(cable, name)
        if not isinstance(data, LineBody) or data.kind != "cable":
            _check.fail(name, cable, "must be a cable")
        return data


def _lift(lift: Any) -> Signal:
    """Lift coefficient, the same at all angles or a table over a turn."""
    if lift is None:
        return Constant((0.0,))
    if isinstance(lift, Table):
        if lift.size != 1:
            _check.fail("lift", lift, "must have one value for each angle")
        return _sampled(lambda angle: lift(angle))
    if callable(lift):
        return _sampled(lift)
    return Constant((_check.number(lift, "lift"),))


def _sampled(lift: Callable[[float], ArrayLike]) -> Table:
    angles = np.linspace(-np.pi, np.pi, ANGLES + 1)
    values = [_check.number(np.asarray(lift(float(a))).reshape(-1)[0], f"lift({a:g})") for a in angles[:-1]]
    # A turn is a period: values that differ at its ends, as those of a wing do, jump there.
    return Table(angles, np.array([*values, values[0]]), period=2 * np.pi, smooth=True)
